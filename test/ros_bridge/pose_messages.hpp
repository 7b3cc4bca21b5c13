// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <geometry_msgs/PoseStamped.h>
#include <tf2_msgs/TFMessage.h>

namespace polyscalpel::testing {

/// A pose without rotation at (x, 0, 0).
inline geometry_msgs::PoseStamped poseAt(double stamp_s, double x, const std::string& frame = "world") {
  geometry_msgs::PoseStamped pose;
  pose.header.stamp = ros::Time(stamp_s);
  pose.header.frame_id = frame;
  pose.pose.position.x = x;
  pose.pose.orientation.w = 1;
  return pose;
}

/// The transform world -> child, a translation by (x, 0, 0).
inline tf2_msgs::TFMessage transformTo(const std::string& child, double stamp_s, double x) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.stamp = ros::Time(stamp_s);
  message.transforms[0].header.frame_id = "world";
  message.transforms[0].child_frame_id = child;
  message.transforms[0].transform.translation.x = x;
  message.transforms[0].transform.rotation.w = 1;
  return message;
}

}  // namespace polyscalpel::testing
