// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <ros/time.h>
#include <Eigen/Geometry>

#include "polyscalpel/ros_bridge/tool_tracker.hpp"

namespace polyscalpel {

/// What one step in lockstep is made from.
struct LockstepInput {
  ros::Time stamp;                                             ///< t_k, the end of the step
  std::vector<std::optional<Eigen::Isometry3d>> T_world_tool;  ///< at t_k
};

/// Decides from the stamps of the poses alone when a step may run. t_k = t_0 + k h, t_0 being the first stamp
/// by value. A step runs when every tool is known to be there or not there at t_k, and some tool's stamps
/// have reached t_k: without poses time stands still. Where the clock behind the stamps was set, what came
/// before is simulated to its end and then t_0 is taken anew.
class LockstepClock {
 public:
  LockstepClock(double time_step_s, double tool_timeout_s);

  /// The input of the next step, or nothing as long as something is missing. Each call that returns an input
  /// moves on.
  std::optional<LockstepInput> next(std::vector<ToolTracker>& trackers, const StampClock& clock);

  /// Numbers of the tools that the last next() waited for; empty when it waited for any pose at all.
  const std::vector<int>& waitingFor() const { return waiting_for_; }

  /// How far the newest pose is ahead of the last step [s]; 0 before the first.
  double lead_s(const StampClock& clock) const;

  /// Time begins anew with the next pose.
  void clear();

 private:
  bool takeAnchor(const std::vector<ToolTracker>& trackers, const StampClock& clock);

  double time_step_s_;
  std::int64_t tool_timeout_ns_;
  int epoch_ = 0;
  std::optional<std::int64_t> anchor_ns_;
  std::int64_t steps_ = 0;  // since the anchor
  std::vector<int> waiting_for_;
};

}  // namespace polyscalpel
