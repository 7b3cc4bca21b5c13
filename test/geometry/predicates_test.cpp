// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/geometry/predicates.hpp"

#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace polyscalpel {
namespace {

using Eigen::Vector3d;

TEST(Predicates, ASegmentThroughTheSeamOfTwoTrianglesCrossesExactlyOne) {
  // All points on a small integer grid, so that ties abound; every segment whose ends lie off the square's
  // plane on different sides and whose crossing lies inside the square counts once.
  std::mt19937 random(3);
  std::uniform_int_distribution<int> grid(0, 8);
  const Vector3d a(0, 0, 0), b(8, 0, 0), c(8, 8, 0), d(0, 8, 0);
  for (int i = 0; i < 20000; ++i) {
    const int x = 1 + grid(random) % 7, y = 1 + grid(random) % 7, dx = grid(random) % 3 - 1,
              dy = grid(random) % 3 - 1;
    const Vector3d p(x - dx, y - dy, -1), q(x + dx, y + dy, 1);
    for (const MeshPart part : {MeshPart::kSegment, MeshPart::kTriangle}) {
      const int through_ac =
          crossTriangle(p, q, a, b, c, part).sign + crossTriangle(p, q, a, c, d, part).sign;
      const int through_bd =
          crossTriangle(p, q, a, b, d, part).sign + crossTriangle(p, q, b, c, d, part).sign;
      EXPECT_EQ(through_ac, 1) << p.transpose() << " to " << q.transpose();
      EXPECT_EQ(through_bd, 1) << p.transpose() << " to " << q.transpose();
      EXPECT_EQ(crossTriangle(q, p, a, b, c, part).sign, -crossTriangle(p, q, a, b, c, part).sign);
    }
  }
}

TEST(Predicates, AChainOfSegmentsThroughAPointInThePlaneCrossesOnce) {
  // p - m - q with m in the triangle's plane: the shift puts m on one side, so exactly one of both segments
  // crosses.
  const Vector3d a(0, 0, 0), b(8, 0, 0), c(0, 8, 0), m(2, 2, 0);
  for (const Vector3d& p : {Vector3d(1, 3, -2), Vector3d(2, 2, -1), Vector3d(2, 1, -5)}) {
    for (const Vector3d& q : {Vector3d(1, 3, 2), Vector3d(2, 2, 1), Vector3d(3, 2, 4)}) {
      const int sum = crossTriangle(p, m, a, b, c, MeshPart::kSegment).sign +
                      crossTriangle(m, q, a, b, c, MeshPart::kSegment).sign;
      EXPECT_EQ(sum, 1);
    }
    // ... and a chain that turns back at m crosses nothing in sum.
    EXPECT_EQ(crossTriangle(p, m, a, b, c, MeshPart::kSegment).sign +
                  crossTriangle(m, Vector3d(3, 3, -1), a, b, c, MeshPart::kSegment).sign,
              0);
  }
}

TEST(Predicates, NearTiesAreDecidedExactly) {
  // 2^-52 above the plane z = 1 at large x, y: products of rounded coordinates lose it, exact arithmetic does
  // not.
  const Vector3d a(1e8, 0, 1), b(1e8 + 1, 0, 1), c(1e8, 1, 1);
  const Vector3d low(1e8 + 0.25, 0.25, std::nextafter(1.0, 0.0)),
      high(1e8 + 0.25, 0.25, std::nextafter(1.0, 2.0));
  EXPECT_EQ(crossTriangle(low, high, a, b, c, MeshPart::kSegment).sign, 1);
  EXPECT_EQ(crossTriangle(high, low, a, b, c, MeshPart::kSegment).sign, -1);
  EXPECT_EQ(sideOfPlane(low, a, Vector3d::UnitZ()), -1);
  EXPECT_EQ(sideOfPlane(high, a, Vector3d::UnitZ()), 1);
}

TEST(Predicates, PointsInAPlaneFollowTheShiftOfTheMesh) {
  EXPECT_EQ(sideOfPlane(Vector3d(1, 5, 7), Vector3d(1, 0, 0), Vector3d::UnitX()), 1);
  EXPECT_EQ(sideOfPlane(Vector3d(1, 5, 7), Vector3d(1, 0, 0), -Vector3d::UnitX()), -1);
  EXPECT_EQ(sideOfPlane(Vector3d(5, 1, 7), Vector3d(0, 1, 0), Vector3d(0, -2, 1e-300)), 1)
      << "7e-300 above the plane";
  EXPECT_EQ(sideOfPlane(Vector3d(5, 1, 0), Vector3d(0, 1, 0), Vector3d(0, -2, 1)), -1);
}

TEST(Predicates, WeightsPlaceTheCrossing) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  int crossings = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d p = point(), q = point(), a = point(), b = point(), c = point();
    const TriangleCrossing crossing = crossTriangle(p, q, a, b, c, MeshPart::kSegment);
    if (crossing.sign == 0) continue;
    ++crossings;
    const Vector3d on_segment = p + crossing.segment_parameter * (q - p);
    const Vector3d on_triangle =
        crossing.barycentric[0] * a + crossing.barycentric[1] * b + crossing.barycentric[2] * c;
    // Both are quotients by |det|, the area vector times the way: rounding is amplified by their inverse.
    const double det = std::abs((b - a).cross(c - a).dot(q - p));
    EXPECT_LT((on_segment - on_triangle).norm(), 1e-14 / det);
    EXPECT_GE(crossing.barycentric.minCoeff(), 0);
  }
  EXPECT_GT(crossings, 500);
}

TEST(Predicates, ATriangleWithoutAreaIsNeverCrossed) {
  const Vector3d p(0, 0, -1), q(0, 0, 1), a(-1, 0, 0), b(1, 0, 0);
  for (const MeshPart part : {MeshPart::kSegment, MeshPart::kTriangle}) {
    EXPECT_EQ(crossTriangle(p, q, a, b, Vector3d(0, 0, 0), part).sign, 0);
    EXPECT_EQ(crossTriangle(p, q, a, a, b, part).sign, 0);
  }
}

}  // namespace
}  // namespace polyscalpel
