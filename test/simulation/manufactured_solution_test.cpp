// SPDX-License-Identifier: BSD-3-Clause
#include "support/manufactured_solution.hpp"

#include <string>
#include <tuple>

#include <gtest/gtest.h>

namespace polyscalpel {
namespace {

TEST(ManufacturedSolution, BodyForceIsTheDivergenceOfItsStress) {
  const ManufacturedSolution exact;
  const double lambda = lameLambda(exact.material), mu = shearModulus(exact.material);
  const auto stress = [&](const Eigen::Vector3d& x) {
    const Eigen::Matrix3d strain = 0.5 * (exact.gradient(x) + exact.gradient(x).transpose());
    return Eigen::Matrix3d(lambda * strain.trace() * Eigen::Matrix3d::Identity() + 2 * mu * strain);
  };
  constexpr double kStep = 1e-5;
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0.2, 0.7, 0.4), Eigen::Vector3d(0.9, 0.35, 0.55)}) {
    Eigen::Vector3d divergence = Eigen::Vector3d::Zero();
    Eigen::Matrix3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(axis);
      divergence += (stress(x + step) - stress(x - step)).col(axis) / (2 * kStep);
      gradient.col(axis) = (exact.displacement(x + step) - exact.displacement(x - step)) / (2 * kStep);
    }
    EXPECT_LT((exact.bodyForce(x) + divergence).norm(), 1e-8 * divergence.norm());
    EXPECT_LT((exact.gradient(x) - gradient).norm(), 1e-8 * gradient.norm());
  }
}

constexpr int kMeanValue4 = 0, kMeanValue1 = 1, kVirtual = 2;

struct NamedFormulation {
  std::string name;
  ElementConfig config;
};
NamedFormulation formulation(int which) {
  NamedFormulation result{"mean value, 4 points", {}};
  if (which == kMeanValue1) {
    result.name = "mean value, 1 point";
    result.config.quadrature_points = 1;
  } else if (which == kVirtual) {
    result.name = "virtual element";
    result.config.formulation = Formulation::kVirtual;
  }
  return result;
}

/// Numbers of cells an edge, so many that h is as good as small. With fewer, the error of the values at the
/// vertices, which falls faster, adds a tenth to the order in energy. On Voronoi cells the virtual element's
/// error in L2 over h^2 grows like 1 - 0.9 h (n = 6 to 15): cells at the boundary, whose vertices are held,
/// do better than others, and they become fewer.
std::vector<int> sizesOf(BodyKind kind, int which) {
  if (kind != BodyKind::kVoronoi) return {6, 8, 12};
  return which == kVirtual ? std::vector<int>{9, 12, 15} : std::vector<int>{7, 9, 11};
}

class Convergence : public testing::TestWithParam<std::tuple<BodyKind, int>> {};

// First-order elements: the error falls with h^2 in L2, with h in energy (S. C. Brenner, L. R. Scott, "The
// Mathematical Theory of Finite Element Methods", 2008, chapter 5).
TEST_P(Convergence, HasTheOrdersOfFirstOrderElements) {
  const auto [kind, which] = GetParam();
  const NamedFormulation element = formulation(which);
  const ConvergenceStudy study = studyConvergence(kind, sizesOf(kind, which), element.config);
  for (const ConvergencePoint& point : study.points) {
    RecordProperty("errors_of_" + std::to_string(point.unknowns),
                   std::to_string(point.l2_error) + " " + std::to_string(point.energy_error));
  }
  const double tolerance = isSliced(kind) ? 0.2 : 0.1;
  EXPECT_NEAR(study.l2_order, 2, tolerance) << toString(kind) << ", " << element.name;
  EXPECT_NEAR(study.energy_order, 1, tolerance) << toString(kind) << ", " << element.name;
}

// A tetrahedron is the same under every formulation.
INSTANTIATE_TEST_SUITE_P(Tetrahedra, Convergence,
                         testing::Values(std::make_tuple(BodyKind::kTetrahedra, kMeanValue4)));
INSTANTIATE_TEST_SUITE_P(Hexahedra, Convergence,
                         testing::Combine(testing::Values(BodyKind::kHexahedra),
                                          testing::Values(kMeanValue4, kMeanValue1, kVirtual)));
INSTANTIATE_TEST_SUITE_P(Polyhedra, Convergence,
                         testing::Combine(testing::Values(BodyKind::kVoronoi, BodyKind::kSlicedHexahedra,
                                                          BodyKind::kSlicedTetrahedra),
                                          testing::Values(kMeanValue4, kMeanValue1, kVirtual)));

}  // namespace
}  // namespace polyscalpel
