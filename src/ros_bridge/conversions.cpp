// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/conversions.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace polyscalpel {
namespace {

constexpr double kQuaternionTolerance = 1e-3;

Eigen::Vector4d quaternion(const geometry_msgs::Quaternion& xyzw) {
  return {xyzw.x, xyzw.y, xyzw.z, xyzw.w};
}

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
        refuse(item(poses_field, i) + ".orientation", quaternion(pose.orientation),
               "must be a unit quaternion, its norm within 1e-3 of 1");
      case PoseCheck::kGood:
        sweep.T_world_tool.push_back(T_world_frame * fromMsg(pose));
    }
  }
  return sweep;
}

}  // namespace

geometry_msgs::Point toPointMsg(const Eigen::Vector3d& point) {
  geometry_msgs::Point msg;
  msg.x = point.x();
  msg.y = point.y();
  msg.z = point.z();
  return msg;
}

geometry_msgs::Vector3 toVectorMsg(const Eigen::Vector3d& vector) {
  geometry_msgs::Vector3 msg;
  msg.x = vector.x();
  msg.y = vector.y();
  msg.z = vector.z();
  return msg;
}

geometry_msgs::Transform toTransformMsg(const Eigen::Isometry3d& T_a_b) {
  const Eigen::Quaterniond q(T_a_b.linear());
  geometry_msgs::Transform msg;
  msg.translation = toVectorMsg(T_a_b.translation());
  msg.rotation.x = q.x();
  msg.rotation.y = q.y();
  msg.rotation.z = q.z();
  msg.rotation.w = q.w();
  return msg;
}

geometry_msgs::Pose toPoseMsg(const Eigen::Isometry3d& T_a_b) {
  geometry_msgs::Pose msg;
  msg.position = toPointMsg(T_a_b.translation());
  msg.orientation = toTransformMsg(T_a_b).rotation;
  return msg;
}

geometry_msgs::Wrench toMsg(const Wrench& wrench) {
  geometry_msgs::Wrench msg;
  msg.force = toVectorMsg(wrench.force);
  msg.torque = toVectorMsg(wrench.torque);
  return msg;
}

std_msgs::ColorRGBA toColourMsg(const Eigen::Vector4d& rgba) {
  std_msgs::ColorRGBA msg;
  msg.r = static_cast<float>(rgba(0));
  msg.g = static_cast<float>(rgba(1));
  msg.b = static_cast<float>(rgba(2));
  msg.a = static_cast<float>(rgba(3));
  return msg;
}

Eigen::Vector3d fromMsg(const geometry_msgs::Point& point) {
  return {point.x, point.y, point.z};
}

Eigen::Vector3d fromMsg(const geometry_msgs::Vector3& vector) {
  return {vector.x, vector.y, vector.z};
}

Eigen::Isometry3d fromMsg(const geometry_msgs::Pose& pose) {
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();
  T_a_b.linear() = Eigen::Quaterniond(quaternion(pose.orientation)).normalized().toRotationMatrix();
  T_a_b.translation() = fromMsg(pose.position);
  return T_a_b;
}

Eigen::Isometry3d fromMsg(const geometry_msgs::Transform& transform) {
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();
  T_a_b.linear() = Eigen::Quaterniond(quaternion(transform.rotation)).normalized().toRotationMatrix();
  T_a_b.translation() = fromMsg(transform.translation);
  return T_a_b;
}

PoseCheck checkPose(const geometry_msgs::Pose& pose) {
  const Eigen::Vector4d xyzw = quaternion(pose.orientation);
  if (!fromMsg(pose.position).allFinite() || !xyzw.allFinite()) return PoseCheck::kNotFinite;
  return std::abs(xyzw.norm() - 1) <= kQuaternionTolerance ? PoseCheck::kGood : PoseCheck::kBadQuaternion;
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
