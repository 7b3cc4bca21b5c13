// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>

#include <geometry_msgs/PoseStamped.h>
#include <ros/time.h>
#include <Eigen/Geometry>

#include "polyscalpel/ros_bridge/stamp_clock.hpp"
#include "polyscalpel/ros_bridge/transform_tree.hpp"

namespace polyscalpel {

/// What became of the poses sent for a tool.
struct PoseCounters {
  std::uint64_t received = 0;
  std::uint64_t not_finite = 0;      ///< refused: NaN or infinite
  std::uint64_t bad_quaternion = 0;  ///< refused: norm off 1 by more than 1e-3
  std::uint64_t bad_stamp = 0;       ///< refused: zero, or not newer than the one before
  std::uint64_t no_transform = 0;    ///< dropped: no transform to the world frame in time
  std::uint64_t clock_jumps = 0;     ///< the tool's clock was set
  std::uint64_t timeouts = 0;        ///< the tool was let go because it was silent
};

/// A tool at one time.
struct TrackedPose {
  enum class State {
    kPresent,
    kAbsent,   ///< not there at that time, whatever comes later
    kWaiting,  ///< not known yet
  };
  State state = State::kWaiting;
  Eigen::Isometry3d T_world_tool = Eigen::Isometry3d::Identity();  ///< when present
};

/// The poses of one tool: refuses bad ones, brings good ones to the world frame, and tells where the tool is
/// at a time.
class ToolTracker {
 public:
  /// tool_frame: poses given in the tool's own frame are refused as having no transform. clock: of all tools,
  /// this being number `tool` of it. Both references must outlive the tracker.
  ToolTracker(int tool, std::string tool_frame, double tool_timeout_s, double tf_timeout_s, StampClock& clock,
              const TransformTree& transforms);

  /// Takes a message. now: ROS time of its arrival. Returns whether it shows that the clock was set.
  bool add(const geometry_msgs::PoseStamped& message, const ros::Time& now);

  /// Takes a pose that tf told; stamp zero: it holds for all times. Returns whether it shows that the clock
  /// was set.
  bool addFollowed(const StampedTransform& pose, const ros::Time& now);

  /// Transforms what is waiting, in order. expired(stamp, arrival): whether a pose has waited long enough and
  /// is dropped.
  using Expired = std::function<bool(int epoch, std::int64_t stamp_ns, const ros::Time& arrival)>;
  void resolve(const Expired& expired);

  /// resolve() by ROS time: poses wait tf_timeout_s after their arrival.
  void resolveByTime(const ros::Time& now);
  /// resolve() by stamps: poses wait until some tool's stamps are tf_timeout_s further on.
  void resolveByStamps();

  /// The newest pose, or nothing when there is none that arrived within tool_timeout_s.
  std::optional<Eigen::Isometry3d> latest(const ros::Time& now);

  /// The pose at a time of an epoch, between the two poses around it (linear, and on the shortest arc). Not
  /// there between two poses further apart than tool_timeout_s, before the first and after the last; the last
  /// is known to be the last when horizon_ns is more than tool_timeout_s later, or the tool is in a later
  /// epoch. anchor_ns: start of the epoch.
  TrackedPose at(int epoch, std::int64_t time_ns, std::int64_t anchor_ns, std::int64_t horizon_ns);

  /// Forgets poses that no time from this one on needs.
  void forgetBefore(int epoch, std::int64_t time_ns);

  /// Whether a pose of this or a later epoch has come in (or holds for all times).
  bool hasReached(int epoch) const;

  /// Forgets all poses; counters too when asked.
  void clear(bool counters);

  const PoseCounters& counters() const { return counters_; }

 private:
  struct Sample {
    int epoch = 0;
    std::int64_t stamp_ns = 0;
    ros::Time arrival;
    Eigen::Isometry3d T_world_tool;
  };
  struct Waiting {
    int epoch = 0;
    ros::Time arrival;
    geometry_msgs::PoseStamped message;
  };

  int tool_;
  std::string tool_frame_;
  std::int64_t tool_timeout_ns_;
  std::int64_t tf_timeout_ns_;
  StampClock& clock_;
  const TransformTree& transforms_;
  std::deque<Waiting> waiting_;
  std::deque<Sample> samples_;  // by epoch, then stamp
  std::optional<Eigen::Isometry3d> always_;
  PoseCounters counters_;
  bool timed_out_ = false;
};

}  // namespace polyscalpel
