// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <geometry_msgs/Wrench.h>
#include <polyscalpel/ContactForces.h>
#include <polyscalpel/Cut.h>
#include <Eigen/Geometry>

#include "polyscalpel/ros_bridge/geometry_conversions.hpp"
#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel {

geometry_msgs::Wrench toMsg(const Wrench& wrench);

/// The cuts that a request asks for, given in the frame T_world_frame: planes, polygons, sweeps, in this
/// order, at least one. Throws std::invalid_argument, naming field and value, when it asks for nothing, has
/// not as many points as normals of planes, a normal that is zero, too few corners, points or poses, or
/// anything that is not finite.
std::vector<CutOperation> fromMsg(const Cut::Request& request, const Eigen::Isometry3d& T_world_frame);

/// Without header and time. names: of the tools.
ContactForces toMsg(const std::vector<AppliedContact>& contacts, const std::vector<ToolConfig>& tools);

}  // namespace polyscalpel
