// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/tool_tracker.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/blade_sweep.hpp"
#include "ros_bridge/pose_messages.hpp"

namespace polyscalpel {
namespace {

using testing::poseAt;
using testing::transformTo;
using State = TrackedPose::State;

constexpr double kToolTimeout_s = 0.5;
constexpr double kTfTimeout_s = 0.2;

class ToolTrackerTest : public ::testing::Test {
 protected:
  bool add(double stamp_s, double x, const std::string& frame = "world") {
    const bool jumped = tracker_.add(poseAt(stamp_s, x, frame), ros::Time(stamp_s));
    tracker_.resolveByStamps();
    return jumped;
  }
  TrackedPose at(double time_s, double horizon_s = 0, int epoch = 0) {
    return tracker_.at(epoch, toNanoseconds(time_s), toNanoseconds(10),
                       toNanoseconds(std::max(horizon_s, 10.0)));
  }

  StampClock clock_{1, 1, 60};
  TransformTree transforms_{"world", 1};
  ToolTracker tracker_{0, "tool", kToolTimeout_s, kTfTimeout_s, clock_, transforms_};
};

TEST_F(ToolTrackerTest, InterpolatesBetweenPoses) {
  add(10, 0);
  add(10.1, 1);
  add(10.2, 5);
  EXPECT_EQ(at(10.1).T_world_tool.translation().x(), 1);
  EXPECT_NEAR(at(10.15).T_world_tool.translation().x(), 3, 1e-12);
  EXPECT_EQ(at(10.15).state, State::kPresent);
}

TEST_F(ToolTrackerTest, IsNotThereInAGap) {
  add(10, 0);
  add(11, 1);
  EXPECT_EQ(at(10.5).state, State::kAbsent);
  EXPECT_EQ(at(11).state, State::kPresent);
  EXPECT_EQ(at(9.5).state, State::kAbsent) << "before the first pose";
}

TEST_F(ToolTrackerTest, IsLetGoWhenOthersAreFurtherOnByTheTimeout) {
  add(10, 0);
  EXPECT_EQ(at(10.1, 10.5).state, State::kWaiting);
  EXPECT_EQ(tracker_.counters().timeouts, 0u);
  EXPECT_EQ(at(10.1, 10.51).state, State::kAbsent);
  EXPECT_EQ(at(10.2, 10.7).state, State::kAbsent);
  EXPECT_EQ(tracker_.counters().timeouts, 1u) << "once for one silence";
}

TEST_F(ToolTrackerTest, RefusesAndCountsBadPoses) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  geometry_msgs::PoseStamped pose = poseAt(10, nan);
  tracker_.add(pose, ros::Time(10));
  pose = poseAt(10, 0);
  pose.pose.orientation.y = std::numeric_limits<double>::infinity();
  tracker_.add(pose, ros::Time(10));
  EXPECT_EQ(tracker_.counters().not_finite, 2u);

  pose = poseAt(10, 0);
  pose.pose.orientation.w = 0;
  tracker_.add(pose, ros::Time(10));
  pose.pose.orientation.w = 1.0011;
  tracker_.add(pose, ros::Time(10));
  EXPECT_EQ(tracker_.counters().bad_quaternion, 2u);

  tracker_.add(poseAt(0, 0), ros::Time(10));
  EXPECT_EQ(tracker_.counters().bad_stamp, 1u);
  tracker_.add(poseAt(10, 0, ""), ros::Time(10));
  tracker_.add(poseAt(10, 0, "tool"), ros::Time(10));
  EXPECT_EQ(tracker_.counters().no_transform, 2u) << "no frame, its own frame";
  EXPECT_EQ(tracker_.counters().received, 7u);
  tracker_.resolveByStamps();
  EXPECT_EQ(at(10).state, State::kWaiting) << "none of them may be used";

  pose = poseAt(10, 0);
  pose.pose.orientation.w = 1.0009;
  tracker_.add(pose, ros::Time(10));
  tracker_.resolveByStamps();
  EXPECT_EQ(at(10).state, State::kPresent) << "nearly a unit quaternion";
  EXPECT_LT((at(10).T_world_tool.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

TEST_F(ToolTrackerTest, DropsStampsThatGoBackALittle) {
  add(10, 0);
  add(10.2, 2);
  EXPECT_FALSE(add(10.1, 50));
  EXPECT_FALSE(add(10.2, 50)) << "the same stamp again";
  EXPECT_EQ(tracker_.counters().bad_stamp, 2u);
  EXPECT_NEAR(at(10.15).T_world_tool.translation().x(), 1.5, 1e-12);
}

TEST_F(ToolTrackerTest, BeginsAnewWhenTheClockWasSet) {
  add(10, 0);
  add(20, 2);
  EXPECT_TRUE(add(10, 3)) << "a bag loops";
  EXPECT_EQ(tracker_.counters().clock_jumps, 1u);
  EXPECT_EQ(at(20.1).state, State::kAbsent) << "the epoch before has ended";
  EXPECT_EQ(at(10, 0, 1).T_world_tool.translation().x(), 3);
}

TEST_F(ToolTrackerTest, WaitsForTheTransform) {
  add(10, 1, "camera");
  add(10.1, 2, "camera");
  EXPECT_EQ(at(10).state, State::kWaiting);
  transforms_.add(transformTo("camera", 9, 100), true);
  tracker_.resolveByStamps();
  EXPECT_NEAR(at(10.05).T_world_tool.translation().x(), 101.5, 1e-12);
  EXPECT_EQ(tracker_.counters().no_transform, 0u);
}

TEST_F(ToolTrackerTest, DropsAPoseWhoseTransformDoesNotCome) {
  add(10, 1, "nowhere");
  add(10.1, 2);
  EXPECT_EQ(at(10.1).state, State::kWaiting) << "in order: the first may still come";
  add(10.2, 3);
  EXPECT_EQ(tracker_.counters().no_transform, 1u);
  EXPECT_EQ(at(10.1).T_world_tool.translation().x(), 2);
}

TEST_F(ToolTrackerTest, InRealTimeIsThereForTheTimeout) {
  tracker_.add(poseAt(10, 4), ros::Time(100));
  tracker_.resolveByTime(ros::Time(100));
  ASSERT_TRUE(tracker_.latest(ros::Time(100.5)).has_value());
  EXPECT_EQ(tracker_.latest(ros::Time(100.5))->translation().x(), 4);
  EXPECT_FALSE(tracker_.latest(ros::Time(100.51)).has_value());
  EXPECT_FALSE(tracker_.latest(ros::Time(100.6)).has_value());
  EXPECT_EQ(tracker_.counters().timeouts, 1u);
}

TEST_F(ToolTrackerTest, InRealTimeDropsAPoseWithoutTransformAfterTheTimeout) {
  tracker_.add(poseAt(10, 4, "nowhere"), ros::Time(100));
  tracker_.resolveByTime(ros::Time(100.19));
  EXPECT_EQ(tracker_.counters().no_transform, 0u);
  tracker_.resolveByTime(ros::Time(100.21));
  EXPECT_EQ(tracker_.counters().no_transform, 1u);
}

TEST_F(ToolTrackerTest, FollowsAFrame) {
  transforms_.add(transformTo("tip", 10, 1), false);
  tracker_.addFollowed(*transforms_.find("tip", ros::Time()), ros::Time(10));
  transforms_.add(transformTo("tip", 10.1, 2), false);
  tracker_.addFollowed(*transforms_.find("tip", ros::Time()), ros::Time(10.1));
  tracker_.addFollowed(*transforms_.find("tip", ros::Time()), ros::Time(10.1));
  EXPECT_NEAR(at(10.05).T_world_tool.translation().x(), 1.5, 1e-12);
  EXPECT_EQ(tracker_.counters().bad_stamp, 0u) << "nothing new is nothing wrong";
}

TEST_F(ToolTrackerTest, AFixedFrameIsAlwaysThere) {
  transforms_.add(transformTo("fixture", 10, 7), true);
  tracker_.addFollowed(*transforms_.find("fixture", ros::Time()), ros::Time(10));
  EXPECT_EQ(at(1234).state, State::kPresent);
  EXPECT_EQ(tracker_.latest(ros::Time(5000))->translation().x(), 7);
}

TEST_F(ToolTrackerTest, ClearForgetsEverything) {
  add(10, 0);
  tracker_.clear(true);
  clock_.clear();
  EXPECT_EQ(tracker_.counters().received, 0u);
  EXPECT_EQ(at(10).state, State::kWaiting);
  EXPECT_FALSE(add(5, 0)) << "an earlier stamp is no jump any more";
}

TEST(Interpolate, KeepsEndsAndTurnsTheShortWay) {
  Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d end = Eigen::Isometry3d::Identity();
  start.linear() = Eigen::AngleAxisd(3.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  end.linear() = Eigen::AngleAxisd(-3.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_LT((interpolate(start, end, 0).matrix() - start.matrix()).norm(), 1e-14);
  EXPECT_LT((interpolate(start, end, 1).matrix() - end.matrix()).norm(), 1e-14);
  const Eigen::Matrix3d half = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_LT((interpolate(start, end, 0.5).linear() - half).norm(), 1e-14);
}

TEST(TransformTree, KnowsTheWorldAndWhatItWasTold) {
  TransformTree tree("world", 1);
  EXPECT_TRUE(tree.find("world", ros::Time(3))->T_world_frame.isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_FALSE(tree.find("", ros::Time(3)).has_value());
  EXPECT_FALSE(tree.find("a", ros::Time(3)).has_value());
  tree.add(transformTo("a", 3, 1), false);
  tree.add(transformTo("a", 4, 2), false);
  EXPECT_NEAR(tree.find("a", ros::Time(3.5))->T_world_frame.translation().x(), 1.5, 1e-9);
  EXPECT_NEAR(tree.find("/a", ros::Time(3.5))->T_world_frame.translation().x(), 1.5, 1e-9);
  EXPECT_FALSE(tree.find("a", ros::Time(4.5)).has_value()) << "not yet known";
  EXPECT_EQ(tree.find("a", ros::Time())->stamp, ros::Time(4));
}

TEST(TransformTree, StartsAnewWhenTheClockWasSetBack) {
  TransformTree tree("world", 1);
  tree.add(transformTo("fixture", 0, 9), true);
  tree.add(transformTo("a", 100, 1), false);
  tree.add(transformTo("a", 3, 2), false);
  tree.add(transformTo("a", 4, 3), false);
  EXPECT_NEAR(tree.find("a", ros::Time(3.5))->T_world_frame.translation().x(), 2.5, 1e-9);
  EXPECT_FALSE(tree.find("a", ros::Time(100)).has_value());
  EXPECT_NEAR(tree.find("fixture", ros::Time(3))->T_world_frame.translation().x(), 9, 1e-12)
      << "static ones stay";
}

TEST(TransformTree, LeavesOutTransformsThatAreNone) {
  TransformTree tree("world", 1);
  tf2_msgs::TFMessage message = transformTo("a", 3, 1);
  message.transforms[0].transform.rotation.w = 0;
  tree.add(message, false);
  message = transformTo("b", 3, std::numeric_limits<double>::quiet_NaN());
  tree.add(message, false);
  EXPECT_FALSE(tree.find("a", ros::Time(3)).has_value());
  EXPECT_FALSE(tree.find("b", ros::Time(3)).has_value());
}

}  // namespace
}  // namespace polyscalpel
