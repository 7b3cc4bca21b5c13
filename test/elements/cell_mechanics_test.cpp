// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/cell_mechanics.hpp"

#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "support/element_cells.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const IsotropicMaterial kMaterial{2.0, 0.3, 1.0};

std::vector<ElementConfig> formulations() {
  ElementConfig mean_value, one_point, virtual_element;
  one_point.quadrature_points = 1;
  virtual_element.formulation = Formulation::kVirtual;
  return {mean_value, one_point, virtual_element};
}

/// A cell with its matrices, in coordinates relative to its vertex mean.
struct CellAtRest {
  CellAtRest(const CellSurface& surface, const ElementConfig& config)
      : element(makeElementMatrices(surface, kMaterial, config)),
        rest(surface.points.leftCols(surface.num_vertices).colwise() - starCentre(surface)),
        extent(rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()) {}

  CellView view() const {
    return {element.volume,
            {lameLambda(kMaterial), shearModulus(kMaterial)},
            element.mean_gradient,
            element.stabilisation.isEmpty() ? nullptr : &element.stabilisation};
  }
  double stiffnessNorm() const { return stiffness(element, kMaterial).norm(); }

  ElementMatrices element;
  Matrix3Xd rest;
  Vector3d extent;
};

Matrix3Xd forcesOf(const CellLinearisation& linearisation, const CellView& view, const Matrix3Xd& positions) {
  CellWorkspace work(static_cast<int>(positions.cols()));
  Matrix3Xd forces = Matrix3Xd::Zero(3, positions.cols());
  addForces(linearisation, view, positions, work, forces);
  return forces;
}

Matrix3Xd forcesAt(const StrainMeasure& measure, const CellView& view, const Matrix3Xd& positions,
                   bool exact_force = true) {
  CellWorkspace work(static_cast<int>(positions.cols()));
  return forcesOf(linearise(measure, view, positions, exact_force, work), view, positions);
}

double energyAt(const StrainMeasure& measure, const CellView& view, const Matrix3Xd& positions) {
  CellWorkspace work(static_cast<int>(positions.cols()));
  return elasticEnergy(measure, view, positions, work);
}

/// The positive semidefinite tangent of a linearisation, by the formula of MeanLinearisation.
MatrixXd semidefiniteTangent(const CellLinearisation& linearisation, const CellView& view) {
  const Eigen::Index n = view.mean_gradient.cols();
  const Matrix3d &A = linearisation.mean.A, &S = linearisation.mean.S, &R = linearisation.R;
  const Matrix3Xd g = view.mean_gradient, h = A * g;
  const double lambda = view.moduli.lambda_pa, mu = view.moduli.mu_pa;
  MatrixXd tangent(3 * n, 3 * n), stabilising = MatrixXd::Zero(3 * n, 3 * n);
  if (view.stabilisation) stabilising = view.stabilisation->matrix();
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) {
      Matrix3d block = lambda * h.col(a) * h.col(b).transpose() + mu * h.col(b) * h.col(a).transpose() +
                       mu * g.col(a).dot(g.col(b)) * A * A.transpose() +
                       g.col(a).dot(S * g.col(b)) * Matrix3d::Identity();
      block *= view.volume;
      block += R * stabilising.block<3, 3>(3 * a, 3 * b) * R.transpose();
      tangent.block<3, 3>(3 * a, 3 * b) = block;
    }
  }
  return tangent;
}

Matrix3d someRotation() {
  return Eigen::AngleAxisd(2.1, Vector3d(1, -2, 0.7).normalized()).toRotationMatrix();
}

/// Strains of some `amount`, a turn, and a push at every vertex, each in proportion to the cell's extents.
Matrix3Xd deform(const CellAtRest& cell, double amount, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Matrix3d A;
  for (double& entry : A.reshaped()) entry = uniform(random);
  // Strained along the cell's own axes, so that a flat cell is not turned over.
  const Matrix3d scale = cell.extent.asDiagonal();
  Matrix3Xd x = cell.rest + amount * scale * A * scale.inverse() * cell.rest;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    x.col(i) += 0.5 * amount * scale * Vector3d(uniform(random), uniform(random), uniform(random));
  return someRotation() * x;
}

class CellMechanics : public testing::TestWithParam<std::tuple<Strain, int>> {
 protected:
  const StrainMeasure& measure_ = strainMeasure(std::get<0>(GetParam()));
  const ElementConfig config_ = formulations()[std::get<1>(GetParam())];
};

TEST_P(CellMechanics, ForceIsTheEnergysGradientAndTheTangentTheForces) {
  for (const NamedCell& named : makeCells()) {
    const CellAtRest cell(named.surface, config_);
    for (const double amount : {0.1, 0.2, 0.3}) {
      SCOPED_TRACE(named.name + ", deformed by " + std::to_string(amount));
      const Matrix3Xd x = deform(cell, amount, 7);
      const Matrix3Xd forces = forcesAt(measure_, cell.view(), x);
      const MatrixXd tangent = exactTangent(measure_, cell.view(), x);
      const double step = 2e-5 * cell.extent.minCoeff();
      VectorXd gradient(x.size());
      MatrixXd differences(x.size(), x.size());
      for (Eigen::Index j = 0; j < x.size(); ++j) {
        Matrix3Xd ahead = x, behind = x;
        ahead.reshaped()[j] += step;
        behind.reshaped()[j] -= step;
        gradient[j] =
            (energyAt(measure_, cell.view(), ahead) - energyAt(measure_, cell.view(), behind)) / (2 * step);
        const Matrix3Xd difference =
            forcesAt(measure_, cell.view(), ahead) - forcesAt(measure_, cell.view(), behind);
        differences.col(j) = difference.reshaped() / (2 * step);
      }
      EXPECT_LT((forces.reshaped() - gradient).norm(), 1e-6 * forces.norm());
      EXPECT_LT((tangent - differences).norm(), 1e-6 * tangent.norm());
      EXPECT_LT((tangent - tangent.transpose()).norm(), 1e-12 * tangent.norm());
    }
  }
}

TEST_P(CellMechanics, NoNetForceAndNoNetTorque) {
  if (!measure_.rotates()) GTEST_SKIP() << "small strain takes a turn for a strain: its torque is not zero";
  for (const NamedCell& named : makeCells()) {
    SCOPED_TRACE(named.name);
    const CellAtRest cell(named.surface, config_);
    for (const double amount : {0.1, 0.3}) {
      const Matrix3Xd x = deform(cell, amount, 8);
      const Matrix3Xd forces = forcesAt(measure_, cell.view(), x);
      const double rounding = 1e-13 * cell.stiffnessNorm() * x.norm();
      Vector3d torque = Vector3d::Zero();
      for (Eigen::Index i = 0; i < x.cols(); ++i) torque += Vector3d(x.col(i)).cross(Vector3d(forces.col(i)));
      EXPECT_LT(forces.rowwise().sum().norm(), rounding);
      EXPECT_LT(torque.norm(), rounding * cell.extent.maxCoeff());
    }
  }
}

TEST_P(CellMechanics, ForceAroundADeformationIsLinearWithTheSemidefiniteTangent) {
  for (const NamedCell& named : makeCells()) {
    SCOPED_TRACE(named.name);
    const CellAtRest cell(named.surface, config_);
    for (const bool exact_force : {false, true}) {
      const Matrix3Xd x = deform(cell, 0.3, 9);
      CellWorkspace work(static_cast<int>(x.cols()));
      const CellLinearisation linearisation = linearise(measure_, cell.view(), x, exact_force, work);
      const MatrixXd tangent = semidefiniteTangent(linearisation, cell.view());
      const Matrix3Xd there = deform(cell, 0.2, 10);
      const Matrix3Xd change =
          forcesOf(linearisation, cell.view(), there) - forcesOf(linearisation, cell.view(), x);
      const VectorXd expected = tangent * (there - x).reshaped();
      EXPECT_LT((change.reshaped() - expected).norm(), 1e-13 * tangent.norm() * x.norm());
      const VectorXd eigenvalues =
          Eigen::SelfAdjointEigenSolver<MatrixXd>(tangent, Eigen::EigenvaluesOnly).eigenvalues();
      EXPECT_GT(eigenvalues.minCoeff(), -1e-13 * tangent.norm());
    }
  }
}

TEST_P(CellMechanics, AtRestEveryStrainIsHookesLaw) {
  for (const NamedCell& named : makeCells()) {
    SCOPED_TRACE(named.name);
    const CellAtRest cell(named.surface, config_);
    CellWorkspace work(static_cast<int>(cell.rest.cols()));
    const MatrixXd K = stiffness(cell.element, kMaterial);
    const CellLinearisation linearisation = linearise(measure_, cell.view(), cell.rest, true, work);
    EXPECT_LT((semidefiniteTangent(linearisation, cell.view()) - K).norm(), 1e-12 * K.norm());
    EXPECT_LT((exactTangent(measure_, cell.view(), cell.rest) - K).norm(), 1e-12 * K.norm());
    EXPECT_LT(forcesAt(measure_, cell.view(), cell.rest).norm(), 1e-14 * K.norm() * cell.rest.norm());
    EXPECT_LT(energyAt(measure_, cell.view(), cell.rest), 1e-28 * K.norm() * cell.rest.squaredNorm());
  }
}

TEST_P(CellMechanics, TheRotationsDerivativeIsNothingToATetrahedron) {
  const CellAtRest cell(makeSurface(makeTetrahedronSketch()), config_);
  const Matrix3Xd x = deform(cell, 0.3, 11);
  EXPECT_EQ(forcesAt(measure_, cell.view(), x, true), forcesAt(measure_, cell.view(), x, false));
}

INSTANTIATE_TEST_SUITE_P(Strains, CellMechanics,
                         testing::Combine(testing::Values(Strain::kLinear, Strain::kCorotated,
                                                          Strain::kGreen),
                                          testing::Range(0, 3)));

/// Ways in which a step that went wrong may leave a cell: maps of its rest shape.
struct Ruin {
  std::string name;
  Vector3d stretches;
};
const Ruin kRuins[] = {{"mirrored", {-1, 1, 1}},
                       {"mirrored and squeezed", {0.9, 1.2, -0.4}},
                       {"mirrored in its centre", {-1, -1, -1}},
                       {"flat", {1, 1.1, 0}},
                       {"a line", {0, 1, 0}},
                       {"a point", {0, 0, 0}}};

class RuinedCell : public testing::TestWithParam<std::tuple<Strain, int>> {
 protected:
  const StrainMeasure& measure_ = strainMeasure(std::get<0>(GetParam()));
  const ElementConfig config_ = formulations()[std::get<1>(GetParam())];
};

TEST_P(RuinedCell, HasAFiniteForceEnergyAndTangent) {
  for (const NamedCell& named : makeCells()) {
    const CellAtRest cell(named.surface, config_);
    const double norm = cell.stiffnessNorm();
    for (const Ruin& ruin : kRuins) {
      SCOPED_TRACE(named.name + ", " + ruin.name);
      const Matrix3Xd x = someRotation() * ruin.stretches.asDiagonal() * cell.rest;
      CellWorkspace work(static_cast<int>(x.cols()));
      const CellLinearisation linearisation = linearise(measure_, cell.view(), x, true, work);
      // Above any that the stretches themselves make, a bound that the floor of the rotation's turn may take
      // a good part of; infinity and NaN fail it too.
      EXPECT_LT(forcesOf(linearisation, cell.view(), x).norm(), 1e6 * norm * cell.rest.norm());
      EXPECT_GT(energyAt(measure_, cell.view(), x), 0);
      EXPECT_LT(energyAt(measure_, cell.view(), x), 100 * norm * cell.rest.squaredNorm());
      EXPECT_TRUE(exactTangent(measure_, cell.view(), x).allFinite());
      EXPECT_LT(semidefiniteTangent(linearisation, cell.view()).norm(), 1.001 * norm);
    }
  }
}

/// Distance of the shape from its rest shape after the best rigid motion, over the size of the rest shape.
double shapeError(const Matrix3Xd& x, const Matrix3Xd& rest) {
  const Matrix3Xd to = x.colwise() - x.rowwise().mean();
  const Matrix3Xd from = rest.colwise() - rest.rowwise().mean();
  const Eigen::JacobiSVD<Matrix3d> svd(to * from.transpose(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vector3d signs(1, 1, svd.matrixU().determinant() * svd.matrixV().determinant());
  const Matrix3d R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return (to - R * from).norm() / from.norm();
}

TEST_P(RuinedCell, ReturnsToItsRestShapeWhenReleased) {
  for (const NamedCell& named : makeCells()) {
    const CellAtRest cell(named.surface, config_);
    const double norm = cell.stiffnessNorm();
    const auto n = static_cast<int>(cell.rest.cols());
    for (const Ruin& ruin : kRuins) {
      SCOPED_TRACE(named.name + ", " + ruin.name);
      Matrix3Xd x = someRotation() * ruin.stretches.asDiagonal() * cell.rest;
      // Implicit steps without inertia: (d + K) dx = f, d the drag, which also holds the rigid motions.
      CellWorkspace work(n);
      constexpr int kMostSteps = 2000;
      int step = 0;
      // Small strain ends at a linearised turn, and the rounding of that is energy.
      const double enough = (measure_.rotates() ? 1e-18 : 1e-16) * norm * cell.rest.squaredNorm();
      while (step < kMostSteps && energyAt(measure_, cell.view(), x) > enough) {
        ++step;
        const CellLinearisation linearisation = linearise(measure_, cell.view(), x, true, work);
        MatrixXd K = semidefiniteTangent(linearisation, cell.view());
        K.diagonal().array() += 1e-4 * norm;
        const VectorXd dx = K.ldlt().solve(forcesOf(linearisation, cell.view(), x).reshaped());
        x -= dx.reshaped(3, n);
      }
      EXPECT_LT(step, kMostSteps) << energyAt(measure_, cell.view(), x) / enough;
      if (!measure_.rotates()) continue;
      EXPECT_LT(shapeError(x, cell.rest), 1e-6);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Strains, RuinedCell,
                         testing::Combine(testing::Values(Strain::kLinear, Strain::kCorotated),
                                          testing::Values(0, 2)));

}  // namespace
}  // namespace polyscalpel
