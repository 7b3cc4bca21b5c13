// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/conversions.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "ros_bridge/expect_refused.hpp"

namespace polyscalpel {
namespace {

using testing::expectRefused;

const double kNan = std::numeric_limits<double>::quiet_NaN();

Eigen::Isometry3d somePose() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.1, -0.2, 0.3);
  return pose;
}

std::vector<CutOperation> read(const Cut::Request& request) {
  return fromMsg(request, Eigen::Isometry3d::Identity());
}

TEST(Conversions, PosesGoThereAndBack) {
  EXPECT_LT((fromMsg(toPoseMsg(somePose())).matrix() - somePose().matrix()).norm(), 1e-15);
  EXPECT_LT((fromMsg(toTransformMsg(somePose())).matrix() - somePose().matrix()).norm(), 1e-15);
}

TEST(Conversions, CutsAreReadInTheWorldFrame) {
  Cut::Request request;
  request.plane_points = {toPointMsg({1, 0, 0}), toPointMsg({0, 1, 0})};
  request.plane_normals = {toVectorMsg({2, 0, 0}), toVectorMsg({0, 0, 1})};
  const std::vector<CutOperation> planes = fromMsg(request, somePose());
  ASSERT_EQ(planes.size(), 2u);
  const auto& plane = std::get<PlaneCut>(planes[0]);
  EXPECT_LT((plane.point_world - somePose() * Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((plane.normal_world - somePose().linear() * Eigen::Vector3d(2, 0, 0)).norm(), 1e-15);

  request = Cut::Request();
  request.polygon = {toPointMsg({0, 0, 0}), toPointMsg({1, 0, 0}), toPointMsg({0, 1, 0})};
  const auto polygon = std::get<PolygonCut>(fromMsg(request, somePose()).at(0));
  EXPECT_LT((polygon.corners_world.col(1) - somePose() * Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);

  request = Cut::Request();
  request.sweep_edge = {toPointMsg({0, 0, 0}), toPointMsg({0, 0, 1})};
  request.sweep_poses = {toPoseMsg(somePose()), toPoseMsg(Eigen::Isometry3d::Identity())};
  const auto sweep = std::get<SweepCut>(fromMsg(request, somePose()).at(0));
  EXPECT_LT((sweep.T_world_tool[0].matrix() - (somePose() * somePose()).matrix()).norm(), 1e-14);
  EXPECT_EQ(sweep.edge_tool.col(1), Eigen::Vector3d(0, 0, 1)) << "the edge is in the blade's own frame";
}

TEST(Conversions, ARequestMayHoldCutsOfAllKinds) {
  Cut::Request request;
  request.sweeps.resize(2);
  for (CutSweep& sweep : request.sweeps) {
    sweep.edge = {toPointMsg({0, 0, 0}), toPointMsg({0, 0, 1})};
    sweep.poses = {toPoseMsg(somePose()), toPoseMsg(Eigen::Isometry3d::Identity())};
  }
  request.polygon = {toPointMsg({0, 0, 0}), toPointMsg({0, 1, 0}), toPointMsg({0, 1, 1})};
  request.polygons.resize(1);
  request.polygons[0].corners = request.polygon;
  request.plane_points = {toPointMsg({0, 0, 0})};
  request.plane_normals = {toVectorMsg({0, 1, 0})};
  const std::vector<CutOperation> cuts = fromMsg(request, somePose());
  ASSERT_EQ(cuts.size(), 5u);
  EXPECT_TRUE(std::holds_alternative<PlaneCut>(cuts[0]));
  EXPECT_TRUE(std::holds_alternative<PolygonCut>(cuts[1]) && std::holds_alternative<PolygonCut>(cuts[2]));
  EXPECT_TRUE(std::holds_alternative<SweepCut>(cuts[3]) && std::holds_alternative<SweepCut>(cuts[4]));
}

TEST(Conversions, RefuseRequestsThatAreNoCut) {
  Cut::Request request;
  expectRefused([&] { read(request); }, {"no cut", "planes", "polygon", "sweep"});
  request.plane_points = {toPointMsg({0, 0, 0})};
  expectRefused([&] { read(request); }, {"plane_normals", "must be 1"});
  request.plane_normals = {toVectorMsg({0, 0, 0})};
  expectRefused([&] { read(request); }, {"plane_normals[0] = [0, 0, 0]", "longer than 0"});
  request.plane_normals = {toVectorMsg({0, kNan, 0})};
  expectRefused([&] { read(request); }, {"plane_normals[0]", "nan", "finite"});
  request.plane_normals = {toVectorMsg({0, 1, 0})};
  request.plane_points = {toPointMsg({0, 0, kNan})};
  expectRefused([&] { read(request); }, {"plane_points[0]", "finite"});
  request.plane_points = {toPointMsg({0, 0, 0})};
  request.polygons.resize(2);
  request.polygons[0].corners = {toPointMsg({0, 0, 0}), toPointMsg({0, 1, 0}), toPointMsg({0, 1, 1})};
  expectRefused([&] { read(request); }, {"polygons[1].corners", "3 corners"});
  request = Cut::Request();
  request.sweeps.resize(1);
  expectRefused([&] { read(request); }, {"sweeps[0].edge", "at least 2"});
  request = Cut::Request();
  request.polygon = {toPointMsg({0, 0, 0}), toPointMsg({0, 1, 0})};
  expectRefused([&] { read(request); }, {"polygon", "3 corners"});
  request = Cut::Request();
  request.sweep_edge = {toPointMsg({0, 0, 0}), toPointMsg({0, 1, 0})};
  expectRefused([&] { read(request); }, {"sweep_poses", "at least 2"});
  request.sweep_poses = {toPoseMsg(somePose()), geometry_msgs::Pose()};
  expectRefused([&] { read(request); }, {"sweep_poses[1].orientation", "unit quaternion"});
}

TEST(Conversions, PosesAreChecked) {
  geometry_msgs::Pose pose = toPoseMsg(somePose());
  EXPECT_EQ(checkPose(pose), PoseCheck::kGood);
  pose.position.z = kNan;
  EXPECT_EQ(checkPose(pose), PoseCheck::kNotFinite);
  EXPECT_EQ(checkPose(geometry_msgs::Pose()), PoseCheck::kBadQuaternion);
}

TEST(Conversions, ContactsKeepTheirOrderAndNames) {
  AppliedContact contact;
  contact.tool = 1;
  contact.face = FaceId(7);
  contact.point_world = Eigen::Vector3d(1, 2, 3);
  contact.force_on_tissue_world = Eigen::Vector3d(0, 0, -1);
  contact.gap_m = -1e-4;
  std::vector<ToolConfig> tools(2);
  tools[1].name = "finger";
  const ContactForces message = toMsg({contact}, tools);
  ASSERT_EQ(message.contacts.size(), 1u);
  EXPECT_EQ(message.contacts[0].tool, "finger");
  EXPECT_EQ(message.contacts[0].face, 7);
  EXPECT_EQ(message.contacts[0].force.z, -1);
  EXPECT_EQ(message.contacts[0].point.y, 2);
}

}  // namespace
}  // namespace polyscalpel
