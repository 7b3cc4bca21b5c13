// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/key_frames.hpp"

#include <algorithm>
#include <cmath>

#include "polyscalpel/ros_bridge/parameters.hpp"

namespace polyscalpel {
namespace {

/// Longest path [s].
constexpr double kLongestPath_s = 1e6;

Eigen::Quaterniond readFrameOrientation(YamlMap& frame) {
  const bool has_angles = frame.has("orientation_rpy_deg");
  if (has_angles && frame.has("orientation_xyzw"))
    frame.refuse("orientation_rpy_deg", "must not be given beside orientation_xyzw");
  if (!has_angles) return readOrientation(frame, "orientation_xyzw");
  // Roll, pitch, yaw about the fixed axes x, y, z in this order (REP-103).
  Eigen::Vector3d rpy_deg = Eigen::Vector3d::Zero();
  frame.numbers("orientation_rpy_deg", rpy_deg, {-360, 360});
  const Eigen::Vector3d rpy = rpy_deg * (M_PI / 180);
  return (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
      .normalized();
}

}  // namespace

KeyFrames readKeyFrames(YamlMap& document) {
  KeyFrames result;
  document.text("tool", result.tool, "the name of a tool");
  document.text("frame", result.frame, "a tf frame");
  std::vector<YamlMap> frames = document.maps("key_frames");
  if (frames.size() < 2) document.refuse("key_frames", "must be a list of at least 2 key frames");
  result.positions.resize(3, static_cast<Eigen::Index>(frames.size()));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    YamlMap& frame = frames[i];
    frame.require("time_s");
    frame.require("position_m");
    double time_s = 0;
    frame.number("time_s", time_s, {0, kLongestPath_s});
    if (i > 0 && time_s <= result.times_s.back())
      frame.refuse("time_s", "must be later than the key frame before, " + toText(result.times_s.back()));
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    frame.numbers("position_m", position, kAnyNumber);
    result.times_s.push_back(time_s);
    result.positions.col(static_cast<Eigen::Index>(i)) = position;
    result.orientations.push_back(readFrameOrientation(frame));
    frame.finish();
  }
  document.finish();
  return result;
}

KeyFrames loadKeyFrames(const std::string& file) {
  YamlMap document = YamlMap::load(file);
  return readKeyFrames(document);
}

ToolPath::ToolPath(const KeyFrames& key_frames)
    : times_s_(key_frames.times_s),
      orientations_(key_frames.orientations),
      positions_(key_frames.times_s, key_frames.positions) {}

Eigen::Isometry3d ToolPath::at(double time_s) const {
  Eigen::Isometry3d T_frame_tool = Eigen::Isometry3d::Identity();
  T_frame_tool.translation() = positions_.at(time_s);
  const auto next = std::upper_bound(times_s_.begin(), times_s_.end(), time_s);
  Eigen::Quaterniond orientation = next == times_s_.begin() ? orientations_.front() : orientations_.back();
  if (next != times_s_.begin() && next != times_s_.end()) {
    const auto i = static_cast<std::size_t>(next - times_s_.begin()) - 1;
    const double s = (time_s - times_s_[i]) / (times_s_[i + 1] - times_s_[i]);
    orientation = orientations_[i].slerp(s, orientations_[i + 1]).normalized();
  }
  T_frame_tool.linear() = orientation.toRotationMatrix();
  return T_frame_tool;
}

}  // namespace polyscalpel
