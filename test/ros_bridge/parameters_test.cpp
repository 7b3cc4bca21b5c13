// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/parameters.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "ros_bridge/expect_refused.hpp"
#include "ros_bridge/test_paths.hpp"

namespace polyscalpel {
namespace {

using testing::expectRefused;
using testing::sourcePath;

const std::string kSmallest = "mesh: {box: {}}\n";
const std::string kCutting = kSmallest + "cutting: {}\ncontact: {}\n";

SceneParameters read(const std::string& text, std::vector<FieldRecord>* fields = nullptr) {
  YamlMap scene = YamlMap::parse(text, "scene.yaml");
  SceneParameters parameters = readScene(scene, {sourcePath("test/ros_bridge")});
  if (fields != nullptr)
    fields->insert(fields->end(), scene.document().fields.begin(), scene.document().fields.end());
  return parameters;
}

/// Documented triples (last part of the path, default, range) in the comments of the reference scene.
using Documented = std::set<std::tuple<std::string, std::string, std::string>>;

Documented readComments(const std::string& file) {
  const std::regex pattern(R"(([a-z_0-9]+):.*#.*default (.*?); range (.*)$)");
  Documented documented;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::smatch match;
    if (std::regex_search(line, match, pattern)) documented.emplace(match[1], match[2], match[3]);
  }
  return documented;
}

TEST(Parameters, ReferenceSceneTellsEveryFieldWithItsDefaultAndRange) {
  const Documented documented = readComments(sourcePath("config/scenes/block.yaml"));
  ASSERT_GT(documented.size(), 50u);

  // Every reader once; files that exist stand for meshes, which are not opened here.
  std::vector<FieldRecord> fields;
  read(kCutting +
           "material: {}\nelement: {}\nintegration: {}\nnode: {}\n"
           "fixed: [{box: {lowest_m: [0, 0, 0], highest_m: [0, 0, 0]}}, {sphere: {radius_m: 1}}, {vertices: "
           "[0]}]\n"
           "tools:\n- shape: {box: {}}\n  blade_edge_m: [[0, 0, 0], [0, 0, 1]]\n  display: [{sphere: {}}]\n"
           "- {name: b, shape: {capsule: {}}}\n- {name: c, shape: {mesh: {path: parameters_test.cpp}}}\n",
       &fields);
  read("mesh: {ball: {}}\n", &fields);
  read("mesh: {file: {path: parameters_test.cpp}}\n", &fields);

  Documented known;
  for (const FieldRecord& field : fields) {
    const std::string key = field.path.substr(field.path.rfind('.') + 1);
    // An obligatory field keeps the struct's value as its default; colours of display shapes are those of the
    // shape.
    known.emplace(key, field.default_value, field.range);
  }
  for (const auto& [key, value, range] : known)
    EXPECT_TRUE(documented.count({key, value, range}) > 0)
        << "block.yaml does not tell: " << key << ": default " << value << "; range " << range;
  for (const auto& [key, value, range] : documented)
    EXPECT_TRUE(known.count({key, value, range}) > 0)
        << "block.yaml tells what is not so: " << key << ": default " << value << "; range " << range;
}

TEST(Parameters, EmptySectionsAreTheDefaultsOfTheStructs) {
  const SceneParameters read_parameters =
      read(kCutting + "material: {}\nelement: {}\nintegration: {}\nnode: {}\n");
  const SimulationConfig defaults;
  EXPECT_EQ(read_parameters.simulation.material.youngs_modulus_pa, defaults.material.youngs_modulus_pa);
  EXPECT_EQ(read_parameters.simulation.element.quadrature_points, defaults.element.quadrature_points);
  EXPECT_EQ(read_parameters.simulation.element.corotated, defaults.element.corotated);
  EXPECT_EQ(read_parameters.simulation.integration.time_step_s, defaults.integration.time_step_s);
  EXPECT_EQ(read_parameters.simulation.integration.mode, defaults.integration.mode);
  EXPECT_EQ(read_parameters.simulation.integration.gravity_m_s2, defaults.integration.gravity_m_s2);
  EXPECT_EQ(read_parameters.simulation.cutting->hold_back, CuttingConfig().hold_back);
  EXPECT_EQ(read_parameters.simulation.contact->stiffness_pa_m, ContactConfig().stiffness_pa_m);
  EXPECT_EQ(read_parameters.node.clock, NodeConfig().clock);
  EXPECT_EQ(read_parameters.node.tool_timeout_s, NodeConfig().tool_timeout_s);
  EXPECT_FALSE(read(kSmallest).simulation.cutting.has_value());
  EXPECT_FALSE(read(kSmallest).simulation.contact.has_value());
}

TEST(Parameters, EverySceneIsValid) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sourcePath("config/scenes"))) {
    SCOPED_TRACE(entry.path().string());
    ++scenes;
    // The organ's mesh is made by the build and looked for, not opened, when the scene is read.
    const std::filesystem::path folder =
        std::filesystem::path(::testing::TempDir()) / "polyscalpel_parameters_test";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "liver.msh") << "stands for the organ's mesh\n";
    EXPECT_NO_THROW(loadScene(entry.path().string(), {folder.string()}));
  }
  EXPECT_GE(scenes, 3);
}

TEST(Parameters, ReferenceSceneIsReadAsItIsWritten) {
  const SceneParameters parameters = loadScene(sourcePath("config/scenes/block.yaml"), {});
  const auto& box = std::get<BoxMeshConfig>(parameters.simulation.mesh);
  EXPECT_EQ(box.size_m, Eigen::Vector3d(0.03, 0.03, 0.03));
  EXPECT_EQ(box.counts, Eigen::Vector3i(3, 3, 3));
  ASSERT_EQ(parameters.simulation.tools.size(), 1u);
  EXPECT_EQ(parameters.simulation.tools[0].blade_edge_tool->cols(), 2);
  EXPECT_EQ(parameters.simulation.tools[0].shape->kind, ShapeKind::kBox);
  EXPECT_EQ(parameters.tools[0].topic, "scalpel/measured_cp");
  EXPECT_EQ(parameters.tools[0].frame, "scalpel");
  EXPECT_TRUE(parameters.tools[0].broadcast_tf);
}

struct Bound {
  std::string text;  // of a scene; $ stands for the value
  std::string inside, outside;
};

TEST(Parameters, RefusesWhatIsOutOfRange) {
  const std::vector<Bound> bounds = {
      {"integration: {time_step_s: $}", "1e-6", "9e-7"},
      {"integration: {time_step_s: $}", "1", "1.0001"},
      {"integration: {mass_damping_per_s: $}", "0", "-1e-9"},
      {"integration: {contact_iterations: $}", "20", "21"},
      {"integration: {contact_iterations: $}", "1", "0"},
      {"integration: {mass_floor: $}", "1", "1.001"},
      {"material: {youngs_modulus_pa: $}", "1e-3", "0"},
      {"material: {poisson_ratio: $}", "0.4999", "0.5"},
      {"material: {poisson_ratio: $}", "-0.9999", "-1"},
      {"material: {density_kg_m3: $}", "1", "-1"},
      {"element: {quadrature_points: $}", "11", "5"},
      {"element: {stabilisation_scale: $}", "0.1", "0"},
      {"cutting: {snap_tolerance: $}", "0.2", "0.21"},
      {"cutting: {snap_tolerance: $}", "1e-6", "0"},
      {"cutting: {hold_back: $}", "2", "2.01"},
      {"cutting: {max_travel: $}", "1", "1.01"},
      {"cutting: {max_travel: $}", "0.01", "0"},
      {"contact: {friction_coefficient: $}", "10", "10.1"},
      {"contact: {margin_m: $}", "1e-4", "0"},
      {"node: {tool_timeout_s: $}", "3600", "3601"},
      {"node: {tool_timeout_s: $}", "0.01", "0"},
      {"node: {mesh_rate_hz: $}", "1000", "1001"},
      {"node: {surface_colour_rgba: [$, 0, 0, 1]}", "1", "1.1"},
      {"tools: [{name: $}]", "knife_2", "2knife"},
      {"tools: [{name: $}]", "a", "a/b"},
      {"tools: [{max_jump_m: $}]", "0.1", "0"},
      {"tools: [{name: a, frame: $}]", "b", "world"},
  };
  for (const Bound& bound : bounds) {
    SCOPED_TRACE(bound.text + " with " + bound.outside);
    const auto with = [&](const std::string& value) {
      std::string text = bound.text;
      return kSmallest + text.replace(text.find('$'), 1, value) + "\n";
    };
    EXPECT_NO_THROW(read(with(bound.inside)));
    expectRefused([&] { read(with(bound.outside)); }, {"scene.yaml"});
    if (bound.text.find("name") == std::string::npos)
      expectRefused([&] { read(with(".nan")); }, {"scene.yaml"});
  }
}

TEST(Parameters, RefusesWhatDoesNotFitTogether) {
  expectRefused([] { read("material: {}\n"); }, {"mesh is missing"});
  expectRefused([] { read("mesh: {}\n"); }, {"exactly one of box, ball, file"});
  expectRefused([] { read(kSmallest + "materail: {}\n"); }, {"scene.yaml:2", "did you mean material?"});
  expectRefused([] { read(kSmallest + "material: {youngs_modulus: 1}\n"); },
                {"did you mean youngs_modulus_pa?"});
  expectRefused([] { read(kSmallest + "tools: [{name: a}, {name: a}]\n"); }, {"a"});
  expectRefused([] { read(kSmallest + "tools: [{name: a, blade_edge_m: [[0, 0, 0], [0, 0, 1]]}]\n"); },
                {"cutting"});
  expectRefused([] { read(kSmallest + "tools: [{name: a, topic: b, follow_frame: c}]\n"); },
                {"follow_frame"});
  expectRefused([] { read(kSmallest + "tools: [{name: a, frame: f}, {name: b, frame: f}]\n"); },
                {"must differ"});
  expectRefused([] { read(kSmallest + "node: {tissue_frame: world}\n"); }, {"tissue_frame", "must differ"});
  expectRefused([] { read(kSmallest + "node: {world_frame: /world}\n"); }, {"world_frame", "slash"});
  expectRefused([] { read(kSmallest + "fixed: [{box: {lowest_m: [0, 0, 1], highest_m: [1, 1, 0]}}]\n"); },
                {"fixed[0].box.highest_m"});
  expectRefused(
      [] { read(kSmallest + "tools: [{name: a, shape: {box: {orientation_xyzw: [0, 0, 0, 0.5]}}}]\n"); },
      {"tools[0].shape.box.orientation_xyzw", "unit quaternion"});
}

TEST(Parameters, LooksForMeshesAndTellsWhere) {
  expectRefused([] { read("mesh: {file: {path: no_such.msh}}\n"); },
                {"scene.yaml:1", "mesh.file.path", "no_such.msh", "tried"});
  const SceneParameters found = read("mesh: {file: {path: parameters_test.cpp}}\n");
  EXPECT_EQ(std::get<MeshFileConfig>(found.simulation.mesh).path,
            sourcePath("test/ros_bridge/parameters_test.cpp"));
}

TEST(Parameters, FollowsAFrameInsteadOfATopic) {
  const SceneParameters parameters = read(kSmallest + "tools: [{name: a, follow_frame: robot_tip}]\n");
  EXPECT_TRUE(parameters.tools[0].topic.empty());
  EXPECT_EQ(parameters.tools[0].frame, "robot_tip");
  EXPECT_FALSE(parameters.tools[0].broadcast_tf);
}

TEST(Parameters, DrawsOtherShapesThanItTouchesWith) {
  const SceneParameters parameters = read(
      kSmallest +
      "tools: [{name: a, display: [{sphere: {radius_m: 0.01}, colour_rgba: [1, 0, 0, 1]}, {box: {}}]}]\n");
  ASSERT_EQ(parameters.tools[0].display.size(), 2u);
  EXPECT_EQ(parameters.tools[0].display[0].shape.radius_m, 0.01);
  EXPECT_EQ(parameters.tools[0].display[0].colour_rgba, Rgba(1, 0, 0, 1));
}

}  // namespace
}  // namespace polyscalpel
