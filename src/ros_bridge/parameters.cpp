// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <ros/console.h>
#include <ros/names.h>

#include "body_parameters.hpp"
#include "polyscalpel/ros_bridge/resource_path.hpp"

namespace polyscalpel {
namespace {

const Range kRatio{0, 1};

/// key: of the kind, in a map that may hold other keys as well.
ShapeConfig readShape(YamlMap& shape, const std::vector<std::string>& folders) {
  const std::string name = shape.oneOf({"sphere", "capsule", "box", "cylinder", "mesh"});
  YamlMap map = shape.map(name);
  ShapeConfig config;
  if (name == "mesh") {
    config.kind = ShapeKind::kMesh;
    config.path = findMeshFile(map, "path", folders);
    map.number("scale", config.scale, kPositive);
  } else if (name == "box") {
    config.kind = ShapeKind::kBox;
    map.numbers("size_m", config.size_m, kPositive);
  } else {
    config.kind = name == "sphere"    ? ShapeKind::kSphere
                  : name == "capsule" ? ShapeKind::kCapsule
                                      : ShapeKind::kCylinder;
    map.number("radius_m", config.radius_m, kPositive);
    if (name != "sphere") map.number("length_m", config.length_m, kPositive);
  }
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
  map.numbers("offset_m", offset_m, kAnyNumber);
  config.T_tool_shape.translation() = offset_m;
  config.T_tool_shape.linear() = readOrientation(map, "orientation_xyzw").toRotationMatrix();
  map.finish();
  return config;
}

void readColour(YamlMap& map, const std::string& key, Rgba& colour) {
  map.numbers(key, colour, kRatio);
}

void requireName(YamlMap& map, const std::string& key, const std::string& name, const std::string& rule) {
  std::string why;
  if (name.empty() || !ros::names::validate(name, why)) map.refuse(key, "must be " + rule);
}

void readTool(YamlMap tool, const std::vector<std::string>& folders, ToolConfig& config,
              ToolInputConfig& input) {
  const std::string kNameRule = "a ROS name of letters, digits and _";
  tool.text("name", config.name, kNameRule);
  requireName(tool, "name", config.name, kNameRule);
  if (config.name.find_first_of("/~") != std::string::npos) tool.refuse("name", "must be " + kNameRule);
  if (tool.has("shape")) {
    YamlMap shape = tool.map("shape");
    config.shape = readShape(shape, folders);
    shape.finish();
  }
  if (tool.has("blade_edge_m")) {
    Eigen::Matrix3Xd edge;
    tool.points("blade_edge_m", edge, 2);
    config.blade_edge_tool = edge;
  }
  tool.number("max_jump_m", config.max_jump_m, kPositive);

  tool.text("follow_frame", input.follow_frame, "a tf frame, or empty");
  if (!input.follow_frame.empty() && input.follow_frame.front() == '/')
    tool.refuse("follow_frame", "must be a tf frame without a leading slash");
  tool.text("topic", input.topic, "a ROS name; empty: <name>/measured_cp");
  if (!input.topic.empty()) requireName(tool, "topic", input.topic, "a ROS name");
  if (!input.topic.empty() && !input.follow_frame.empty())
    tool.refuse("topic", "must not be given beside follow_frame");
  if (input.topic.empty() && input.follow_frame.empty()) input.topic = config.name + "/measured_cp";
  tool.text("frame", input.frame, "a tf frame; empty: the tool's name, or follow_frame");
  if (!input.frame.empty() && input.frame.front() == '/')
    tool.refuse("frame", "must be a tf frame without a leading slash");
  if (!input.follow_frame.empty()) {
    if (!input.frame.empty()) tool.refuse("frame", "must not be given beside follow_frame");
    input.frame = input.follow_frame;
  } else if (input.frame.empty()) {
    input.frame = config.name;
  }
  tool.boolean("broadcast_tf", input.broadcast_tf);
  if (!input.follow_frame.empty()) input.broadcast_tf = false;
  readColour(tool, "colour_rgba", input.colour_rgba);
  for (YamlMap& display : tool.maps("display")) {
    DisplayShape shape;
    shape.shape = readShape(display, folders);
    readColour(display, "colour_rgba", shape.colour_rgba);
    display.finish();
    input.display.push_back(shape);
  }
  tool.finish();
}

void readIntegration(YamlMap map, IntegrationConfig& config) {
  readWord(map, "mode", config.mode,
           {{"dynamic", AnalysisMode::kDynamic},
            {"quasi_static", AnalysisMode::kQuasiStatic},
            {"static", AnalysisMode::kStatic}});
  map.number("time_step_s", config.time_step_s, {1e-6, 1});
  map.number("mass_damping_per_s", config.mass_damping_per_s, kNotNegative);
  map.number("stiffness_damping_s", config.stiffness_damping_s, kNotNegative);
  map.numbers("gravity_m_s2", config.gravity_m_s2, kAnyNumber);
  map.integer("contact_iterations", config.contact_iterations, {1, 20});
  map.number("equilibrium_tolerance", config.equilibrium_tolerance, {1e-12, 0.1});
  map.integer("equilibrium_iterations", config.equilibrium_iterations, {1, 1000});
  map.number("mass_floor", config.mass_floor, kRatio);
  map.number("sleep_speed_m_s", config.sleep_speed_m_s, kNotNegative);
  map.number("sleep_after_s", config.sleep_after_s, {0, 1e6});
  map.finish();
}

void readSolver(YamlMap map, Strain strain, SolverConfig& config) {
  readWord(map, "kind", config.kind,
           {{"auto", SolverKind::kAuto},
            {"direct", SolverKind::kDirect},
            {"jacobi", SolverKind::kJacobi},
            {"factor", SolverKind::kFactor},
            {"aggregates", SolverKind::kAggregates}});
  const bool is_for_every_strain = config.kind == SolverKind::kAuto || config.kind == SolverKind::kDirect;
  if (!is_for_every_strain && strain != Strain::kCorotated)
    map.refuse("kind", "must be auto or direct unless element.strain is corotated");
  map.number("tolerance", config.tolerance, {1e-12, 0.1});
  map.optionalNumber("error_target", config.error_target, {1e-10, 0.1});
  map.integer("max_iterations", config.max_iterations, {1, 1e5});
  map.integer("projection", config.projection, {0, 20});
  readWord(map, "precision", config.precision,
           {{"auto", Precision::kAuto}, {"single", Precision::kSingle}, {"double", Precision::kDouble}});
  map.integer("threads", config.threads, {1, 256});
  map.optionalNumber("step_budget_ms", config.step_budget_ms, {0, 1e6, true, false});
  map.integer("refresh_after_steps", config.refresh_after_steps, {1, 1e6});
  map.finish();
}

CuttingConfig readCutting(YamlMap map) {
  CuttingConfig config;
  map.number("snap_tolerance", config.snap_tolerance, {1e-6, 0.2});
  map.number("hold_back", config.hold_back, {0, 2});
  map.number("max_travel", config.max_travel, {1e-3, 1});
  map.number("close_front_after_s", config.close_front_after_s, {0, 1e6});
  map.number("debris_volume_m3", config.debris_volume_m3, kNotNegative);
  map.finish();
  return config;
}

FractureConfig readFracture(YamlMap map) {
  FractureConfig config;
  map.integer("max_splits_per_step", config.max_splits_per_step, {1, 1e6});
  map.finish();
  return config;
}

ContactConfig readContact(YamlMap map) {
  ContactConfig config;
  map.number("stiffness_pa_m", config.stiffness_pa_m, kPositive);
  map.number("damping_pa_s_m", config.damping_pa_s_m, kNotNegative);
  map.number("friction_coefficient", config.friction_coefficient, {0, 10});
  map.number("friction_speed_m_s", config.friction_speed_m_s, kPositive);
  map.number("margin_m", config.margin_m, kPositive);
  map.finish();
  return config;
}

StressConfig readStress(YamlMap map) {
  StressConfig config;
  map.integer("interval_steps", config.interval_steps, {1, 1e6});
  map.finish();
  return config;
}

void readColouring(YamlMap& map, bool has_stress, NodeConfig& config) {
  readWord(map, "colour_by", config.colour_by,
           {{"none", ColourBy::kNone},
            {"piece", ColourBy::kPiece},
            {"von_mises", ColourBy::kVonMises},
            {"max_principal", ColourBy::kMaxPrincipal},
            {"error", ColourBy::kError}});
  const bool shows_stress = config.colour_by != ColourBy::kNone && config.colour_by != ColourBy::kPiece;
  if (shows_stress && !has_stress) map.refuse("colour_by", "needs the scene's stress, which is not there");
  map.numbers("colour_range_pa", config.colour_range_pa, kAnyNumber);
  const bool is_automatic = config.colour_range_pa.isZero(0);
  if (!is_automatic && !(config.colour_range_pa(0) < config.colour_range_pa(1)))
    map.refuse("colour_range_pa", "must be [low, high] with low < high, or [0, 0]");
}

void readNode(YamlMap map, bool has_stress, NodeConfig& config) {
  readWord(map, "clock", config.clock,
           {{"realtime", ClockMode::kRealtime}, {"lockstep", ClockMode::kLockstep}});
  map.boolean("budget_in_lockstep", config.budget_in_lockstep);
  map.text("world_frame", config.world_frame, "a tf frame");
  map.text("tissue_frame", config.tissue_frame, "a tf frame");
  for (const auto& [key, frame] : {std::pair<std::string, std::string>("world_frame", config.world_frame),
                                   std::pair<std::string, std::string>("tissue_frame", config.tissue_frame)})
    if (frame.front() == '/') map.refuse(key, "must be a tf frame without a leading slash");
  if (config.tissue_frame == config.world_frame) map.refuse("tissue_frame", "must differ from world_frame");
  map.boolean("start_paused", config.start_paused);
  map.number("tool_timeout_s", config.tool_timeout_s, {0, 3600, true, false});
  map.number("tf_timeout_s", config.tf_timeout_s, {0, 3600});
  map.number("clock_jump_s", config.clock_jump_s, {0, 3600, true, false});
  map.number("longest_gap_s", config.longest_gap_s, {0, 1e6, true, false});
  map.number("mesh_rate_hz", config.mesh_rate_hz, {0, 1000, true, false});
  map.boolean("wireframe", config.wireframe);
  map.boolean("piece_labels", config.piece_labels);
  map.boolean("pending_points", config.pending_points);
  map.number("contact_arrow_m_per_n", config.contact_arrow_m_per_n, {0, 1000, true, false});
  readColour(map, "surface_colour_rgba", config.surface_colour_rgba);
  readColour(map, "cut_colour_rgba", config.cut_colour_rgba);
  readColouring(map, has_stress, config);
  map.finish();
}

/// Frames that one tree of tf cannot hold twice.
void requireDistinctFrames(YamlMap& scene, const SceneParameters& parameters) {
  std::vector<std::string> frames = {parameters.node.world_frame, parameters.node.tissue_frame};
  for (std::size_t i = 0; i < parameters.tools.size(); ++i) {
    const std::string& frame = parameters.tools[i].frame;
    for (const std::string& other : frames)
      if (frame == other && parameters.tools[i].follow_frame.empty())
        scene.refuse("tools", "the frame \"" + frame + "\" of tool " + parameters.simulation.tools[i].name +
                                  " must differ from every other tool's, the world's and the tissue's");
    frames.push_back(frame);
  }
}

}  // namespace

Eigen::Quaterniond readOrientation(YamlMap& map, const std::string& key) {
  Eigen::Vector4d xyzw(0, 0, 0, 1);
  map.numbers(key, xyzw, {-1.001, 1.001});
  if (std::abs(xyzw.norm() - 1) > 1e-3)
    map.refuse(key, "must be a unit quaternion, its norm within 1e-3 of 1");
  return Eigen::Quaterniond(xyzw).normalized();
}

SceneParameters readScene(YamlMap& scene, const std::vector<std::string>& mesh_folders) {
  SceneParameters parameters;
  SimulationConfig& simulation = parameters.simulation;
  simulation.mesh = readMeshConfig(scene.map("mesh"), mesh_folders);
  if (scene.has("material")) readMaterial(scene.map("material"), simulation.material);
  if (scene.has("element")) readElement(scene.map("element"), simulation.element);
  simulation.regions = readRegions(scene, simulation);
  for (YamlMap& fixed : scene.maps("fixed")) simulation.fixed.push_back(readFixedRegion(fixed));
  if (scene.has("integration")) readIntegration(scene.map("integration"), simulation.integration);
  if (scene.has("solver")) readSolver(scene.map("solver"), simulation.element.strain, simulation.solver);
  if (scene.has("cutting")) simulation.cutting = readCutting(scene.map("cutting"));
  if (scene.has("fracture")) simulation.fracture = readFracture(scene.map("fracture"));
  if (scene.has("contact")) simulation.contact = readContact(scene.map("contact"));
  for (YamlMap& tool : scene.maps("tools")) {
    simulation.tools.emplace_back();
    parameters.tools.emplace_back();
    readTool(tool, mesh_folders, simulation.tools.back(), parameters.tools.back());
  }
  if (scene.has("stress")) simulation.stress = readStress(scene.map("stress"));
  if (scene.has("node")) readNode(scene.map("node"), simulation.stress.has_value(), parameters.node);
  scene.finish();
  requireDistinctFrames(scene, parameters);
  try {
    validate(simulation);
  } catch (const std::invalid_argument& exception) {
    throw std::invalid_argument(scene.document().file + ": " + exception.what());
  }
  return parameters;
}

SceneParameters loadScene(const std::string& file, const std::vector<std::string>& mesh_folders) {
  std::vector<std::string> folders = {std::filesystem::path(file).parent_path().string()};
  folders.insert(folders.end(), mesh_folders.begin(), mesh_folders.end());
  YamlMap scene = YamlMap::load(file);
  return readScene(scene, folders);
}

bool leavesOutBudget(const SceneParameters& parameters) {
  return parameters.simulation.solver.step_budget_ms && parameters.node.clock == ClockMode::kLockstep &&
         !parameters.node.budget_in_lockstep;
}

SimulationConfig makeSimulationConfig(const SceneParameters& parameters) {
  SimulationConfig config = parameters.simulation;
  if (leavesOutBudget(parameters)) config.solver.step_budget_ms.reset();
  return config;
}

std::string textParameter(const ros::NodeHandle& private_node_handle, const std::string& name,
                          const std::string& default_value) {
  XmlRpc::XmlRpcValue value;
  if (!private_node_handle.getParam(name, value)) return default_value;
  if (value.getType() != XmlRpc::XmlRpcValue::TypeString)
    throw std::invalid_argument("parameter " + private_node_handle.resolveName(name) + ": must be text");
  return static_cast<std::string>(value);
}

void warnOfUnknownParameters(const ros::NodeHandle& private_node_handle,
                             const std::vector<std::string>& known) {
  const std::string prefix = private_node_handle.getNamespace() + "/";
  std::vector<std::string> names;
  private_node_handle.getParamNames(names);
  for (const std::string& name : names) {
    if (name.compare(0, prefix.size(), prefix) != 0) continue;
    const std::string rest = name.substr(prefix.size());
    if (std::find(known.begin(), known.end(), rest) != known.end()) continue;
    const std::string nearest = nearestWord(rest, known);
    ROS_WARN("parameter %s is not known%s", name.c_str(),
             nearest.empty() ? "" : ("; did you mean ~" + nearest + "?").c_str());
  }
}

SceneParameters loadFromNode(const ros::NodeHandle& private_node_handle) {
  warnOfUnknownParameters(private_node_handle, {"scene", "mesh_path", "clock"});
  const std::string scene = textParameter(private_node_handle, "scene", "");
  if (scene.empty())
    throw std::invalid_argument("parameter " + private_node_handle.resolveName("scene") +
                                " is missing: must be the path of a scene, such as config/scenes/block.yaml");
  const std::string folders = textParameter(private_node_handle, "mesh_path", "");
  const std::string clock = textParameter(private_node_handle, "clock", "");
  if (!clock.empty() && clock != "realtime" && clock != "lockstep")
    throw std::invalid_argument("parameter " + private_node_handle.resolveName("clock") + " = " + clock +
                                ": must be realtime, lockstep or empty");
  SceneParameters parameters = loadScene(findResource(scene, {""}), splitSearchPath(folders));
  if (clock == "realtime") parameters.node.clock = ClockMode::kRealtime;
  if (clock == "lockstep") parameters.node.clock = ClockMode::kLockstep;
  return parameters;
}

}  // namespace polyscalpel
