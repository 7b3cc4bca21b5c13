// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>

#include <geometry_msgs/TransformStamped.h>
#include <ros/time.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>
#include <Eigen/Geometry>

namespace polyscalpel {

/// A transform and the time it holds for; stamp zero: for all times.
struct StampedTransform {
  ros::Time stamp;
  Eigen::Isometry3d T_world_frame;
};

/// The tree of frames, filled from /tf and /tf_static by whoever receives them. Unlike tf2_ros' listener it
/// is part of the caller's thread, so that what is known when depends on the messages alone. Not thread-safe.
class TransformTree {
 public:
  /// clock_jump_s: a transform further back than this clears what is known, except static transforms.
  TransformTree(std::string world_frame, double clock_jump_s);

  /// Takes note of transforms; those with NaN, zero quaternions or empty frames are refused by tf2 and left
  /// out.
  void add(const tf2_msgs::TFMessage& message, bool is_static);

  /// T_world_frame at a time (zero: the latest), or nothing while it is not known.
  std::optional<StampedTransform> find(const std::string& frame, const ros::Time& stamp) const;

  /// Forgets all but static transforms.
  void clear();

 private:
  std::string world_frame_;
  ros::Duration clock_jump_;
  tf2::BufferCore buffer_;
  std::map<std::string, ros::Time> newest_;  // by child frame
};

}  // namespace polyscalpel
