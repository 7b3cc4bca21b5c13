// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/conversions.hpp"

#include <sstream>
#include <stdexcept>

namespace polyscalpel {
namespace {

[[noreturn]] void refuse(const std::string& field, const Eigen::Ref<const Eigen::VectorXd>& value,
                         const std::string& rule) {
  std::ostringstream message;
  message << field << " = [";
  for (Eigen::Index i = 0; i < value.size(); ++i) message << (i > 0 ? ", " : "") << value(i);
  message << "]: " << rule;
  throw std::invalid_argument(message.str());
}

std::string item(const std::string& field, std::size_t i) {
  return field + "[" + std::to_string(i) + "]";
}

/// 3 x n
Eigen::Matrix3Xd readPoints(const std::vector<geometry_msgs::Point>& points, const std::string& field) {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d point = fromMsg(points[i]);
    if (!point.allFinite()) refuse(item(field, i), point, "must be finite");
    result.col(static_cast<Eigen::Index>(i)) = point;
  }
  return result;
}

std::vector<CutOperation> readPlanes(const Cut::Request& request, const Eigen::Isometry3d& T_world_frame) {
  if (request.plane_points.size() != request.plane_normals.size())
    throw std::invalid_argument("plane_normals has " + std::to_string(request.plane_normals.size()) +
                                " entries: must be " + std::to_string(request.plane_points.size()) +
                                ", one for each of plane_points");
  const Eigen::Matrix3Xd points = readPoints(request.plane_points, "plane_points");
  std::vector<CutOperation> cuts;
  for (std::size_t i = 0; i < request.plane_normals.size(); ++i) {
    const Eigen::Vector3d normal = fromMsg(request.plane_normals[i]);
    if (!normal.allFinite()) refuse(item("plane_normals", i), normal, "must be finite");
    if (normal.isZero(0)) refuse(item("plane_normals", i), normal, "must be longer than 0");
    cuts.push_back(
        PlaneCut{T_world_frame * points.col(static_cast<Eigen::Index>(i)), T_world_frame.linear() * normal});
  }
  return cuts;
}

PolygonCut readPolygon(const std::vector<geometry_msgs::Point>& corners, const std::string& field,
                       const Eigen::Isometry3d& T_world_frame) {
  if (corners.size() < 3) throw std::invalid_argument(field + ": must have at least 3 corners");
  return PolygonCut{T_world_frame * readPoints(corners, field)};
}

/// edge_field, poses_field: names of the two in the request.
SweepCut readSweep(const std::vector<geometry_msgs::Point>& edge,
                   const std::vector<geometry_msgs::Pose>& poses, const std::string& edge_field,
                   const std::string& poses_field, const Eigen::Isometry3d& T_world_frame) {
  SweepCut sweep;
  sweep.edge_tool = readPoints(edge, edge_field);
  if (edge.size() < 2) throw std::invalid_argument(edge_field + ": must have at least 2 points");
  if (poses.size() < 2) throw std::invalid_argument(poses_field + ": must have at least 2 poses");
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const geometry_msgs::Pose& pose = poses[i];
    switch (checkPose(pose)) {
      case PoseCheck::kNotFinite:
        refuse(item(poses_field, i) + ".position", fromMsg(pose.position),
               "position and orientation must be finite");
      case PoseCheck::kBadQuaternion:
        refuse(item(poses_field, i) + ".orientation", fromMsg(pose.orientation),
               "must be a unit quaternion, its norm within 1e-3 of 1");
      case PoseCheck::kGood:
        sweep.T_world_tool.push_back(T_world_frame * fromMsg(pose));
    }
  }
  return sweep;
}

}  // namespace

geometry_msgs::Wrench toMsg(const Wrench& wrench) {
  geometry_msgs::Wrench msg;
  msg.force = toVectorMsg(wrench.force);
  msg.torque = toVectorMsg(wrench.torque);
  return msg;
}

std::vector<CutOperation> fromMsg(const Cut::Request& request, const Eigen::Isometry3d& T_world_frame) {
  std::vector<CutOperation> cuts = readPlanes(request, T_world_frame);
  if (!request.polygon.empty()) cuts.push_back(readPolygon(request.polygon, "polygon", T_world_frame));
  for (std::size_t i = 0; i < request.polygons.size(); ++i)
    cuts.push_back(readPolygon(request.polygons[i].corners, item("polygons", i) + ".corners", T_world_frame));
  if (!request.sweep_edge.empty() || !request.sweep_poses.empty())
    cuts.push_back(
        readSweep(request.sweep_edge, request.sweep_poses, "sweep_edge", "sweep_poses", T_world_frame));
  for (std::size_t i = 0; i < request.sweeps.size(); ++i) {
    const std::string name = item("sweeps", i);
    cuts.push_back(readSweep(request.sweeps[i].edge, request.sweeps[i].poses, name + ".edge", name + ".poses",
                             T_world_frame));
  }
  if (cuts.empty())
    throw std::invalid_argument(
        "the request holds no cut: must hold planes (plane_points, plane_normals), a polygon or polygons, "
        "a sweep (sweep_edge, sweep_poses) or sweeps");
  return cuts;
}

ContactForces toMsg(const std::vector<AppliedContact>& contacts, const std::vector<ToolConfig>& tools) {
  ContactForces msg;
  for (const AppliedContact& contact : contacts) {
    ContactForce force;
    force.tool = tools[static_cast<std::size_t>(contact.tool)].name;
    force.face = contact.face.index();
    force.point = toPointMsg(contact.point_world);
    force.force = toVectorMsg(contact.force_on_tissue_world);
    force.gap_m = contact.gap_m;
    msg.contacts.push_back(force);
  }
  return msg;
}

}  // namespace polyscalpel
