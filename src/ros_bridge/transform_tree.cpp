// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/transform_tree.hpp"

#include <algorithm>
#include <utility>

#include <tf2/exceptions.h>

#include "polyscalpel/ros_bridge/geometry_conversions.hpp"

namespace polyscalpel {
namespace {

constexpr double kCacheTime_s = 60;

std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

}  // namespace

TransformTree::TransformTree(std::string world_frame, double clock_jump_s)
    : world_frame_(std::move(world_frame)), clock_jump_(clock_jump_s), buffer_(ros::Duration(kCacheTime_s)) {}

void TransformTree::add(const tf2_msgs::TFMessage& message, bool is_static) {
  for (const geometry_msgs::TransformStamped& transform : message.transforms) {
    if (!is_static) {
      const auto newest = newest_.find(transform.child_frame_id);
      // Without this a looping bag's transforms would be ignored as old for good.
      if (newest != newest_.end() && transform.header.stamp < newest->second &&
          newest->second - transform.header.stamp > clock_jump_)
        clear();
      // What is told twice, for example by a bag beside its sender, is no news; tf2 would warn.
      if (newest_.count(transform.child_frame_id) > 0 &&
          transform.header.stamp == newest_[transform.child_frame_id])
        continue;
      newest_[transform.child_frame_id] = std::max(newest_[transform.child_frame_id], transform.header.stamp);
    }
    buffer_.setTransform(transform, "polyscalpel", is_static);
  }
}

std::optional<StampedTransform> TransformTree::find(const std::string& frame, const ros::Time& stamp) const {
  const std::string source = withoutSlash(frame);
  if (source == world_frame_) return StampedTransform{stamp, Eigen::Isometry3d::Identity()};
  if (source.empty()) return std::nullopt;
  try {
    const geometry_msgs::TransformStamped transform = buffer_.lookupTransform(world_frame_, source, stamp);
    return StampedTransform{transform.header.stamp, fromMsg(transform.transform)};
  } catch (const tf2::TransformException&) {
    return std::nullopt;  // not known, or not yet
  }
}

void TransformTree::clear() {
  buffer_.clear();
  newest_.clear();
}

}  // namespace polyscalpel
