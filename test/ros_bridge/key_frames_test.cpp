// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/key_frames.hpp"

#include <cmath>
#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include "ros_bridge/expect_refused.hpp"
#include "ros_bridge/test_paths.hpp"

namespace polyscalpel {
namespace {

using testing::expectRefused;
using testing::sourcePath;

TEST(NaturalSpline, GoesThroughItsPoints) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  const std::vector<double> times = {0, 0.3, 1, 1.1, 4};
  const Eigen::Matrix3Xd points = Eigen::Matrix3Xd::NullaryExpr(3, 5, [&] { return unit(random); });
  const NaturalSpline spline(times, points);
  for (int i = 0; i < 5; ++i) EXPECT_LT((spline.at(times[i]) - points.col(i)).norm(), 1e-14);
  EXPECT_EQ(spline.at(-1), points.col(0));
  EXPECT_EQ(spline.at(5), points.col(4));
}

TEST(NaturalSpline, IsTwiceSmoothAndStraightAtItsEnds) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  const std::vector<double> times = {0, 0.5, 1.5, 2, 3};
  const Eigen::Matrix3Xd points = Eigen::Matrix3Xd::NullaryExpr(3, 5, [&] { return unit(random); });
  const NaturalSpline spline(times, points);
  // On each side of a point three values give the one-sided derivatives of a cubic up to O(d).
  const double d = 1e-4;
  const auto second = [&](double t, double side) {
    return Eigen::Vector3d((spline.at(t) - 2 * spline.at(t + side * d) + spline.at(t + 2 * side * d)) /
                           (d * d));
  };
  const auto first = [&](double t, double side) {
    return Eigen::Vector3d(
        side * (4 * spline.at(t + side * d) - 3 * spline.at(t) - spline.at(t + 2 * side * d)) / (2 * d));
  };
  for (const double t : {0.5, 1.5, 2.0}) {
    EXPECT_LT((first(t, 1) - first(t, -1)).norm(), 1e-5) << t;
    EXPECT_LT((second(t, 1) - second(t, -1)).norm(), 2e-2) << t;
  }
  EXPECT_LT(second(0, 1).norm(), 2e-2);
  EXPECT_LT(second(3, -1).norm(), 2e-2);
}

TEST(NaturalSpline, KeepsStraightLinesStraight) {
  const std::vector<double> times = {0, 1, 3, 3.5};
  Eigen::Matrix3Xd points(3, 4);
  for (int i = 0; i < 4; ++i)
    points.col(i) = Eigen::Vector3d(1, 2, 3) + times[i] * Eigen::Vector3d(0.1, -2, 4);
  const NaturalSpline spline(times, points);
  for (double t = 0; t < 3.5; t += 0.1)
    EXPECT_LT((spline.at(t) - Eigen::Vector3d(1, 2, 3) - t * Eigen::Vector3d(0.1, -2, 4)).norm(), 1e-13);
}

TEST(NaturalSpline, RefusesTimesThatDoNotRise) {
  const Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 2);
  expectRefused([&] { NaturalSpline({1, 1}, points); }, {"times_s[1]"});
  expectRefused([&] { NaturalSpline({0, std::nan("")}, points); }, {"times_s[1]"});
  expectRefused([&] { NaturalSpline({0}, points.leftCols(1)); }, {"at least 2"});
  expectRefused([&] { NaturalSpline({0, 1, 2}, points); }, {"one a time"});
}

KeyFrames parse(const std::string& text) {
  YamlMap document = YamlMap::parse(text, "path.yaml");
  return readKeyFrames(document);
}

const std::string kTwo = "key_frames:\n- {time_s: 0, position_m: [0, 0, 0]}\n";

TEST(KeyFrames, TurnAtConstantSpeedOnTheShortestArc) {
  const KeyFrames frames =
      parse(kTwo + "- {time_s: 2, position_m: [1, 0, 0], orientation_rpy_deg: [0, 0, 90]}\n");
  const ToolPath path(frames);
  EXPECT_EQ(path.duration_s(), 2);
  for (const double t : {0.0, 0.5, 1.0, 1.7, 2.0, 3.0}) {
    const double angle = std::min(t, 2.0) / 2 * M_PI / 2;
    const Eigen::Matrix3d expected = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    EXPECT_LT((path.at(t).linear() - expected).norm(), 1e-14) << t;
    EXPECT_LT((path.at(t).translation() - Eigen::Vector3d(std::min(t, 2.0) / 2, 0, 0)).norm(), 1e-14) << t;
  }
}

TEST(KeyFrames, ReadToolAndFrame) {
  const KeyFrames frames = parse("tool: knife\nframe: table\n" + kTwo +
                                 "- {time_s: 1, position_m: [1, 0, 0], orientation_xyzw: [1, 0, 0, 0]}\n");
  EXPECT_EQ(frames.tool, "knife");
  EXPECT_EQ(frames.frame, "table");
  EXPECT_EQ(frames.positions.col(1), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(frames.orientations[1].x(), 1);
}

TEST(KeyFrames, RefuseWhatIsNoPath) {
  expectRefused([] { parse(kTwo); }, {"path.yaml", "key_frames", "at least 2"});
  expectRefused([] { parse("tool: a\n"); }, {"path.yaml", "key_frames", "at least 2"});
  expectRefused([] { parse(kTwo + "- {time_s: 0, position_m: [0, 0, 0]}\n"); }, {"path.yaml:3", "later"});
  expectRefused([] { parse(kTwo + "- {position_m: [0, 0, 0]}\n"); }, {"key_frames[1].time_s is missing"});
  expectRefused([] { parse(kTwo + "- {time_s: 1}\n"); }, {"key_frames[1].position_m is missing"});
  expectRefused([] { parse(kTwo + "- {time_s: 1, position_m: [0, .nan, 0]}\n"); },
                {"key_frames[1].position_m[1]"});
  expectRefused(
      [] { parse(kTwo + "- {time_s: 1, position_m: [0, 0, 0], orientation_xyzw: [0, 0, 0, 0]}\n"); },
      {"key_frames[1].orientation_xyzw", "unit quaternion"});
  expectRefused(
      [] {
        parse(kTwo +
              "- {time_s: 1, position_m: [0, 0, 0], orientation_xyzw: [0, 0, 0, 1], "
              "orientation_rpy_deg: [0, 0, 0]}\n");
      },
      {"orientation_rpy_deg"});
  expectRefused([] { parse(kTwo + "- {time_s: 1, position_m: [0, 0, 0], orientation: [0, 0, 0, 1]}\n"); },
                {"path.yaml:3", "unknown key"});
}

TEST(KeyFrames, AllPathsOfThePackageAreValid) {
  int paths = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sourcePath("config/tools"))) {
    SCOPED_TRACE(entry.path().string());
    ++paths;
    EXPECT_NO_THROW(loadKeyFrames(entry.path().string()));
  }
  EXPECT_GE(paths, 1);
}

}  // namespace
}  // namespace polyscalpel
