// SPDX-License-Identifier: BSD-3-Clause
//
// The only reader of a scene: one YAML file becomes one SceneParameters, or is refused.
#pragma once

#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <Eigen/Geometry>

#include "polyscalpel/ros_bridge/yaml_reader.hpp"
#include "polyscalpel/simulation/simulation_config.hpp"

namespace polyscalpel {

/// How simulated time is driven.
enum class ClockMode {
  kRealtime,  ///< by ROS time: a late step lets simulated time fall behind
  kLockstep,  ///< by the stamps of the poses: reproducible to the bit at any machine speed
};

/// What the colours of the tissue show.
enum class ColourBy {
  kNone,          ///< one colour each for the surface and for cut faces
  kPiece,         ///< the pieces that a cut has made, each in its own colour
  kVonMises,      ///< von Mises' equivalent stress [Pa]
  kMaxPrincipal,  ///< largest principal stress [Pa], tension positive
  kError,         ///< estimated error energy of a cell over its volume at rest [J/m^3 = Pa]
};

/// A colour, each in [0, 1].
using Rgba = Eigen::Vector4d;

/// A shape that is drawn with a tool and touches nothing.
struct DisplayShape {
  ShapeConfig shape;
  Rgba colour_rgba = Rgba(0.72, 0.74, 0.78, 1);
};

/// Where the poses of a tool come from. One for each ToolConfig, in the same order.
struct ToolInputConfig {
  std::string topic;         ///< of geometry_msgs/PoseStamped; by default "<name>/measured_cp"; empty when
                             ///< follow_frame is given
  std::string follow_frame;  ///< tf frame that the tool follows instead of a topic
  std::string frame;         ///< the tool's own tf frame, of its wrench; by default its name, or follow_frame
  bool broadcast_tf = true;  ///< publish world_frame -> frame; never when a tf frame is followed
  std::vector<DisplayShape>
      display;  ///< drawn instead of the contact shape; empty: the contact shape is drawn
  Rgba colour_rgba = Rgba(0.72, 0.74, 0.78, 1);  ///< of the contact shape
};

/// The node beside the simulation.
struct NodeConfig {
  ClockMode clock = ClockMode::kRealtime;
  bool budget_in_lockstep = false;  ///< kLockstep: keep SolverConfig::step_budget_ms, at the price that a
                                    ///< bag replays to the same bits no more
  std::string world_frame = "world";
  std::string tissue_frame =
      "tissue";  ///< published on tf as a fixed child of the world frame, identical with it
  bool start_paused = false;
  double tool_timeout_s = 0.5;         ///< in (0, 3600]: a tool silent for longer is taken away
  double tf_timeout_s = 0.5;           ///< in [0, 3600]: a pose waits so long for its transform
  double clock_jump_s = 1;             ///< in (0, 3600]: a stamp further back than this starts the clock anew
  double longest_gap_s = 60;           ///< in (0, 1e6]: a stamp further ahead than this starts the clock anew
  double mesh_rate_hz = 30;            ///< in (0, 1000]: mesh messages a second of simulated time
  bool wireframe = false;              ///< draw the edges of the cells' faces on the surface
  bool piece_labels = true;            ///< name the pieces as soon as there are several
  bool pending_points = true;          ///< show where edges are crossed by a blade and not yet split
  double contact_arrow_m_per_n = 0.1;  ///< in (0, 1000]: length of the arrow of a contact force
  Rgba surface_colour_rgba = Rgba(0.62, 0.20, 0.17, 1);
  Rgba cut_colour_rgba = Rgba(0.93, 0.55, 0.50, 1);
  ColourBy colour_by = ColourBy::kNone;  ///< kNone and kPiece; any other: needs SimulationConfig::stress
  /// Values of the first and the last colour, the first smaller; both 0: smallest and largest value at hand.
  Eigen::Vector2d colour_range_pa = Eigen::Vector2d::Zero();
};

/// A whole scene.
struct SceneParameters {
  SimulationConfig simulation;
  std::vector<ToolInputConfig> tools;
  NodeConfig node;
};

/// Reads and checks a scene. mesh_folders: where relative mesh paths are looked for after the scene's own
/// folder. Throws std::invalid_argument "file:line: key.path = value: must be ..." for anything unknown, of a
/// wrong type or out of range, and for mesh files that are not there.
SceneParameters loadScene(const std::string& file, const std::vector<std::string>& mesh_folders);

/// The same from a document that is open already; document.fields then lists every field that was asked for.
SceneParameters readScene(YamlMap& scene, const std::vector<std::string>& mesh_folders);

/// Whether the clock of the node leaves out the solver's step_budget_ms: in lockstep, unless
/// NodeConfig::budget_in_lockstep. With a budget the steps would depend on the machine's speed.
bool leavesOutBudget(const SceneParameters& parameters);

/// The simulation as the node runs it: the scene's, without a budget that its clock leaves out.
SimulationConfig makeSimulationConfig(const SceneParameters& parameters);

/// The scene that the private parameters of a node ask for: ~scene (path or package:// URI of a scene,
/// required), ~mesh_path (folders separated by colons, default empty: for relative mesh paths) and ~clock
/// ("", "realtime" or "lockstep", default "": as in the scene). Warns of private parameters that it does not
/// know. Throws std::invalid_argument.
SceneParameters loadFromNode(const ros::NodeHandle& private_node_handle);

/// A text parameter of a node; default_value where it is not set. Throws std::invalid_argument when it is not
/// text.
std::string textParameter(const ros::NodeHandle& private_node_handle, const std::string& name,
                          const std::string& default_value);

/// Warns of private parameters whose name is not among those known; they may be left from an earlier run.
void warnOfUnknownParameters(const ros::NodeHandle& private_node_handle,
                             const std::vector<std::string>& known);

/// A unit quaternion from x, y, z, w; `map` names it in the message of std::invalid_argument when its norm is
/// off 1 by more than 1e-3.
Eigen::Quaterniond readOrientation(YamlMap& map, const std::string& key);

}  // namespace polyscalpel
