// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/geometry/triangle.hpp"

#include <random>

#include <gtest/gtest.h>

namespace polyscalpel {
namespace {

class TriangleTest : public ::testing::Test {
 protected:
  Eigen::Vector3d randomPoint() {
    return {coordinate_(generator_), coordinate_(generator_), coordinate_(generator_)};
  }
  Eigen::Matrix3d randomCorners() {
    Eigen::Matrix3d corners;
    for (int i = 0; i < 3; ++i) corners.col(i) = randomPoint();
    return corners;
  }

  std::mt19937 generator_{1};
  std::uniform_real_distribution<double> coordinate_{-1, 1};
};

constexpr int kSamples =
    60;  // an edge of the triangle; a sampled distance is off by at most an edge over this

TEST_F(TriangleTest, ClosestPointOnTriangleIsNoFartherThanAnySample) {
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Matrix3d corners = randomCorners();
    const Eigen::Vector3d p = 1.5 * randomPoint();
    const TrianglePoint closest = closestPointOnTriangle(p, corners);
    EXPECT_NEAR(closest.barycentric.sum(), 1, 1e-14);
    EXPECT_GE(closest.barycentric.minCoeff(), 0);
    EXPECT_LT((corners * closest.barycentric - closest.point).norm(), 1e-14);
    EXPECT_NEAR((closest.point - p).squaredNorm(), closest.squared_distance, 1e-14);
    double sampled = 1e9;
    for (int i = 0; i <= kSamples; ++i) {
      for (int j = 0; i + j <= kSamples; ++j) {
        const Eigen::Vector3d weights(i, j, kSamples - i - j);
        sampled = std::min(sampled, (corners * weights / kSamples - p).norm());
      }
    }
    const double distance = std::sqrt(closest.squared_distance);
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_GE(distance, sampled - 4.0 / kSamples);
  }
}

TEST_F(TriangleTest, ClosestPointOfADegenerateTriangleIsThatOfItsSegment) {
  Eigen::Matrix3d corners;
  corners.col(0) = Eigen::Vector3d(0, 0, 0);
  corners.col(1) = Eigen::Vector3d(1, 0, 0);
  corners.col(2) = Eigen::Vector3d(2, 0, 0);
  EXPECT_NEAR(closestPointOnTriangle({1.5, 3, 4}, corners).squared_distance, 25, 1e-12);
  corners.col(1) = corners.col(2) = corners.col(0);
  EXPECT_NEAR(closestPointOnTriangle({0, 3, 4}, corners).squared_distance, 25, 1e-12);
}

TEST_F(TriangleTest, ClosestPointsOfSegmentsAreNoFartherThanAnySample) {
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector3d a_0 = randomPoint(), a_1 = randomPoint(), b_0 = randomPoint();
    // Every third pair is parallel, every tenth a segment and a point.
    Eigen::Vector3d b_1 = trial % 3 == 0 ? Eigen::Vector3d(b_0 + 0.7 * (a_1 - a_0)) : randomPoint();
    if (trial % 10 == 0) b_1 = b_0;
    const ClosestPoints closest = closestPointsOfSegments(a_0, a_1, b_0, b_1);
    EXPECT_NEAR((closest.first - closest.second).squaredNorm(), closest.squared_distance, 1e-14);
    double sampled = 1e9;
    for (int i = 0; i <= kSamples; ++i) {
      const Eigen::Vector3d p = a_0 + i * (a_1 - a_0) / kSamples;
      for (int j = 0; j <= kSamples; ++j) {
        sampled = std::min(sampled, (b_0 + j * (b_1 - b_0) / kSamples - p).norm());
      }
    }
    EXPECT_LE(std::sqrt(closest.squared_distance), sampled + 1e-12);
    EXPECT_GE(std::sqrt(closest.squared_distance), sampled - 4.0 / kSamples);
  }
}

TEST_F(TriangleTest, ClosestPointsOfSegmentAndTriangleAreNoFartherThanAnySample) {
  int crossings = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Matrix3d corners = randomCorners();
    const Eigen::Vector3d a = randomPoint(), b = randomPoint();
    const ClosestPoints closest = closestPointsOfSegmentAndTriangle(a, b, corners);
    if (closest.squared_distance == 0) ++crossings;
    double sampled = 1e9;
    for (int i = 0; i <= 500; ++i) {
      sampled = std::min(sampled, closestPointOnTriangle(a + i * (b - a) / 500, corners).squared_distance);
    }
    EXPECT_LE(closest.squared_distance, sampled + 1e-12);
    EXPECT_GE(std::sqrt(closest.squared_distance), std::sqrt(sampled) - 4.0 / 500);
  }
  EXPECT_GT(crossings, 10);
}

TEST_F(TriangleTest, BarycentricCoordinatesReproduceThePoint) {
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Matrix3d corners = randomCorners();
    const Eigen::Vector3d weights = randomPoint();
    const Eigen::Vector3d barycentric = weights / weights.sum();
    EXPECT_LT((barycentricCoordinates(corners * barycentric, corners) - barycentric).norm(),
              1e-9 * barycentric.norm() / triangleAreaVector(corners).norm());
  }
}

}  // namespace
}  // namespace polyscalpel
