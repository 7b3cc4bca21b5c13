// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/geometry_conversions.hpp"

#include <cmath>

namespace polyscalpel {
namespace {

constexpr double kQuaternionTolerance = 1e-3;

template <class Msg>
Msg toXyz(const Eigen::Vector3d& xyz) {
  Msg msg;
  msg.x = xyz.x();
  msg.y = xyz.y();
  msg.z = xyz.z();
  return msg;
}

}  // namespace

geometry_msgs::Point toPointMsg(const Eigen::Vector3d& point) {
  return toXyz<geometry_msgs::Point>(point);
}

geometry_msgs::Vector3 toVectorMsg(const Eigen::Vector3d& vector) {
  return toXyz<geometry_msgs::Vector3>(vector);
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

std_msgs::ColorRGBA toColourMsg(const Eigen::Vector4d& rgba) {
  std_msgs::ColorRGBA msg;
  msg.r = static_cast<float>(rgba(0));
  msg.g = static_cast<float>(rgba(1));
  msg.b = static_cast<float>(rgba(2));
  msg.a = static_cast<float>(rgba(3));
  return msg;
}

Eigen::Vector4d fromMsg(const geometry_msgs::Quaternion& xyzw) {
  return {xyzw.x, xyzw.y, xyzw.z, xyzw.w};
}

Eigen::Vector3d fromMsg(const geometry_msgs::Point& point) {
  return {point.x, point.y, point.z};
}

Eigen::Vector3d fromMsg(const geometry_msgs::Vector3& vector) {
  return {vector.x, vector.y, vector.z};
}

Eigen::Isometry3d fromMsg(const geometry_msgs::Pose& pose) {
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();
  T_a_b.linear() = Eigen::Quaterniond(fromMsg(pose.orientation)).normalized().toRotationMatrix();
  T_a_b.translation() = fromMsg(pose.position);
  return T_a_b;
}

Eigen::Isometry3d fromMsg(const geometry_msgs::Transform& transform) {
  Eigen::Isometry3d T_a_b = Eigen::Isometry3d::Identity();
  T_a_b.linear() = Eigen::Quaterniond(fromMsg(transform.rotation)).normalized().toRotationMatrix();
  T_a_b.translation() = fromMsg(transform.translation);
  return T_a_b;
}

PoseCheck checkPose(const geometry_msgs::Pose& pose) {
  const Eigen::Vector4d xyzw = fromMsg(pose.orientation);
  if (!fromMsg(pose.position).allFinite() || !xyzw.allFinite()) return PoseCheck::kNotFinite;
  return std::abs(xyzw.norm() - 1) <= kQuaternionTolerance ? PoseCheck::kGood : PoseCheck::kBadQuaternion;
}

}  // namespace polyscalpel
