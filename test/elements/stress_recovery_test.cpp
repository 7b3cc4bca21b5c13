// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/stress_recovery.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

const IsotropicMaterial kMaterial{2e4, 0.3, 1000};

PolyhedralMesh makePolyhedra() {
  PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {0.2, 0.1, 0.1}, {4, 2, 2});
  const CutResult result =
      cutMesh(mesh, mesh.restPositions(), PlaneCut{{0.093, 0.052, 0.047}, {1, 0.4, 0.3}}, CuttingConfig(), 1);
  EXPECT_EQ(result.status, CutStatus::kCut) << result.message;
  return mesh;
}

ElementConfig withStrain(Strain strain) {
  ElementConfig config;
  config.strain = strain;
  return config;
}

Eigen::Matrix3d turn() {
  return Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
}

TEST(StressRecovery, UniformStretchHasItsStressEverywhereAndNoError) {
  const PolyhedralMesh mesh = makePolyhedra();
  const Eigen::Vector3d stretch(1.02, 0.99, 1.01);
  const Eigen::Matrix3Xd stretched = stretch.asDiagonal() * mesh.restPositions();
  const double lambda = lameLambda(kMaterial), mu = shearModulus(kMaterial);
  for (const Strain strain : {Strain::kLinear, Strain::kCorotated, Strain::kGreen}) {
    const Assembly assembly(mesh, kMaterial, withStrain(strain), 0);
    const Eigen::Matrix3d R = strain == Strain::kLinear ? Eigen::Matrix3d::Identity().eval() : turn();
    const StressField field = recoverStress(mesh, assembly, R * stretched);
    Eigen::Vector3d strains = stretch.array() - 1;
    if (strain == Strain::kGreen) strains = (stretch.array().square() - 1) / 2;
    Eigen::Vector3d stresses = (2 * mu * strains).array() + lambda * strains.sum();
    if (strain == Strain::kGreen) stresses = stresses.array() * stretch.array().square() / stretch.prod();
    const Eigen::Matrix3d expected = R * stresses.asDiagonal() * R.transpose();
    Eigen::Matrix<double, 6, 1> column;
    column << expected(0, 0), expected(1, 1), expected(2, 2), expected(1, 2), expected(2, 0), expected(0, 1);
    const double rounding = 1e-10 * column.norm();
    EXPECT_LT((field.cell_stresses.colwise() - column).colwise().norm().maxCoeff(), rounding);
    EXPECT_LT((field.vertex_stresses.colwise() - column).colwise().norm().maxCoeff(), rounding);
    EXPECT_LT(field.relative_error, 1e-8);
    EXPECT_NEAR(field.cell_strains.topRows<3>().colwise().sum().maxCoeff(), strains.sum(), 1e-12);
    const Eigen::Vector3d principal = principalValues(field.cell_stresses).col(0);
    EXPECT_LT((principal - Eigen::Vector3d(stresses[0], stresses[2], stresses[1])).norm(), rounding);
    const double s =
        std::sqrt(0.5 * (std::pow(stresses[0] - stresses[1], 2) + std::pow(stresses[1] - stresses[2], 2) +
                         std::pow(stresses[2] - stresses[0], 2)));
    EXPECT_NEAR(vonMises(field.cell_stresses)[0], s, rounding);
  }
}

TEST(StressRecovery, RigidMotionHasNoStress) {
  const PolyhedralMesh mesh = makePolyhedra();
  const Assembly assembly(mesh, kMaterial, {}, 0);
  const StressField field =
      recoverStress(mesh, assembly, (turn() * mesh.restPositions()).colwise() + Eigen::Vector3d(1, 2, 3));
  EXPECT_LT(field.cell_stresses.norm(), 1e-8 * kMaterial.youngs_modulus_pa);
  EXPECT_GE(field.relative_error, 0);
  EXPECT_LE(field.relative_error, 1);
}

/// Nodal values of a bending field: for a quadratic displacement the interpolant's true energy error is of
/// order h, and the estimate must follow it.
TEST(StressRecovery, EstimateFallsWithTheCellSizeLikeTheError) {
  for (const bool tetrahedra : {false, true}) {
    std::vector<double> estimates;
    for (const int n : {4, 8, 16}) {
      const PolyhedralMesh mesh = tetrahedra ? makeTetBox({0, 0, 0}, {1, 1, 1}, {n, n, n})
                                             : makeHexBox({0, 0, 0}, {1, 1, 1}, {n, n, n});
      Eigen::Matrix3Xd positions = mesh.restPositions();
      for (Eigen::Index i = 0; i < positions.cols(); ++i) {
        const Eigen::Vector3d X = positions.col(i);
        positions.col(i) += 1e-3 * Eigen::Vector3d(X.x() * X.z(), X.y() * X.z(), -0.5 * X.x() * X.x());
      }
      const Assembly assembly(mesh, kMaterial, withStrain(Strain::kLinear), 0);
      estimates.push_back(recoverStress(mesh, assembly, positions).relative_error);
    }
    const double order = std::log2(estimates[1] / estimates[2]);
    EXPECT_GT(order, 0.8) << estimates[0] << " " << estimates[1] << " " << estimates[2];
    EXPECT_LT(order, 1.6) << estimates[0] << " " << estimates[1] << " " << estimates[2];
  }
}

TEST(StressRecovery, AJumpBetweenMaterialsIsNoError) {
  const PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {0.2, 0.1, 0.1}, {4, 2, 2});
  CellKinds kinds;
  kinds.kinds = {{kMaterial, withStrain(Strain::kLinear)}, {kMaterial, withStrain(Strain::kLinear)}};
  kinds.kinds[1].material.youngs_modulus_pa *= 100;
  for (auto& kind : kinds.kinds) kind.material.poisson_ratio = 0;
  kinds.of_cell.assign(mesh.cellCapacity(), 0);
  for (const CellId cell : mesh.cells()) {
    double x = 0;
    for (const VertexId vertex : mesh.cell(cell).vertices) x += mesh.restPosition(vertex).x() / 8;
    if (x > 0.1) kinds.of_cell[cell.index()] = 1;
  }
  const Assembly assembly(mesh, kinds, 0);
  // In series under one tension: the soft half stretches a hundred times as much.
  Eigen::Matrix3Xd positions = mesh.restPositions();
  for (double& x : positions.row(0)) x += x < 0.1 ? 1e-2 * x : 1e-3 + 1e-4 * (x - 0.1);
  const StressField field = recoverStress(mesh, assembly, positions);
  EXPECT_LT(field.relative_error, 1e-8);
  EXPECT_LT((field.cell_stresses.row(0).array() - 200).abs().maxCoeff(), 1e-8);
}

TEST(StressRecovery, ConcentratesAtTheRootOfABentBeam) {
  const PolyhedralMesh mesh = makeTetBox({0, 0, 0}, {0.4, 0.1, 0.1}, {8, 2, 2});
  const Assembly assembly(mesh, kMaterial, {}, 0);
  Eigen::Matrix3Xd positions = mesh.restPositions();
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    const double x = positions(0, i);
    positions(2, i) -= x < 0.1 ? x * x : 0.2 * x - 0.01;  // bent near the root, straight beyond
  }
  const StressField field = recoverStress(mesh, assembly, positions);
  const Eigen::VectorXd stress = vonMises(field.vertex_stresses);
  Eigen::Index where = 0;
  stress.maxCoeff(&where);
  EXPECT_LT(mesh.restPositions()(0, where), 0.15);
  EXPECT_GT(field.relative_error, 0);
  EXPECT_LT(field.relative_error, 1);
}

}  // namespace
}  // namespace polyscalpel
