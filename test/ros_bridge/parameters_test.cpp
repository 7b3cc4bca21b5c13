// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/parameters.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
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
const std::string kFile = "mesh: {file: {path: parameters_test.cpp}}\n";

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
           "material: {}\nelement: {}\nintegration: {}\nsolver: {}\nstress: {}\nnode: {}\n"
           "regions: [{name: a, box: {lowest_m: [0, 0, 0], highest_m: [0, 0, 0]}, material: {}}]\n"
           "fixed: [{box: {lowest_m: [0, 0, 0], highest_m: [0, 0, 0]}}, {sphere: {radius_m: 1}}, {vertices: "
           "[0]}]\n"
           "tools:\n- shape: {box: {}}\n  blade_edge_m: [[0, 0, 0], [0, 0, 1]]\n  display: [{sphere: {}}]\n"
           "- {name: b, shape: {capsule: {}}}\n- {name: c, shape: {mesh: {path: parameters_test.cpp}}}\n",
       &fields);
  read("mesh: {ball: {}}\n", &fields);
  read(kCutting + "material: {strength_pa: 1}\nfracture: {}\n", &fields);
  read(kFile +
           "regions: [{name: a, group: {name: b}, material: {}}, {name: b, group: {number: 1}, material: {}},"
           " {name: c, sphere: {radius_m: 1}, material: {}}]\n",
       &fields);

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
      read(kCutting + "material: {}\nelement: {}\nintegration: {}\nsolver: {}\nnode: {}\n");
  const SimulationConfig defaults;
  EXPECT_EQ(read_parameters.simulation.material.youngs_modulus_pa, defaults.material.youngs_modulus_pa);
  EXPECT_EQ(read_parameters.simulation.element.quadrature_points, defaults.element.quadrature_points);
  EXPECT_EQ(read_parameters.simulation.element.formulation, defaults.element.formulation);
  EXPECT_EQ(read_parameters.simulation.element.stabilisation_modulus, defaults.element.stabilisation_modulus);
  EXPECT_EQ(read_parameters.simulation.element.strain, defaults.element.strain);
  EXPECT_EQ(read_parameters.simulation.element.exact_force, defaults.element.exact_force);
  EXPECT_EQ(read_parameters.simulation.integration.equilibrium_tolerance,
            defaults.integration.equilibrium_tolerance);
  EXPECT_EQ(read_parameters.simulation.integration.equilibrium_iterations,
            defaults.integration.equilibrium_iterations);
  EXPECT_EQ(read_parameters.simulation.integration.time_step_s, defaults.integration.time_step_s);
  EXPECT_EQ(read_parameters.simulation.integration.mode, defaults.integration.mode);
  EXPECT_EQ(read_parameters.simulation.integration.gravity_m_s2, defaults.integration.gravity_m_s2);
  EXPECT_EQ(read_parameters.simulation.integration.sleep_speed_m_s, defaults.integration.sleep_speed_m_s);
  EXPECT_EQ(read_parameters.simulation.integration.sleep_after_s, defaults.integration.sleep_after_s);
  EXPECT_EQ(read_parameters.simulation.solver.kind, defaults.solver.kind);
  EXPECT_EQ(read_parameters.simulation.solver.tolerance, defaults.solver.tolerance);
  EXPECT_EQ(read_parameters.simulation.solver.error_target, defaults.solver.error_target);
  EXPECT_EQ(read_parameters.simulation.solver.max_iterations, defaults.solver.max_iterations);
  EXPECT_EQ(read_parameters.simulation.solver.projection, defaults.solver.projection);
  EXPECT_EQ(read_parameters.simulation.solver.precision, defaults.solver.precision);
  EXPECT_EQ(read_parameters.simulation.solver.threads, defaults.solver.threads);
  EXPECT_EQ(read_parameters.simulation.solver.step_budget_ms, defaults.solver.step_budget_ms);
  EXPECT_EQ(read_parameters.simulation.solver.refresh_after_steps, defaults.solver.refresh_after_steps);
  EXPECT_EQ(read_parameters.simulation.cutting->hold_back, CuttingConfig().hold_back);
  EXPECT_EQ(read_parameters.simulation.contact->stiffness_pa_m, ContactConfig().stiffness_pa_m);
  EXPECT_EQ(read_parameters.node.clock, NodeConfig().clock);
  EXPECT_EQ(read_parameters.node.budget_in_lockstep, NodeConfig().budget_in_lockstep);
  EXPECT_EQ(read_parameters.node.tool_timeout_s, NodeConfig().tool_timeout_s);
  EXPECT_FALSE(read(kSmallest).simulation.cutting.has_value());
  EXPECT_FALSE(read(kSmallest).simulation.contact.has_value());
  EXPECT_FALSE(read(kSmallest).simulation.stress.has_value());
  EXPECT_FALSE(read(kCutting).simulation.fracture.has_value());
  EXPECT_EQ(
      read(kCutting + "material: {strength_pa: 1}\nfracture: {}\n").simulation.fracture->max_splits_per_step,
      FractureConfig().max_splits_per_step);
  EXPECT_TRUE(read(kSmallest).simulation.regions.empty());
  EXPECT_EQ(read(kSmallest + "stress: {}\n").simulation.stress->interval_steps,
            StressConfig().interval_steps);
  EXPECT_EQ(read_parameters.node.colour_by, ColourBy::kNone);
  EXPECT_EQ(read_parameters.node.colour_range_pa, NodeConfig().colour_range_pa);
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
      {"integration: {time_step_s: $}", "0.01", "0"},
      {"integration: {mass_damping_per_s: $}", "0", "-1e-9"},
      {"integration: {contact_iterations: $}", "20", "21"},
      {"integration: {contact_iterations: $}", "1", "0"},
      {"integration: {mass_floor: $}", "1", "1.001"},
      {"integration: {equilibrium_tolerance: $}", "1e-12", "0.99e-12"},
      {"integration: {equilibrium_tolerance: $}", "0.1", "0.1001"},
      {"integration: {equilibrium_iterations: $}", "1", "0"},
      {"integration: {equilibrium_iterations: $}", "1000", "1001"},
      {"integration: {mode: $}", "dynamic", "quasistatic"},
      {"integration: {sleep_speed_m_s: $}", "0", "-1e-9"},
      {"integration: {sleep_after_s: $}", "0", "-1e-9"},
      {"integration: {sleep_after_s: $}", "1000000", "1000000.1"},
      {"solver: {kind: $}", "aggregates", "CHOLMOD"},
      {"solver: {kind: $}", "direct", ""},
      {"solver: {tolerance: $}", "1e-12", "0.99e-12"},
      {"solver: {tolerance: $}", "0.1", "0.1001"},
      {"solver: {tolerance: $}", "1e-4", "0"},
      {"solver: {tolerance: $}", "1e-4", "-1e-4"},
      {"solver: {error_target: $}", "1e-10", "0.99e-10"},
      {"solver: {error_target: $}", "0.1", "0.1001"},
      {"solver: {max_iterations: $}", "1", "0"},
      {"solver: {max_iterations: $}", "100000", "100001"},
      {"solver: {projection: $}", "0", "-1"},
      {"solver: {projection: $}", "20", "21"},
      {"solver: {precision: $}", "single", "half"},
      {"solver: {threads: $}", "1", "0"},
      {"solver: {threads: $}", "256", "257"},
      {"solver: {threads: $}", "2", "1.5"},
      {"solver: {step_budget_ms: $}", "1e-3", "0"},
      {"solver: {step_budget_ms: $}", "1000000", "1000000.1"},
      {"solver: {step_budget_ms: $}", "5", "-5"},
      {"solver: {refresh_after_steps: $}", "1", "0"},
      {"solver: {refresh_after_steps: $}", "1000000", "1000001"},
      {"stress: {interval_steps: $}", "1", "0"},
      {"stress: {interval_steps: $}", "1000000", "1000001"},
      {"stress: {interval_steps: $}", "2", "1.5"},
      {"material: {youngs_modulus_pa: $}", "1e-3", "0"},
      {"material: {poisson_ratio: $}", "0.4999", "0.5"},
      {"material: {poisson_ratio: $}", "-0.9999", "-1"},
      {"material: {density_kg_m3: $}", "1", "-1"},
      {"element: {quadrature_points: $}", "11", "5"},
      {"element: {stabilisation_scale: $}", "0.1", "0"},
      {"element: {formulation: $}", "virtual", "mean"},
      {"element: {stabilisation_modulus: $}", "shear", "none"},
      {"element: {strain: $}", "green", "corotational"},
      {"element: {exact_force: $}", "false", "0"},
      {"regions: [{name: $, sphere: {radius_m: 1}, material: {}}]", "a tumour", ""},
      {"regions: [{name: a, sphere: {radius_m: $}, material: {}}]", "1e-9", "0"},
      {"regions: [{name: a, box: {lowest_m: [0, 0, 0], highest_m: [0, 0, $]}, material: {}}]", "0", "-1e-9"},
      {"regions: [{name: a, sphere: {radius_m: 1}, material: {poisson_ratio: $}}]", "0.499", "0.5"},
      {"regions: [{name: a, sphere: {radius_m: 1}, material: {}, quadrature_points: $}]", "11", "2"},
      {"regions: [{name: a, sphere: {radius_m: 1}, material: {}, formulation: $}]", "virtual", "none"},
      {"regions: [{name: a, sphere: {radius_m: 1}, material: {}, order: $}]", "2147483647", "2147483648"},
      {"regions: [{name: a, sphere: {radius_m: 1}, material: {}, order: $}]", "-2147483647", "-2147483648"},
      {"regions: [{name: a, sphere: {radius_m: 1}, material: {}, order: $}]", "0", "0.5"},
      {"stress: {}\nnode: {colour_by: $}", "max_principal", "principal"},
      {"stress: {}\nnode: {colour_range_pa: [-1, $]}", "1", "-1"},
      {"stress: {}\nnode: {colour_range_pa: [0, $]}", "0", "-1e-9"},
      {"stress: {}\nnode: {colour_range_pa: [1, $]}", "1.0001", "1"},
      {"material: {strength_pa: $}", "0", "-1e-9"},
      {"material: {fracture_toughness_j_m2: $}", "0", "-1e-9"},
      {"material: {fracture_toughness_j_m2: $}", "100000", "100001"},
      {"material: {strength_pa: 1}\ncutting: {}\nfracture: {max_splits_per_step: $}", "1", "0"},
      {"material: {strength_pa: 1}\ncutting: {}\nfracture: {max_splits_per_step: $}", "1000000", "1000001"},
      {"material: {strength_pa: 1}\ncutting: {}\nfracture: {max_splits_per_step: $}", "2", "1.5"},
      {"cutting: {snap_tolerance: $}", "0.2", "0.21"},
      {"cutting: {snap_tolerance: $}", "1e-6", "0"},
      {"cutting: {hold_back: $}", "2", "2.01"},
      {"cutting: {max_travel: $}", "1", "1.01"},
      {"cutting: {debris_volume_m3: $}", "0", "-1e-9"},
      {"cutting: {max_travel: $}", "0.001", "0.0009"},
      {"cutting: {close_front_after_s: $}", "0", "-0.1"},
      {"contact: {friction_coefficient: $}", "10", "10.1"},
      {"contact: {margin_m: $}", "1e-4", "0"},
      {"node: {budget_in_lockstep: $}", "true", "1"},
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
    if (bound.text.find("name: $") == std::string::npos && bound.text.find("frame: $") == std::string::npos)
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
  expectRefused([] { read(kSmallest + "material: {strength_pa: 1}\nfracture: {}\n"); },
                {"fracture", "cutting"});
  expectRefused([] { read(kCutting + "fracture: {}\n"); }, {"fracture", "strength_pa > 0"});
  expectRefused([] { read(kSmallest + "cutting: {fracture_toughness_j_m2: 1}\n"); }, {"unknown key"});
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

TEST(Parameters, ReadsHowCellsBecomeElements) {
  const auto element = [](const std::string& fields) {
    return read(kSmallest + "element: {" + fields + "}\n").simulation.element;
  };
  EXPECT_EQ(element("formulation: mean_value").formulation, Formulation::kMeanValue);
  EXPECT_EQ(element("formulation: virtual").formulation, Formulation::kVirtual);
  EXPECT_EQ(element("stabilisation_modulus: automatic").stabilisation_modulus,
            StabilisationModulus::kAutomatic);
  EXPECT_EQ(element("stabilisation_modulus: full").stabilisation_modulus, StabilisationModulus::kFull);
  EXPECT_EQ(element("stabilisation_modulus: shear").stabilisation_modulus, StabilisationModulus::kShear);
  EXPECT_EQ(element("strain: corotated").strain, Strain::kCorotated);
  EXPECT_EQ(element("strain: linear").strain, Strain::kLinear);
  EXPECT_EQ(element("strain: green").strain, Strain::kGreen);
  EXPECT_EQ(element("quadrature_points: 1").quadrature_points, 1);
  EXPECT_FALSE(element("exact_force: false").exact_force);
  expectRefused([&] { element("corotated: true"); },
                {"scene.yaml:2", "element.corotated", "unknown key", "strain"});
  expectRefused([&] { element("gradient_correction: false"); },
                {"element.gradient_correction", "unknown key"});
  expectRefused([&] { element("strain: greens"); },
                {"scene.yaml:2", "element.strain = greens", "did you mean green?"});
}

TEST(Parameters, ReadsTheModeOfAnalysis) {
  const auto mode = [](const std::string& word) {
    return read(kSmallest + "fixed: [{vertices: [0]}]\nintegration: {mode: " + word + "}\n")
        .simulation.integration.mode;
  };
  EXPECT_EQ(mode("dynamic"), AnalysisMode::kDynamic);
  EXPECT_EQ(mode("quasi_static"), AnalysisMode::kQuasiStatic);
  EXPECT_EQ(mode("static"), AnalysisMode::kStatic);
  for (const std::string word : {"static", "quasi_static"})
    expectRefused([&] { read(kSmallest + "integration: {mode: " + word + "}\n"); },
                  {"scene.yaml", "fixed", "hold"});
}

TEST(Parameters, ReadsHowStepsAreSolved) {
  const auto solver = [](const std::string& fields) {
    return read(kSmallest + "solver: {" + fields + "}\n").simulation.solver;
  };
  EXPECT_EQ(solver("kind: auto").kind, SolverKind::kAuto);
  EXPECT_EQ(solver("kind: direct").kind, SolverKind::kDirect);
  EXPECT_EQ(solver("kind: jacobi").kind, SolverKind::kJacobi);
  EXPECT_EQ(solver("kind: factor").kind, SolverKind::kFactor);
  EXPECT_EQ(solver("kind: aggregates").kind, SolverKind::kAggregates);
  EXPECT_EQ(solver("precision: auto").precision, Precision::kAuto);
  EXPECT_EQ(solver("precision: single").precision, Precision::kSingle);
  EXPECT_EQ(solver("precision: double").precision, Precision::kDouble);
  const SolverConfig all = solver(
      "tolerance: 1e-8, error_target: 1e-3, max_iterations: 7, projection: 4, threads: 3, "
      "step_budget_ms: 2.5, refresh_after_steps: 11");
  EXPECT_EQ(all.tolerance, 1e-8);
  EXPECT_EQ(all.error_target, 1e-3);
  EXPECT_EQ(all.max_iterations, 7);
  EXPECT_EQ(all.projection, 4);
  EXPECT_EQ(all.threads, 3);
  EXPECT_EQ(all.step_budget_ms, 2.5);
  EXPECT_EQ(all.refresh_after_steps, 11);
  EXPECT_EQ(read(kSmallest + "integration: {sleep_speed_m_s: 1e-3, sleep_after_s: 2}\n")
                .simulation.integration.sleep_after_s,
            2);

  expectRefused([&] { solver("kind: jakobi"); },
                {"scene.yaml:2", "solver.kind = jakobi",
                 "must be one of auto, direct, jacobi, factor, aggregates", "did you mean jacobi?"});
  expectRefused([&] { solver("precision: float"); },
                {"scene.yaml:2", "solver.precision = float", "must be one of auto, single, double"});
  expectRefused([&] { solver("tolerance: .nan"); },
                {"scene.yaml:2", "solver.tolerance = .nan", "[1e-12, 0.1]"});
  expectRefused([&] { solver("step_budget_ms: 0"); },
                {"scene.yaml:2", "solver.step_budget_ms = 0", "(0, 1000000]"});
  expectRefused([&] { solver("threads: 0"); }, {"scene.yaml:2", "solver.threads = 0", "[1, 256]"});
  expectRefused([&] { solver("step_budget: 5"); },
                {"scene.yaml:2", "solver.step_budget", "unknown key", "did you mean step_budget_ms?"});
  expectRefused([] { read(kSmallest + "solver: direct\n"); }, {"scene.yaml:2", "solver = direct", "map"});
  for (const std::string strain : {"linear", "green"}) {
    const std::string element = kSmallest + "element: {strain: " + strain + "}\n";
    EXPECT_NO_THROW(read(element + "solver: {kind: auto}\n"));
    EXPECT_NO_THROW(read(element + "solver: {kind: direct}\n"));
    for (const std::string kind : {"jacobi", "factor", "aggregates"})
      expectRefused([&] { read(element + "solver: {kind: " + kind + "}\n"); },
                    {"scene.yaml:3", "solver.kind = " + kind, "element.strain is corotated"});
  }
}

TEST(Parameters, LockstepLeavesOutABudgetUnlessAsked) {
  const std::string budget = kSmallest + "solver: {kind: jacobi, step_budget_ms: 5}\n";
  const auto check = [](const std::string& scene, bool is_left_out, const std::optional<double>& kept_ms) {
    SCOPED_TRACE(scene);
    const SceneParameters parameters = read(scene);
    EXPECT_EQ(leavesOutBudget(parameters), is_left_out);
    const SimulationConfig config = makeSimulationConfig(parameters);
    EXPECT_EQ(config.solver.step_budget_ms, kept_ms);
    EXPECT_EQ(config.solver.kind, parameters.simulation.solver.kind) << "nothing else changes";
  };
  check(budget, false, 5);
  check(budget + "node: {clock: realtime}\n", false, 5);
  check(budget + "node: {clock: realtime, budget_in_lockstep: true}\n", false, 5);
  check(budget + "node: {clock: lockstep}\n", true, std::nullopt);
  check(budget + "node: {clock: lockstep, budget_in_lockstep: false}\n", true, std::nullopt);
  check(budget + "node: {clock: lockstep, budget_in_lockstep: true}\n", false, 5);
  check(kSmallest + "node: {clock: lockstep}\n", false, std::nullopt);
}

TEST(Parameters, ReadsRegions) {
  const SceneParameters parameters = read(
      kFile +
      "material: {youngs_modulus_pa: 2, poisson_ratio: 0.3, density_kg_m3: 900}\n"
      "regions:\n"
      "- {name: ball, sphere: {centre_m: [1, 2, 3], radius_m: 4}, material: {youngs_modulus_pa: 5}, order: "
      "-2}\n"
      "- {name: box, box: {lowest_m: [0, 0, 0], highest_m: [1, 1, 1]}, material: {}, formulation: virtual}\n"
      "- {name: by number, group: {number: 7}, material: {}, quadrature_points: 11}\n"
      "- {name: by name, group: {name: left vein}, material: {}}\n");
  const std::vector<RegionConfig>& regions = parameters.simulation.regions;
  ASSERT_EQ(regions.size(), 4u);
  EXPECT_EQ(regions[0].name, "ball");
  EXPECT_EQ(std::get<RegionSphere>(regions[0].cells).centre_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(std::get<RegionSphere>(regions[0].cells).radius_m, 4);
  EXPECT_EQ(regions[0].material.youngs_modulus_pa, 5);
  EXPECT_EQ(regions[0].material.poisson_ratio, 0.3) << "as in the scene's material";
  EXPECT_EQ(regions[0].material.density_kg_m3, 900);
  EXPECT_EQ(regions[0].order, -2);
  EXPECT_FALSE(regions[0].formulation.has_value());
  EXPECT_FALSE(regions[0].quadrature_points.has_value());
  EXPECT_EQ(std::get<RegionBox>(regions[1].cells).highest_m, Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(regions[1].formulation, Formulation::kVirtual);
  EXPECT_FALSE(regions[1].order.has_value());
  EXPECT_EQ(std::get<RegionGroup>(regions[2].cells).group, 7);
  EXPECT_EQ(regions[2].quadrature_points, 11);
  EXPECT_EQ(std::get<RegionGroup>(regions[3].cells).group, 0);
  EXPECT_EQ(std::get<RegionGroup>(regions[3].cells).name, "left vein");
}

TEST(Parameters, RefusesRegionsThatDoNotFit) {
  const auto refuse = [](const std::string& mesh, const std::string& regions,
                         const std::vector<std::string>& words) {
    SCOPED_TRACE(regions);
    expectRefused([&] { read(mesh + "regions: [" + regions + "]\n"); }, words);
  };
  const std::string ball = "sphere: {radius_m: 1}";
  refuse(kSmallest, "{" + ball + ", material: {}}", {"scene.yaml:2", "regions[0].name is missing"});
  refuse(kSmallest, "{name: a, " + ball + "}", {"regions[0].material is missing"});
  refuse(kSmallest, "{name: a, material: {}}", {"regions[0]", "exactly one of box, sphere, group"});
  refuse(kSmallest, "{name: a, " + ball + ", group: {number: 1}, material: {}}", {"exactly one of"});
  refuse(kSmallest, "{name: a, sphere: {}, material: {}}", {"regions[0].sphere.radius_m is missing"});
  refuse(kSmallest, "{name: a, " + ball + ", material: {}},\n {name: a, " + ball + ", material: {}}",
         {"scene.yaml:3", "regions[1].name = a", "differ"});
  refuse(kSmallest, "{name: a, group: {number: 1}, material: {}}", {"regions[0].group", "mesh file"});
  refuse(kFile, "{name: a, group: {}, material: {}}", {"regions[0].group", "exactly one of number, name"});
  refuse(kFile, "{name: a, group: {number: 1, name: b}, material: {}}", {"exactly one of number, name"});
  for (const std::string number : {"0", "-1", ".nan", "1.5", "2147483648"})
    refuse(kFile, "{name: a, group: {number: " + number + "}, material: {}}",
           {"regions[0].group.number = " + number, "[1, 2147483647]"});
  refuse(kFile, "{name: a, group: {name: ''}, material: {}}", {"regions[0].group.name", "must be the name"});
  refuse(kSmallest, "{name: a, " + ball + ", material: {}, formulation: virtual, quadrature_points: 4}",
         {"regions[0].quadrature_points = 4", "virtual"});
  refuse(kSmallest, "{name: a, " + ball + ", material: {}, strain: green}",
         {"regions[0].strain", "unknown key"});
  expectRefused(
      [] {
        read(kSmallest +
             "element: {formulation: virtual}\n"
             "regions: [{name: a, sphere: {radius_m: 1}, material: {}, quadrature_points: 4}]\n");
      },
      {"scene.yaml:3", "regions[0].quadrature_points", "virtual"});
  EXPECT_NO_THROW(
      read(kSmallest +
           "element: {formulation: virtual}\nregions: [{name: a, sphere: {radius_m: 1}, material: "
           "{}, formulation: mean_value, quadrature_points: 4}]\n"));
}

TEST(Parameters, ColoursNeedTheStressTheyShow) {
  const auto node = [](const std::string& fields) {
    return read(kSmallest + "stress: {}\nnode: {" + fields + "}\n").node;
  };
  EXPECT_EQ(node("colour_by: none").colour_by, ColourBy::kNone);
  EXPECT_EQ(node("colour_by: von_mises").colour_by, ColourBy::kVonMises);
  EXPECT_EQ(node("colour_by: max_principal").colour_by, ColourBy::kMaxPrincipal);
  EXPECT_EQ(node("colour_by: error, colour_range_pa: [0, 5]").colour_by, ColourBy::kError);
  EXPECT_EQ(node("colour_range_pa: [-1, 5]").colour_range_pa, Eigen::Vector2d(-1, 5));
  EXPECT_NO_THROW(read(kSmallest + "node: {colour_by: none}\n"));
  EXPECT_EQ(read(kSmallest + "node: {colour_by: piece}\n").node.colour_by, ColourBy::kPiece);
  for (const std::string word : {"von_mises", "max_principal", "error"})
    expectRefused([&] { read(kSmallest + "node:\n  colour_by: " + word + "\n"); },
                  {"scene.yaml:3", "node.colour_by = " + word, "stress"});
  expectRefused([&] { node("colour_range_pa: [2, 1]"); },
                {"scene.yaml:3", "node.colour_range_pa", "low < high"});
  expectRefused([&] { node("colour_range_pa: [1]"); }, {"node.colour_range_pa", "2 numbers"});
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
