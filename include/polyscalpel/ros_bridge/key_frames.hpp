// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/ros_bridge/natural_spline.hpp"
#include "polyscalpel/ros_bridge/yaml_reader.hpp"

namespace polyscalpel {

/// Poses of a tool at given times.
struct KeyFrames {
  std::string tool = "scalpel";  ///< name of the tool in the scene
  std::string frame = "world";   ///< tf frame of the poses
  std::vector<double> times_s;   ///< rising, the first >= 0
  Eigen::Matrix3Xd positions;    ///< 3 x n [m]
  std::vector<Eigen::Quaterniond> orientations;
};

/// Reads key frames from a YAML file, at least two. Throws std::invalid_argument "file:line: path = value:
/// must be ...".
KeyFrames loadKeyFrames(const std::string& file);

/// The same from a document that is open already.
KeyFrames readKeyFrames(YamlMap& document);

/// The motion through key frames: positions on the natural cubic spline, orientations on the shortest arc at
/// constant speed between two frames.
class ToolPath {
 public:
  explicit ToolPath(const KeyFrames& key_frames);

  /// T_frame_tool at a time since the start of the path [s]; the end poses before the first and after the
  /// last frame.
  Eigen::Isometry3d at(double time_s) const;

  /// Time of the last key frame [s].
  double duration_s() const { return times_s_.back(); }

 private:
  std::vector<double> times_s_;
  std::vector<Eigen::Quaterniond> orientations_;
  NaturalSpline positions_;
};

}  // namespace polyscalpel
