// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/collision/triangle_contact.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "polyscalpel/core/types.hpp"
#include "polyscalpel/geometry/triangle.hpp"

namespace polyscalpel {
namespace {

ShapeConfig makeShape(ShapeKind kind) {
  ShapeConfig config;
  config.kind = kind;
  config.radius_m = 0.4;
  config.length_m = 1.4;
  config.size_m = {1.4, 0.8, 0.3};
  return config;
}

class TriangleContactTest : public ::testing::TestWithParam<ShapeKind> {
 protected:
  Eigen::Vector3d randomPoint(double scale) {
    return scale * Eigen::Vector3d(coordinate_(generator_), coordinate_(generator_), coordinate_(generator_));
  }
  Eigen::Matrix3d randomTriangle(double offset, double size) {
    const Eigen::Vector3d centre = randomPoint(offset);
    Eigen::Matrix3d corners;
    for (int i = 0; i < 3; ++i) corners.col(i) = centre + randomPoint(size);
    return corners;
  }

  std::mt19937 generator_{7};
  std::uniform_real_distribution<double> coordinate_{-1, 1};
  const ConvexShape shape_{makeShape(GetParam())};
};

/// Distance by definition: the nearest of many points of the shape, found by walking from the point to its
/// support points (Frank and Wolfe's algorithm, independent of the closed forms but for the support points).
double distanceByWalking(const ConvexShape& shape, const Eigen::Vector3d& point) {
  Eigen::Vector3d nearest = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d gradient = nearest - point;
    if (gradient.norm() < 1e-9) return 0;
    const Eigen::Vector3d step = shape.support(-gradient) - nearest;
    if (-gradient.dot(step) < 1e-9 || step.squaredNorm() == 0) break;
    nearest += std::min(1.0, -gradient.dot(step) / step.squaredNorm()) * step;
  }
  return (nearest - point).norm();
}

TEST_P(TriangleContactTest, SignedDistanceOutsideIsTheDistanceToTheConvexBody) {
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d point = randomPoint(1.5);
    const double distance = shape_.signedDistance(point);
    if (distance < 0.05) continue;
    EXPECT_NEAR(distanceByWalking(shape_, point), distance, 2e-3);
  }
}

TEST_P(TriangleContactTest, SignedDistanceGrowsAlongItsGradientAndReachesTheSurfaceAgainstIt) {
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector3d point = randomPoint(1.2);
    Eigen::Vector3d gradient;
    const double distance = shape_.signedDistance(point, &gradient);
    EXPECT_NEAR(gradient.norm(), 1, 1e-14);
    EXPECT_NEAR(shape_.signedDistance(point + 0.1 * gradient), distance + 0.1, 1e-12);
    EXPECT_NEAR(shape_.signedDistance(point - distance * gradient), 0, 1e-12);
  }
}

TEST_P(TriangleContactTest, SupportPointsLieOnTheSurfaceAndBoundTheShape) {
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d direction = randomPoint(1).normalized();
    const Eigen::Vector3d farthest = shape_.support(direction);
    EXPECT_NEAR(shape_.signedDistance(farthest), 0, 1e-14);
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d point = randomPoint(1.2);
      if (shape_.signedDistance(point) > 0) continue;
      EXPECT_LE(direction.dot(point), direction.dot(farthest) + 1e-14);
    }
  }
}

TEST_P(TriangleContactTest, LinesLeaveTheShapeAtTheirExit) {
  int misses = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector3d point = randomPoint(1.2);
    const Eigen::Vector3d direction = randomPoint(1).normalized();
    const std::optional<double> exit = shape_.exitParameter(point, direction);
    double least = kInfinity;
    for (int i = -400; i <= 400; ++i) {
      const double t = 0.01 * i;
      const double distance = shape_.signedDistance(point + t * direction);
      least = std::min(least, distance);
      if (!exit || t > *exit) {
        EXPECT_GT(distance, -1e-12);
      }
    }
    if (exit) {
      EXPECT_NEAR(shape_.signedDistance(point + *exit * direction), 0, 1e-7);
    } else {
      ++misses;
    }
    EXPECT_TRUE(exit.has_value() || least > 0);
  }
  EXPECT_GT(misses, 10);
}

TEST_P(TriangleContactTest, GapApartIsTheSmallestSampledDistance) {
  constexpr int kSteps = 60;
  int apart = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const double size = trial % 2 == 0 ? 0.3 : 2;
    const Eigen::Matrix3d corners = randomTriangle(1.2, size);
    double sampled = kInfinity;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const Eigen::Vector3d weights = Eigen::Vector3d(i, j, kSteps - i - j) / kSteps;
        sampled = std::min(sampled, shape_.signedDistance(corners * weights));
      }
    }
    const std::optional<TriangleGap> gap = triangleGap(shape_, corners, kInfinity);
    ASSERT_TRUE(gap.has_value());
    EXPECT_NEAR(gap->normal.norm(), 1, 1e-12);
    EXPECT_LE(gap->gap, sampled + 1e-12);
    if (gap->gap > 0) {
      ++apart;
      EXPECT_GE(gap->gap, sampled - 4 * size / kSteps);
      // The slab of that width between the two supporting planes holds neither: normal and gap belong
      // together.
      EXPECT_NEAR(
          (gap->normal.transpose() * corners).minCoeff() - gap->normal.dot(shape_.support(gap->normal)),
          gap->gap, 1e-9);
    } else {
      EXPECT_LE(sampled, 4 * size / kSteps);
    }
  }
  EXPECT_GT(apart, 300);
  EXPECT_LT(apart, 1900);
}

TEST_P(TriangleContactTest, GapInOverlapIsAWayOutAndNoSampledDirectionIsMuchShorter) {
  int overlaps = 0;
  double worst = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const Eigen::Matrix3d corners = randomTriangle(0.6, trial % 2 == 0 ? 0.3 : 1.5);
    const std::optional<TriangleGap> gap = triangleGap(shape_, corners, kInfinity);
    ASSERT_TRUE(gap.has_value());
    if (gap->gap > 0) continue;
    ++overlaps;
    const Eigen::Matrix3d freed = corners.colwise() - (gap->gap - 1e-9) * gap->normal;
    EXPECT_GT(triangleGap(shape_, freed, kInfinity)->gap, 0);
    double shortest = kInfinity;
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3d direction = randomPoint(1).normalized();
      shortest = std::min(
          shortest, direction.dot(shape_.support(direction)) - (direction.transpose() * corners).minCoeff());
    }
    worst = std::max(worst, -gap->gap / shortest - 1);
  }
  EXPECT_GT(overlaps, 100);
  // Exact but for the cylinder, whose rim is searched.
  EXPECT_LT(worst, GetParam() == ShapeKind::kCylinder ? 0.05 : 1e-9);
}

TEST_P(TriangleContactTest, ContactsAreFiniteUnitInwardAndWithinTheTriangle) {
  std::vector<TriangleContact> contacts;
  int found = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Eigen::Matrix3d corners = randomTriangle(0.8, trial % 3 == 0 ? 0.05 : trial % 3 == 1 ? 0.5 : 3);
    const Eigen::Vector3d area = triangleAreaVector(corners);
    contacts.clear();
    appendContacts(shape_, corners, 0.1, contacts);
    double sum = 0;
    for (const TriangleContact& contact : contacts) {
      ++found;
      EXPECT_NEAR(contact.normal.norm(), 1, 1e-12);
      EXPECT_LT(contact.normal.dot(area), 0);
      EXPECT_GE(contact.barycentric.minCoeff(), 0);
      EXPECT_NEAR(contact.barycentric.sum(), 1, 1e-12);
      EXPECT_LT(contact.gap, 0.1);
      EXPECT_GT(contact.area, 0);
      sum += contact.area;
    }
    EXPECT_LE(sum, area.norm() * (1 + 1e-9));
    EXPECT_LE(contacts.size(), 3u);
    // No more than the largest cross-section of any of the shapes.
    EXPECT_LE(sum, 1.05 * (1.4 * 0.8 + M_PI * 0.16));
  }
  EXPECT_GT(found, 300);
}

TEST_P(TriangleContactTest, DegenerateInputGivesNoNaN) {
  std::vector<TriangleContact> contacts;
  Eigen::Matrix3d corners = Eigen::Matrix3d::Zero();
  appendContacts(shape_, corners, 0.1, contacts);
  corners.col(1) = Eigen::Vector3d(1, 0, 0);
  corners.col(2) = Eigen::Vector3d(2, 0, 0);
  appendContacts(shape_, corners, 0.1, contacts);
  EXPECT_TRUE(contacts.empty());
  // Through the centre of the shape, in each of the principal planes, both ways round.
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      corners.col(0) = sign * 5 * Eigen::Vector3d::Unit(axis);
      corners.col(1) = 4 * Eigen::Vector3d::Unit((axis + 1) % 3) - 0.5 * corners.col(0);
      corners.col(2) = -4 * Eigen::Vector3d::Unit((axis + 1) % 3) - 0.5 * corners.col(0);
      contacts.clear();
      appendContacts(shape_, corners, 0.1, contacts);
      EXPECT_FALSE(contacts.empty());
      for (const TriangleContact& contact : contacts) {
        EXPECT_TRUE(contact.normal.allFinite() && contact.barycentric.allFinite());
        EXPECT_TRUE(std::isfinite(contact.gap) && std::isfinite(contact.area));
        EXPECT_NEAR(contact.normal.norm(), 1, 1e-12);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, TriangleContactTest,
                         ::testing::Values(ShapeKind::kSphere, ShapeKind::kCapsule, ShapeKind::kBox,
                                           ShapeKind::kCylinder));

/// A large triangle in the plane z = height, outside up (the tissue below it) or down.
Eigen::Matrix3d largeTriangle(double height, bool is_outside_up) {
  Eigen::Matrix3d corners;
  corners.col(0) = Eigen::Vector3d(-10, -10, height);
  corners.col(1) = Eigen::Vector3d(10, -10, height);
  corners.col(2) = Eigen::Vector3d(0, 20, height);
  if (!is_outside_up) corners.col(1).swap(corners.col(2));
  return corners;
}

struct Total {
  Eigen::Vector3d overlap = Eigen::Vector3d::Zero();  // sum of area * depth * normal: a volume
  double area = 0;
};

Total totalOf(const ConvexShape& shape, const Eigen::Matrix3d& corners) {
  std::vector<TriangleContact> contacts;
  appendContacts(shape, corners, 1e-3, contacts);
  Total total;
  for (const TriangleContact& contact : contacts) {
    total.overlap -= contact.area * contact.gap * contact.normal;
    total.area += contact.area;
  }
  return total;
}

ConvexShape sphere() {
  return ConvexShape(makeShape(ShapeKind::kSphere));
}  // radius 0.4

ConvexShape blade() {
  ShapeConfig config;
  config.kind = ShapeKind::kBox;
  config.size_m = {0.02, 0.5, 1};  // thin in x, deep in z
  return ConvexShape(config);
}

TEST(PushRuleTest, SphereOnALargeTriangleDisplacesTheVolumeOfItsCap) {
  for (const double depth : {0.01, 0.05, 0.1, 0.4, 0.6}) {
    const Total total = totalOf(sphere(), largeTriangle(-0.4 + depth, true));
    const double cap = M_PI * depth * depth * (3 * 0.4 - depth) / 3;
    // Past the middle the section shrinks while what is above it is still pushed.
    if (depth <= 0.4) {
      EXPECT_NEAR(-total.overlap.z(), cap, (depth <= 0.1 ? 0.02 : 0.1) * cap);
      EXPECT_NEAR(total.area, M_PI * (0.16 - std::pow(0.4 - depth, 2)), 0.02 * total.area);
    }
    EXPECT_LT(total.overlap.z(), 0);
    EXPECT_LT(total.overlap.head<2>().norm(), 1e-9);
    EXPECT_LE(total.area, M_PI * 0.16 * 1.001);
  }
}

TEST(PushRuleTest, SphereBeneathTheSurfaceOrBehindTheBodyDoesNotPull) {
  EXPECT_EQ(totalOf(sphere(), largeTriangle(0.4005, true)).area, 0);    // apart, within the margin, beneath
  EXPECT_EQ(totalOf(sphere(), largeTriangle(0.395, true)).area, 0);     // pokes from within
  EXPECT_EQ(totalOf(sphere(), largeTriangle(-0.4005, false)).area, 0);  // the far side of the body
  EXPECT_EQ(totalOf(sphere(), largeTriangle(-0.39, false)).area, 0);
  EXPECT_GT(totalOf(sphere(), largeTriangle(-0.4005, true)).area,
            0);  // the same on the right side is a contact
}

TEST(PushRuleTest, BladeOnEdgePushesAheadOverItsOwnSection) {
  const Total total = totalOf(blade(), largeTriangle(-0.5 + 0.05, true));
  EXPECT_NEAR(total.area, 0.02 * 0.5, 1e-12);
  EXPECT_LT((total.overlap - Eigen::Vector3d(0, 0, -0.05 * 0.02 * 0.5)).norm(), 1e-12);
}

TEST(PushRuleTest, BladeInASlitPushesBothFlanksApart) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();  // z to x
  for (const double offset : {0.0, 0.003, -0.003}) {
    const Total left = totalOf(blade(), turn * largeTriangle(offset, true));    // tissue at x < offset
    const Total right = totalOf(blade(), turn * largeTriangle(offset, false));  // tissue at x > offset
    EXPECT_NEAR(left.area, 0.5, 1e-9);
    EXPECT_NEAR(right.area, 0.5, 1e-9);
    EXPECT_LT((left.overlap - Eigen::Vector3d(-0.5 * (0.01 + offset), 0, 0)).norm(), 1e-9);
    EXPECT_LT((right.overlap - Eigen::Vector3d(0.5 * (0.01 - offset), 0, 0)).norm(), 1e-9);
  }
}

TEST(PushRuleTest, SurfaceEdgeOnToASlitIsNotPressedDown) {
  // The upper surface beside a slit at x = 0 that the blade stands in: it overlaps by half the blade's
  // thickness.
  Eigen::Matrix3d corners;
  corners.col(0) = Eigen::Vector3d(0, -1, 0);
  corners.col(1) = Eigen::Vector3d(1, 0, 0);
  corners.col(2) = Eigen::Vector3d(0, 1, 0);
  EXPECT_EQ(totalOf(blade(), corners).area, 0);
}

}  // namespace
}  // namespace polyscalpel
