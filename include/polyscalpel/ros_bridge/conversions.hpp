// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Vector3.h>
#include <geometry_msgs/Wrench.h>
#include <polyscalpel/ContactForces.h>
#include <polyscalpel/Cut.h>
#include <std_msgs/ColorRGBA.h>
#include <Eigen/Geometry>

#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel {

geometry_msgs::Point toPointMsg(const Eigen::Vector3d& point);
geometry_msgs::Vector3 toVectorMsg(const Eigen::Vector3d& vector);
geometry_msgs::Pose toPoseMsg(const Eigen::Isometry3d& T_a_b);
geometry_msgs::Transform toTransformMsg(const Eigen::Isometry3d& T_a_b);
geometry_msgs::Wrench toMsg(const Wrench& wrench);
std_msgs::ColorRGBA toColourMsg(const Eigen::Vector4d& rgba);

Eigen::Vector3d fromMsg(const geometry_msgs::Point& point);
Eigen::Vector3d fromMsg(const geometry_msgs::Vector3& vector);
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

/// The cuts that a request asks for, given in the frame T_world_frame: planes, polygons, sweeps, in this
/// order, at least one. Throws std::invalid_argument, naming field and value, when it asks for nothing, has
/// not as many points as normals of planes, a normal that is zero, too few corners, points or poses, or
/// anything that is not finite.
std::vector<CutOperation> fromMsg(const Cut::Request& request, const Eigen::Isometry3d& T_world_frame);

/// Without header and time. names: of the tools.
ContactForces toMsg(const std::vector<AppliedContact>& contacts, const std::vector<ToolConfig>& tools);

}  // namespace polyscalpel
