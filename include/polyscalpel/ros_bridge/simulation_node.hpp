// SPDX-License-Identifier: BSD-3-Clause
//
// The simulation behind ROS topics and services. Everything runs in the thread that calls run(): callbacks,
// services, tf and steps take turns, so there is nothing to lock, and what a step sees depends on the
// messages alone.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <polyscalpel/Cut.h>
#include <polyscalpel/Step.h>
#include <polyscalpel/StepStatus.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <tf2_ros/transform_broadcaster.h>
#include <Eigen/Geometry>

#include "polyscalpel/ros_bridge/cut_event_publisher.hpp"
#include "polyscalpel/ros_bridge/lockstep_clock.hpp"
#include "polyscalpel/ros_bridge/mesh_publisher.hpp"
#include "polyscalpel/ros_bridge/parameters.hpp"
#include "polyscalpel/ros_bridge/stamp_clock.hpp"
#include "polyscalpel/ros_bridge/status.hpp"
#include "polyscalpel/ros_bridge/tool_tracker.hpp"
#include "polyscalpel/ros_bridge/transform_tree.hpp"
#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel {

class SimulationNode {
 public:
  /// Builds the simulation and opens topics and services. Throws std::invalid_argument for what the scene
  /// asks for in vain.
  SimulationNode(const SceneParameters& parameters, const ros::NodeHandle& node_handle);

  /// Until ROS shuts down.
  void run();

 private:
  using ToolPoses = std::vector<std::optional<Eigen::Isometry3d>>;

  void subscribe();
  void advertise();
  void onPose(std::size_t tool, const geometry_msgs::PoseStamped& message);
  void onTransforms(const tf2_msgs::TFMessage& message, bool is_static);
  bool onReset(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response);
  bool onCut(Cut::Request& request, Cut::Response& response);
  bool onSetPaused(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response);
  bool onStep(Step::Request& request, Step::Response& response);

  /// Runs the steps that are due; returns how long to wait for messages until the next may be [s].
  double advance();
  double advanceRealtime(const ros::Time& now);
  /// The input of the next step in lockstep: from the clock, or without tools while none has ever sent a
  /// pose.
  std::optional<LockstepInput> nextLockstepInput(bool may_go_without_poses);
  ToolPoses latestPoses(const ros::Time& now);
  /// One step and all that is published after it.
  void step(const ToolPoses& T_world_tool, const ros::Time& stamp);
  /// Restarts the pace of real time with the next step.
  void restartPace();
  void noticeClockSetBack(const ros::Time& now);

  void makeCuts(const std::vector<CutOperation>& operations, Cut::Response& response);
  void publishCut(const CutReport& report, const ros::Time& stamp);
  void publishMesh();
  void publishStatus();
  void publishTools(const StepReport& report, const ToolPoses& T_world_tool);
  void publishDiagnostics();
  void publishTissueFrame();
  ros::Time stateStamp() const;

  SceneParameters parameters_;
  ros::NodeHandle node_handle_;
  Simulation simulation_;
  StampClock stamp_clock_;
  TransformTree transforms_;
  std::vector<ToolTracker> trackers_;
  LockstepClock lockstep_clock_;
  MeshPublisher mesh_publisher_;
  CutEventPublisher cut_event_publisher_;
  tf2_ros::TransformBroadcaster tf_broadcaster_;
  tf2_ros::StaticTransformBroadcaster static_tf_broadcaster_;
  ros::Publisher status_publisher_;
  ros::Publisher contacts_publisher_;
  ros::Publisher diagnostics_publisher_;
  std::vector<ros::Publisher> wrench_publishers_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;

  std::int64_t steps_per_mesh_ = 1;
  bool is_paused_ = false;
  ros::Time stamp_;            // of the state, zero before the first step
  ros::Time broadcast_stamp_;  // of the last tf broadcast
  ToolPoses T_world_tool_;
  StepReport report_;     // of the last step
  StepStatus status_;     // of the last step
  StepStatus diagnosed_;  // that the last diagnostics were made from
  BodyCounter body_counter_;
  RateMeter rate_meter_;

  ros::Time last_now_;
  std::optional<ros::Time> next_due_;
  ros::Time pace_start_;
  double pace_start_time_s_ = 0;
  double lag_s_ = 0;
  double diagnostics_due_s_ = 0;  // steady clock
};

}  // namespace polyscalpel
