// SPDX-License-Identifier: BSD-3-Clause
//
// Points, poses and colours as messages and back; knows nothing of the simulation.
#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Vector3.h>
#include <std_msgs/ColorRGBA.h>
#include <Eigen/Geometry>

namespace polyscalpel {

geometry_msgs::Point toPointMsg(const Eigen::Vector3d& point);
geometry_msgs::Vector3 toVectorMsg(const Eigen::Vector3d& vector);
geometry_msgs::Pose toPoseMsg(const Eigen::Isometry3d& T_a_b);
geometry_msgs::Transform toTransformMsg(const Eigen::Isometry3d& T_a_b);
std_msgs::ColorRGBA toColourMsg(const Eigen::Vector4d& rgba);

Eigen::Vector3d fromMsg(const geometry_msgs::Point& point);
Eigen::Vector3d fromMsg(const geometry_msgs::Vector3& vector);
/// x, y, z, w as they are.
Eigen::Vector4d fromMsg(const geometry_msgs::Quaternion& quaternion);
/// Quaternions are normalised.
Eigen::Isometry3d fromMsg(const geometry_msgs::Pose& pose);
Eigen::Isometry3d fromMsg(const geometry_msgs::Transform& transform);

/// Whether a pose may be used.
enum class PoseCheck {
  kGood,
  kNotFinite,
  kBadQuaternion,  ///< its norm is off 1 by more than 1e-3
};
PoseCheck checkPose(const geometry_msgs::Pose& pose);

}  // namespace polyscalpel
