// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/quadrature.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "support/element_cells.hpp"

namespace polyscalpel {
namespace {

double factorial(int k) {
  return std::tgamma(k + 1.0);
}

TEST(TetrahedronRule, IntegratesEveryMonomialOfItsDegree) {
  for (const int points : {1, 4, 11}) {
    const TetrahedronRule& rule = tetrahedronRule(points);
    ASSERT_EQ(rule.weights.size(), points);
    for (int a = 0; a <= rule.degree; ++a) {
      for (int b = 0; a + b <= rule.degree; ++b) {
        for (int c = 0; a + b + c <= rule.degree; ++c) {
          for (int d = 0; a + b + c + d <= rule.degree; ++d) {
            double sum = 0;
            for (int q = 0; q < points; ++q) {
              sum += rule.weights(q) * std::pow(rule.barycentric(0, q), a) *
                     std::pow(rule.barycentric(1, q), b) * std::pow(rule.barycentric(2, q), c) *
                     std::pow(rule.barycentric(3, q), d);
            }
            // Mean over a tetrahedron of a monomial in its barycentric coordinates.
            const double exact =
                6 * factorial(a) * factorial(b) * factorial(c) * factorial(d) / factorial(a + b + c + d + 3);
            EXPECT_NEAR(sum, exact, 2e-16 + 4e-16 * exact) << points << ": " << a << b << c << d;
          }
        }
      }
    }
  }
}

TEST(TetrahedronRule, DegreesAreThoseSaid) {
  EXPECT_EQ(tetrahedronRule(1).degree, 1);
  EXPECT_EQ(tetrahedronRule(4).degree, 2);
  EXPECT_EQ(tetrahedronRule(11).degree, 4);
}

TEST(TetrahedronRule, WeightsArePositiveAndPointsInside) {
  for (const int points : {1, 4, 11}) {
    const TetrahedronRule& rule = tetrahedronRule(points);
    EXPECT_GT(rule.weights.minCoeff(), 0);
    EXPECT_GT(rule.barycentric.minCoeff(), 0);
    EXPECT_NEAR(rule.weights.sum(), 1, 4e-16);
    EXPECT_LE((rule.barycentric.colwise().sum().array() - 1).abs().maxCoeff(), 4e-16);
  }
}

TEST(TetrahedronRule, IsInvariantUnderPermutationsOfTheTriangle) {
  for (const int points : {1, 4, 11}) {
    const TetrahedronRule& rule = tetrahedronRule(points);
    for (const auto& order : {std::array<int, 4>{0, 2, 3, 1}, std::array<int, 4>{0, 2, 1, 3}}) {
      for (int q = 0; q < points; ++q) {
        double found = kInfinity;
        for (int p = 0; p < points; ++p) {
          double distance = std::abs(rule.weights(p) - rule.weights(q));
          for (int k = 0; k < 4; ++k)
            distance = std::max(distance, std::abs(rule.barycentric(k, p) - rule.barycentric(order[k], q)));
          found = std::min(found, distance);
        }
        EXPECT_LE(found, 1e-15);
      }
    }
  }
}

TEST(TetrahedronRule, OtherNumbersAreRefused) {
  for (const int points : {-1, 0, 2, 3, 5, 10, 12})
    EXPECT_THROW(tetrahedronRule(points), std::invalid_argument);
}

TEST(CellQuadrature, KeepsVolumeAndFirstMoment) {
  for (const NamedCell& cell : makeCells()) {
    SCOPED_TRACE(cell.name);
    const double expected_volume = volume(cell.surface);
    const CellQuadrature fine = makeCellQuadrature(cell.surface, tetrahedronRule(11));
    for (const int points : {1, 4, 11}) {
      const CellQuadrature quadrature = makeCellQuadrature(cell.surface, tetrahedronRule(points));
      EXPECT_GT(quadrature.weights.minCoeff(), 0);
      EXPECT_NEAR(quadrature.weights.sum(), expected_volume, 1e-14 * expected_volume);
      EXPECT_LE((quadrature.points * quadrature.weights - fine.points * fine.weights).norm(),
                1e-14 * expected_volume);
    }
  }
}

TEST(CellQuadrature, IntegratesQuarticsOverACube) {
  const CellSurface cube = makeSurface(makeCubeSketch());
  const CellQuadrature quadrature = makeCellQuadrature(cube, tetrahedronRule(11));
  const Eigen::Array3Xd x = quadrature.points.array() + 0.5;
  const double integral = (x.row(0).square() * x.row(1) * x.row(2)).matrix() * quadrature.weights;
  EXPECT_NEAR(integral, 1.0 / 12, 1e-15);
}

TEST(CellQuadrature, CellThatIsNotStarShapedIsRefused) {
  PolyhedronSketch sketch = makeCubeSketch();
  sketch.points.col(6) = Eigen::Vector3d(-0.5, -0.5, -0.5);
  EXPECT_THROW(makeCellQuadrature(makeSurface(sketch), tetrahedronRule(4)), std::invalid_argument);
}

}  // namespace
}  // namespace polyscalpel
