// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/mean_value_coordinates.hpp"

#include <limits>
#include <memory>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "support/element_cells.hpp"

namespace polyscalpel {
namespace {

using Vector3l = Eigen::Matrix<long double, 3, 1>;
using Matrix3Xl = Eigen::Matrix<long double, 3, Eigen::Dynamic>;
using VectorXl = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// The formula is a sum over the triangles of terms that carry a handful of roundings each: the multiple of
/// the unit roundoff that a well-conditioned result may be off by.
double roundings(const CellSurface& surface) {
  return 8.0 * static_cast<double>(surface.triangles.size());
}

struct Site {
  Eigen::Vector3d point;  // relative to the vertex mean
  double distance;        // to the nearest plane of a surface triangle [m]
};

double distanceToPlanes(const CellSurface& surface, const Eigen::Vector3d& origin,
                        const Eigen::Vector3d& point) {
  double smallest = kInfinity;
  for (const auto& [a, b, c] : surface.triangles) {
    const Eigen::Vector3d p = surface.points.col(a);
    const Eigen::Vector3d normal = (surface.points.col(b) - p).cross(surface.points.col(c) - p).normalized();
    smallest = std::min(smallest, std::abs(normal.dot(p - origin - point)));
  }
  return smallest;
}

/// Points at relative distances 1e-1 ... 1e-8 from the middle, the edges and the vertices of a dozen
/// triangles (all of them in small cells).
std::vector<Site> makeSites(const CellSurface& surface) {
  const Eigen::Vector3d origin = starCentre(surface);
  std::vector<Site> sites;
  for (double relative = 1e-1; relative > 0.5e-8; relative *= 0.1) {
    const std::size_t stride = (surface.triangles.size() + 11) / 12;
    for (std::size_t i = 0; i < surface.triangles.size(); i += stride) {
      const std::array<int, 3>& triangle = surface.triangles[i];
      for (int turn = 0; turn < 3; ++turn) {
        const Eigen::Vector3d a = surface.points.col(triangle[turn]) - origin;
        const Eigen::Vector3d b = surface.points.col(triangle[(turn + 1) % 3]) - origin;
        const Eigen::Vector3d c = surface.points.col(triangle[(turn + 2) % 3]) - origin;
        for (const Eigen::Vector3d& on_surface :
             {Eigen::Vector3d(0.5 * a + 0.3 * b + 0.2 * c), Eigen::Vector3d(0.6 * a + 0.4 * b), a}) {
          const Eigen::Vector3d point = (1 - relative) * on_surface;
          sites.push_back({point, distanceToPlanes(surface, origin, point)});
        }
      }
    }
  }
  return sites;
}

class MeanValueCoordinatesTest : public testing::TestWithParam<int> {
 protected:
  const NamedCell cell_ = makeCells()[GetParam()];
  const CellSurface& surface_ = cell_.surface;
  const int n_ = surface_.num_vertices;
  const std::vector<Site> sites_ = makeSites(surface_);
  const double roundings_ = roundings(surface_);
};

TEST_P(MeanValueCoordinatesTest, SumToOneReproduceLinearFieldsAndArePositive) {
  SCOPED_TRACE(cell_.name);
  MeanValueCoordinates<double> coordinates;
  coordinates.setSurface(surface_);
  const Eigen::Matrix3Xd vertices = surface_.points.leftCols(n_).colwise() - coordinates.origin();
  for (const Site& site : sites_) {
    coordinates.evaluate(site.point);
    const Eigen::VectorXd values = coordinates.values().col(0);
    const Eigen::Matrix3Xd gradients = coordinates.gradients().col(0).reshaped(3, n_);
    ASSERT_NEAR(values.sum(), 1, roundings_ * kEpsilon);
    ASSERT_LE((vertices * values - site.point).norm(), roundings_ * kEpsilon);
    // Gradients are uncertain by eps slope / distance (see the header).
    const double slope = std::max(1.0, gradients.cwiseAbs().maxCoeff());
    const double uncertainty = roundings_ * kEpsilon * slope / site.distance;
    ASSERT_LE(gradients.rowwise().sum().norm(), uncertainty);
    ASSERT_LE((gradients * vertices.transpose() - Eigen::Matrix3d::Identity()).norm(), uncertainty);
    if (cell_.is_convex) {
      ASSERT_GT(values.minCoeff(), -roundings_ * kEpsilon);
    }
  }
}

TEST_P(MeanValueCoordinatesTest, ArePositiveWellInsideConvexCells) {
  if (!cell_.is_convex) GTEST_SKIP() << cell_.name << " is not convex";
  MeanValueCoordinates<double> coordinates;
  coordinates.setSurface(surface_);
  for (const Site& site : sites_) {
    // Every coordinate of a hat function is at least of the order of the distance.
    if (site.distance < 1e-6) continue;
    coordinates.evaluate(site.point);
    ASSERT_GT(coordinates.values().minCoeff(), 0) << cell_.name;
  }
}

TEST_P(MeanValueCoordinatesTest, AgreeWithLongDouble) {
  SCOPED_TRACE(cell_.name);
  MeanValueCoordinates<double> coordinates;
  MeanValueCoordinates<long double> reference;
  coordinates.setSurface(surface_);
  reference.setSurface(surface_);
  for (const Site& site : sites_) {
    coordinates.evaluate(site.point);
    reference.evaluate(site.point.cast<long double>());
    const VectorXl value_errors = coordinates.values().col(0).cast<long double>() - reference.values().col(0);
    const VectorXl gradient_errors =
        coordinates.gradients().col(0).cast<long double>() - reference.gradients().col(0);
    // Rounding moves the point by eps, and so the values by eps times their slope.
    const double slope = std::max(1.0, static_cast<double>(reference.gradients().cwiseAbs().maxCoeff()));
    ASSERT_LE(value_errors.cwiseAbs().maxCoeff(), roundings_ * kEpsilon * slope);
    ASSERT_LE(gradient_errors.cwiseAbs().maxCoeff(), roundings_ * kEpsilon * slope / site.distance);
  }
}

TEST_P(MeanValueCoordinatesTest, GradientsAreTheDerivatives) {
  if (!cell_.is_convex)
    GTEST_SKIP() << cell_.name << " has planes of triangles inside, next to which steps must be tiny";
  SCOPED_TRACE(cell_.name);
  // Central differences of sixth order in long double. With the step a thirtieth of the distance to the
  // nearest singularity the remainder is (1 / 30)^6 of the slope; rounding adds eps / step.
  constexpr int kStencil = 6;
  constexpr long double kOffsets[kStencil] = {-3, -2, -1, 1, 2, 3};
  constexpr long double kWeights[kStencil] = {-1 / 60.0L, 9 / 60.0L,  -45 / 60.0L,
                                              45 / 60.0L, -9 / 60.0L, 1 / 60.0L};
  constexpr long double kParts = 30;
  MeanValueCoordinates<long double> coordinates;
  coordinates.setSurface(surface_);
  Matrix3Xl stencil(3, 3 * kStencil);
  for (const Site& site : sites_) {
    coordinates.evaluate(site.point.cast<long double>());
    const Matrix3Xl gradients = coordinates.gradients().col(0).reshaped(3, n_);
    const long double step = site.distance / kParts;
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < kStencil; ++i) {
        stencil.col(axis * kStencil + i) =
            site.point.cast<long double>() + kOffsets[i] * step * Vector3l::Unit(axis);
      }
    }
    coordinates.evaluate(stencil);
    const long double slope = std::max(1.0L, gradients.cwiseAbs().maxCoeff());
    const long double tolerance =
        roundings_ * slope * (std::pow(kParts, -6.0L) + std::numeric_limits<long double>::epsilon() / step);
    for (int axis = 0; axis < 3; ++axis) {
      VectorXl difference = VectorXl::Zero(n_);
      for (int i = 0; i < kStencil; ++i)
        difference += kWeights[i] / step * coordinates.values().col(axis * kStencil + i);
      ASSERT_LE((difference - gradients.row(axis).transpose()).cwiseAbs().maxCoeff(), tolerance)
          << "distance " << site.distance;
    }
  }
}

TEST_P(MeanValueCoordinatesTest, APointDoesNotDependOnTheOthers) {
  MeanValueCoordinates<double> together, alone;
  together.setSurface(surface_);
  alone.setSurface(surface_);
  Eigen::Matrix3Xd points(3, 7);
  for (int i = 0; i < 7; ++i) points.col(i) = sites_[i].point;
  together.evaluate(points);
  for (int i = 0; i < 7; ++i) {
    alone.evaluate(points.col(i));
    EXPECT_EQ(alone.values().col(0), together.values().col(i));
    EXPECT_EQ(alone.gradients().col(0), together.gradients().col(i));
  }
}

/// Where the machine has wider registers than every machine has; else the same twice.
TEST_P(MeanValueCoordinatesTest, DoNotDependOnTheWidthOfTheMachine) {
  MeanValueCoordinates<double> widest, portable(true);
  widest.setSurface(surface_);
  portable.setSurface(surface_);
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(sites_.size()));
  for (std::size_t i = 0; i < sites_.size(); ++i) points.col(static_cast<Eigen::Index>(i)) = sites_[i].point;
  widest.evaluate(points);
  portable.evaluate(points);
  EXPECT_EQ(widest.values(), portable.values());
  EXPECT_EQ(widest.gradients(), portable.gradients());
}

TEST_P(MeanValueCoordinatesTest, AreInvariantUnderScalingAndRotation) {
  SCOPED_TRACE(cell_.name);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  MeanValueCoordinates<double> coordinates, moved;
  coordinates.setSurface(surface_);
  for (const double scale : {1e-6, 1e3}) {
    moved.setSurface(transformed(surface_, scale * R, Eigen::Vector3d::Zero()));
    for (const Site& site : sites_) {
      if (site.distance < 1e-4) continue;
      coordinates.evaluate(site.point);
      moved.evaluate(scale * R * site.point);
      // The points of the second cell are rounded once more, relative to its size.
      const double uncertainty = roundings_ * kEpsilon / site.distance;
      ASSERT_LE((coordinates.values() - moved.values()).cwiseAbs().maxCoeff(), uncertainty);
      const Eigen::Matrix3Xd expected = R * coordinates.gradients().col(0).reshaped(3, n_);
      const Eigen::Matrix3Xd actual = scale * moved.gradients().col(0).reshaped(3, n_);
      ASSERT_LE((expected - actual).cwiseAbs().maxCoeff(), uncertainty / site.distance);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cells, MeanValueCoordinatesTest,
                         testing::Range(0, static_cast<int>(makeCells().size())));

TEST(MeanValueCoordinates, AreBarycentricOnATetrahedron) {
  const CellSurface surface = makeSurface(makeTetrahedronSketch());
  MeanValueCoordinates<double> coordinates;
  coordinates.setSurface(surface);
  const Eigen::Matrix3Xd vertices = surface.points.colwise() - coordinates.origin();
  Eigen::Matrix4d system;
  system << vertices, Eigen::RowVector4d::Ones();
  const Eigen::Matrix4d inverse = system.inverse();
  for (const Site& site : makeSites(surface)) {
    coordinates.evaluate(site.point);
    const Eigen::Vector4d expected = inverse * site.point.homogeneous();
    ASSERT_LE((coordinates.values().col(0) - expected).norm(), roundings(surface) * kEpsilon);
    const Eigen::Matrix<double, 3, 4> expected_gradients = inverse.leftCols<3>().transpose();
    ASSERT_LE((coordinates.gradients().col(0).reshaped(3, 4) - expected_gradients).norm(),
              roundings(surface) * kEpsilon / site.distance);
  }
}

TEST(MeanValueCoordinates, VertexHangingInAnEdgeIsLinearAlongIt) {
  // On the surface the coordinates are those of the triangles, and close to it close to them.
  const CellSurface surface = makeSurface(withHangingVertices(makeTetrahedronSketch()));
  MeanValueCoordinates<double> coordinates;
  coordinates.setSurface(surface);
  for (const std::array<int, 3>& triangle : surface.triangles) {
    const Eigen::Vector3d a = surface.points.col(triangle[1]) - coordinates.origin();
    const Eigen::Vector3d b = surface.points.col(triangle[2]) - coordinates.origin();
    coordinates.evaluate((1 - 1e-8) * (0.25 * a + 0.75 * b));
    EXPECT_NEAR(coordinates.values()(triangle[1], 0), 0.25, 1e-6);
    EXPECT_NEAR(coordinates.values()(triangle[2], 0), 0.75, 1e-6);
  }
}

TEST(MeanValueCoordinates, AreFiniteInThePlaneOfATriangleBesideIt) {
  // A cube with a bay in its top: from inside, points lie exactly in the planes of the bay's triangles.
  PolyhedronSketch sketch = makeCubeSketch();
  sketch.points.conservativeResize(3, 9);
  sketch.points.col(8) = Eigen::Vector3d(0.5, 0.5, 0.75);
  sketch.loops[1] = {4, 5, 8};
  sketch.loops.insert(sketch.loops.end(), {{5, 6, 8}, {6, 7, 8}, {7, 4, 8}});
  const CellSurface surface = makeSurface(sketch);
  MeanValueCoordinates<double> coordinates;
  coordinates.setSurface(surface);
  const Eigen::Vector3d bay = sketch.points.col(8);
  for (const Eigen::Vector3d& edge : {Eigen::Vector3d(0.5, 0, 0.25), Eigen::Vector3d(0, 0.5, 0.25)}) {
    for (const double t : {0.25, 0.5, -0.25, -0.5}) {
      // From the bay's lowest point on, beyond the triangle between two neighbouring top corners.
      const Eigen::Vector3d direction = t > 0 ? edge : Eigen::Vector3d(-edge.x(), -edge.y(), edge.z());
      const Eigen::Vector3d point = bay - std::abs(t) * direction - coordinates.origin();
      coordinates.evaluate(point);
      ASSERT_TRUE(coordinates.values().allFinite());
      ASSERT_TRUE(coordinates.gradients().allFinite());
      const Eigen::VectorXd values = coordinates.values().col(0);
      EXPECT_NEAR(values.sum(), 1, roundings(surface) * kEpsilon);
      const Eigen::Matrix3Xd vertices = surface.points.leftCols<9>().colwise() - coordinates.origin();
      // Half of the digits are what the quotient of the vanishing numbers has (kEdgeOnAngle).
      EXPECT_LE((vertices * values - point).norm(), 1e-7);
      // The extension of an edge of the bay into the cell: sin and angle of that edge vanish together.
      const Eigen::Vector3d corner = surface.points.col(4);
      const Eigen::Vector3d beyond = bay + std::abs(t) * (bay - corner) - coordinates.origin();
      coordinates.evaluate(beyond);
      ASSERT_TRUE(coordinates.values().allFinite());
      ASSERT_TRUE(coordinates.gradients().allFinite());
    }
  }
}

}  // namespace
}  // namespace polyscalpel
