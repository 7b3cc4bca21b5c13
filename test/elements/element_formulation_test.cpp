// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/element_formulation.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "polyscalpel/elements/corotation.hpp"
#include "polyscalpel/elements/mean_value_coordinates.hpp"
#include "polyscalpel/elements/quadrature.hpp"
#include "support/element_cells.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

const IsotropicMaterial kMaterial{2e4, 0.35, 1100};

ElementConfig withPoints(int quadrature_points) {
  ElementConfig config;
  config.quadrature_points = quadrature_points;
  return config;
}

/// Each formulation by what a polyhedron takes: 0 the virtual element, else the quadrature points of mean
/// values.
ElementConfig makeConfig(int points) {
  ElementConfig config = withPoints(points == 0 ? 4 : points);
  if (points == 0) config.formulation = Formulation::kVirtual;
  config.consistent_mass = true;
  return config;
}

/// Every kind of cell under every formulation, of sizes 1e-6, 1 and 1e3 m.
class ElementMatricesTest : public testing::TestWithParam<std::tuple<int, int, double>> {
 protected:
  const double size_ = std::get<2>(GetParam());
  const NamedCell cell_ = makeCells()[std::get<0>(GetParam())];
  const CellSurface surface_ = transformed(cell_.surface, size_* Matrix3d::Identity(), Vector3d::Zero());
  const ElementConfig config_ = makeConfig(std::get<1>(GetParam()));
  const ElementMatrices element_ = makeElementMatrices(surface_, kMaterial, config_);
  const int n_ = surface_.num_vertices;
  const Matrix3Xd rest_ = surface_.points.leftCols(n_);
  const MatrixXd stiffness_ = stiffness(element_, kMaterial);
  const double stiffness_norm_ = stiffness_.norm();
};

TEST_P(ElementMatricesTest, ShapesAndVolume) {
  EXPECT_NEAR(element_.volume, volume(surface_), 1e-14 * element_.volume);
  EXPECT_EQ(element_.mean_gradient.cols(), n_);
  const Eigen::Index num_modes = n_ - 4;  // what no linear field has
  EXPECT_EQ(element_.stabilisation.isEmpty(), surface_.isTetrahedron());
  EXPECT_EQ(element_.stabilisation.numModes(), num_modes);
  EXPECT_EQ(element_.stabilisation.stiffness.rows(), 3 * num_modes);
  EXPECT_EQ(element_.stabilisation.stiffness.cols(), 3 * num_modes);
  EXPECT_EQ(element_.stabilisation.rest_modes.cols(), num_modes);
  EXPECT_EQ(element_.shape_integral.size(), n_);
  EXPECT_EQ(element_.mass_integral.rows(), n_);
  EXPECT_EQ(element_.mass_integral.cols(), n_);
}

TEST_P(ElementMatricesTest, StiffnessIsSymmetricSemidefiniteWithSixZeroModes) {
  SCOPED_TRACE(cell_.name);
  EXPECT_EQ(stiffness_, stiffness_.transpose());
  const VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(stiffness_, Eigen::EigenvaluesOnly).eigenvalues();
  // Backward error of the eigenvalues: unit roundoff times the norm, a few times the dimension.
  const double rounding = 4 * n_ * std::numeric_limits<double>::epsilon() * stiffness_norm_;
  EXPECT_LE(eigenvalues.head<6>().cwiseAbs().maxCoeff(), rounding);
  EXPECT_GT(eigenvalues(6), 100 * rounding);
}

TEST_P(ElementMatricesTest, LinearFieldGivesTheForcesOfItsConstantStress) {
  SCOPED_TRACE(cell_.name);
  Matrix3d gradient;
  gradient << 0.01, 0.02, -0.03, 0.005, -0.015, 0.04, 0.02, -0.01, 0.03;
  const Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const Matrix3d stress =
      lameLambda(kMaterial) * strain.trace() * Matrix3d::Identity() + 2 * shearModulus(kMaterial) * strain;
  // Tractions of that stress, integrated over the surface against the shape functions.
  Matrix3Xd expected = Matrix3Xd::Zero(3, surface_.points.cols());
  for (const auto& [a, b, c] : surface_.triangles) {
    const Vector3d p = surface_.points.col(a);
    const Vector3d share = stress * (surface_.points.col(b) - p).cross(surface_.points.col(c) - p) / 6;
    for (const int corner : {a, b, c}) expected.col(corner) += share;
  }
  for (std::size_t i = 0; i < surface_.parents.size(); ++i) {
    for (const int parent : surface_.parents[i])
      expected.col(parent) += expected.col(n_ + i) / surface_.parents[i].size();
  }
  const Matrix3Xd displacements = gradient * rest_;
  const VectorXd forces = stiffness_ * displacements.reshaped();
  const double scale = stiffness_norm_ * displacements.norm();
  EXPECT_LE((forces - expected.leftCols(n_).reshaped()).norm(), 1e-14 * scale);
}

TEST_P(ElementMatricesTest, RigidMotionGivesNoForceWhenWarped) {
  SCOPED_TRACE(cell_.name);
  for (const Vector3d& axis :
       {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(1, 2, -3), Vector3d(-1, 1, 1)}) {
    for (int degrees = 0; degrees <= 180; degrees += 15) {
      const Matrix3d Q = Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized()).toRotationMatrix();
      const Matrix3Xd positions = (Q * rest_).colwise() + size_ * Vector3d(0.3, -0.2, 0.5);
      const Matrix3d R = polarRotation(meanDeformationGradient(positions, element_.mean_gradient));
      const Matrix3Xd warped = R.transpose() * positions - rest_;
      const Matrix3Xd forces = R * (stiffness_ * warped.reshaped()).reshaped(3, n_);
      ASSERT_LE(forces.norm(), 1e-12 * stiffness_norm_ * positions.norm()) << degrees;
    }
  }
}

TEST_P(ElementMatricesTest, MeanGradientIsExactOnLinearFields) {
  SCOPED_TRACE(cell_.name);
  // The areas are sums of numbers rounded to eps times their size, divided by the thickness.
  const double rounding = 1e-14 * element_.mean_gradient.norm();
  EXPECT_LE(element_.mean_gradient.rowwise().sum().norm(), rounding);
  EXPECT_LE((rest_ * element_.mean_gradient.transpose() - Matrix3d::Identity()).norm(), rounding * size_);
}

TEST_P(ElementMatricesTest, MassKeepsVolumeAndCentroid) {
  SCOPED_TRACE(cell_.name);
  const double V = element_.volume;
  EXPECT_GE(element_.shape_integral.minCoeff(), 0);
  EXPECT_NEAR(element_.shape_integral.sum(), V, 1e-14 * V);
  EXPECT_NEAR(element_.mass_integral.sum(), V, 1e-13 * V);
  EXPECT_LE((element_.mass_integral - element_.mass_integral.transpose()).norm(), 1e-15 * V);
  const double smallest =
      Eigen::SelfAdjointEigenSolver<MatrixXd>(element_.mass_integral).eigenvalues().minCoeff();
  // One point in each sub-tet does not see every combination of vertices in a cube.
  if (config_.quadrature_points == 1) {
    EXPECT_GT(smallest, -1e-15 * V);
  } else {
    EXPECT_GT(smallest, 1e-12 * V);
  }
  if (!cell_.is_convex) return;
  const VectorXd row_sums = element_.mass_integral.rowwise().sum();
  EXPECT_LE((row_sums - element_.shape_integral).norm(), 1e-13 * V);
  const CellQuadrature quadrature = makeCellQuadrature(surface_, tetrahedronRule(1));
  const Vector3d moment = quadrature.points * quadrature.weights + V * starCentre(surface_);
  EXPECT_LE((rest_ * element_.shape_integral - moment).norm(), 1e-13 * V * size_);
}

TEST_P(ElementMatricesTest, InvariantUnderRotationAndTranslation) {
  SCOPED_TRACE(cell_.name);
  const Matrix3d Q = Eigen::AngleAxisd(2.2, Vector3d(1, 1, -2).normalized()).toRotationMatrix();
  const CellSurface moved = transformed(surface_, Q, size_ * Vector3d(1, -2, 1));
  const ElementMatrices turned = makeElementMatrices(moved, kMaterial, config_);
  // Moving the cell rounds its coordinates by eps times three sizes; a thin cell feels that over its
  // thickness.
  const double rounding = 1e-13 * element_.mean_gradient.norm() * size_;
  MatrixXd expected(3 * n_, 3 * n_);
  for (int a = 0; a < n_; ++a) {
    for (int b = 0; b < n_; ++b)
      expected.block<3, 3>(3 * a, 3 * b) = Q * stiffness_.block<3, 3>(3 * a, 3 * b) * Q.transpose();
  }
  EXPECT_LE((stiffness(turned, kMaterial) - expected).norm(), rounding * stiffness_norm_);
  EXPECT_NEAR(turned.volume, element_.volume, rounding * element_.volume);
  EXPECT_LE((turned.shape_integral - element_.shape_integral).norm(), rounding * element_.volume);
  EXPECT_LE((turned.mass_integral - element_.mass_integral).norm(), rounding * element_.volume);
}

TEST_P(ElementMatricesTest, ScalesWithTheSize) {
  const ElementMatrices unit = makeElementMatrices(cell_.surface, kMaterial, config_);
  EXPECT_LE((stiffness_ - size_ * stiffness(unit, kMaterial)).norm(), 1e-11 * stiffness_norm_) << cell_.name;
  EXPECT_LE((element_.shape_integral - std::pow(size_, 3) * unit.shape_integral).norm(),
            1e-11 * element_.volume);
}

INSTANTIATE_TEST_SUITE_P(Cells, ElementMatricesTest,
                         testing::Combine(testing::Range(0, static_cast<int>(makeCells().size())),
                                          testing::Values(0, 1, 4, 11), testing::Values(1e-6, 1.0, 1e3)));

/// The definition in the header, with 6 x 3n matrices of strains.
TEST(ElementMatrices, StiffnessIsItsDefinition) {
  const auto strains = [](const Eigen::Ref<const Matrix3Xd>& g) {
    MatrixXd B = MatrixXd::Zero(6, 3 * g.cols());
    for (int i = 0; i < g.cols(); ++i) {
      B.block<6, 3>(0, 3 * i) << g(0, i), 0, 0, 0, g(1, i), 0, 0, 0, g(2, i),  //
          0, g(2, i), g(1, i), g(2, i), 0, g(0, i), g(1, i), g(0, i), 0;
    }
    return B;
  };
  const Eigen::Matrix<double, 6, 6> C = elasticityMatrix(kMaterial);
  for (const NamedCell& cell : makeCells()) {
    if (cell.surface.isTetrahedron()) continue;
    SCOPED_TRACE(cell.name);
    const int n = cell.surface.num_vertices;
    const double alpha = 0.7;
    ElementConfig config;
    config.stabilisation_scale = alpha;
    config.stabilisation_modulus = StabilisationModulus::kFull;
    const ElementMatrices element = makeElementMatrices(cell.surface, kMaterial, config);
    const CellQuadrature quadrature = makeCellQuadrature(cell.surface, tetrahedronRule(4));
    MeanValueCoordinates<double> coordinates;
    coordinates.setSurface(cell.surface);
    coordinates.evaluate(quadrature.points);
    const VectorXd mean = coordinates.gradients() * quadrature.weights / element.volume;
    const MatrixXd Bm = strains(element.mean_gradient);
    MatrixXd expected = element.volume * Bm.transpose() * C * Bm;
    for (int q = 0; q < quadrature.weights.size(); ++q) {
      const VectorXd fluctuation = coordinates.gradients().col(q) - mean;
      const MatrixXd B = strains(fluctuation.reshaped(3, n));
      expected += alpha * quadrature.weights(q) * B.transpose() * C * B;
    }
    EXPECT_LE((stiffness(element, kMaterial) - expected).norm(), 1e-12 * expected.norm());
    EXPECT_EQ(element.mass_integral.size(), 0);
  }
}

TEST(ElementMatrices, ShearOnlyStabilisationLeavesOutLambda) {
  const CellSurface cube = makeSurface(makeCubeSketch());
  for (const int points : {0, 4}) {
    ElementConfig config = makeConfig(points);
    const auto stabilisation = [&](const IsotropicMaterial& material, StabilisationModulus modulus) {
      config.stabilisation_modulus = modulus;
      return makeElementMatrices(cube, material, config).stabilisation.matrix();
    };
    // nu = 0 has lambda = 0 anyway.
    const IsotropicMaterial plain{2e4, 0, 1100};
    EXPECT_EQ(stabilisation(plain, StabilisationModulus::kShear),
              stabilisation(plain, StabilisationModulus::kFull));
    const IsotropicMaterial soft{2e4, 0.49, 1100};
    EXPECT_EQ(stabilisation(soft, StabilisationModulus::kShear),
              stabilisation(soft, StabilisationModulus::kAutomatic));
    EXPECT_GT(stabilisation(soft, StabilisationModulus::kFull).trace(),
              2 * stabilisation(soft, StabilisationModulus::kShear).trace());
    // At or below the bound the material's own C.
    const IsotropicMaterial auxetic{2e4, -0.3, 1100};
    EXPECT_EQ(stabilisation(auxetic, StabilisationModulus::kFull),
              stabilisation(auxetic, StabilisationModulus::kAutomatic));
  }
}

TEST(ElementMatrices, StabilisationDoesNotFeelLinearFields) {
  for (const NamedCell& cell : makeCells()) {
    if (cell.surface.isTetrahedron()) continue;
    for (const int points : {0, 1, 4}) {
      const ElementMatrices element = makeElementMatrices(cell.surface, kMaterial, makeConfig(points));
      const MatrixXd S = element.stabilisation.matrix();
      Matrix3d gradient;
      gradient << 0.3, 0.2, -0.3, 0.5, -0.15, 0.4, 0.2, -0.1, 0.3;
      const Matrix3Xd field =
          (gradient * cell.surface.points.leftCols(cell.surface.num_vertices)).colwise() + Vector3d(1, 2, 3);
      EXPECT_LE((S * field.reshaped()).norm(), 1e-13 * S.norm() * field.norm()) << cell.name << points;
    }
  }
}

TEST(ElementMatrices, VirtualElementOfACubeIsAsStiffAsMeanValuesOnAverage) {
  const CellSurface cube = makeSurface(makeCubeSketch());
  const double mean_values =
      makeElementMatrices(cube, kMaterial, makeConfig(4)).stabilisation.stiffness.trace();
  const double virtual_element =
      makeElementMatrices(cube, kMaterial, makeConfig(0)).stabilisation.stiffness.trace();
  EXPECT_NEAR(virtual_element, mean_values, 0.02 * mean_values);
}

TEST(ElementMatrices, TetrahedronTakesTheClosedForm) {
  const CellSurface surface = makeSurface(makeTetrahedronSketch());
  const ElementMatrices element = makeElementMatrices(surface, kMaterial, makeConfig(4));
  for (const int points : {0, 1, 11}) {
    ElementConfig config = makeConfig(points);
    config.stabilisation_scale = 5;
    const ElementMatrices other = makeElementMatrices(surface, kMaterial, config);
    EXPECT_EQ(stiffness(other, kMaterial), stiffness(element, kMaterial));
  }
  const double V = element.volume;
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(element.shape_integral(i), V / 4, 1e-16);
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(element.mass_integral(i, j), V / 20 * (1 + (i == j)), 1e-16);
  }
}

TEST(ElementMatrices, CubeHasEqualMassAtItsCorners) {
  for (const int points : {0, 1, 4, 11}) {
    const ElementMatrices cube =
        makeElementMatrices(makeSurface(makeCubeSketch()), kMaterial, makeConfig(points));
    EXPECT_LE((cube.shape_integral.array() - 0.125).abs().maxCoeff(), 1e-15);
  }
}

TEST(ElementMatrices, ThinSliversKeepRigidMotionsAndLinearFields) {
  for (const double thickness : {1e-2, 1e-4, 1e-6}) {
    const CellSurface sliver =
        transformed(makeSurface(makePrismSketch()), Vector3d(1, 1, thickness).asDiagonal(), Vector3d::Zero());
    const ElementMatrices element = makeElementMatrices(sliver, kMaterial, {});
    ASSERT_TRUE(stiffness(element, kMaterial).allFinite());
    const double norm = stiffness(element, kMaterial).norm();
    Matrix3d spin;
    spin << 0, -1, 2, 1, 0, -3, -2, 3, 0;
    const Matrix3Xd motion = (spin * sliver.points.leftCols(6)).colwise() + Vector3d(1, 2, 3);
    EXPECT_LE((stiffness(element, kMaterial) * motion.reshaped()).norm(), 1e-14 * norm * motion.norm())
        << thickness;
  }
}

TEST(ElementMatrices, BadCellsAndRulesAreRefused) {
  PolyhedronSketch sketch = makeCubeSketch();
  sketch.points.col(6) = Vector3d(-0.5, -0.5, -0.5);
  for (const int points : {0, 4}) {
    EXPECT_THROW(makeElementMatrices(makeSurface(sketch), kMaterial, makeConfig(points)),
                 std::invalid_argument);
  }
  EXPECT_THROW(makeElementMatrices(makeSurface(makeCubeSketch()), kMaterial, withPoints(3)),
               std::invalid_argument);
}

TEST(ElementConfig, Bounds) {
  EXPECT_NO_THROW(validate(ElementConfig{}));
  for (const int points : {1, 4, 11}) EXPECT_NO_THROW(validate(withPoints(points)));
  for (const int points : {-1, 0, 2, 3, 5, 10, 12})
    EXPECT_THROW(validate(withPoints(points)), std::invalid_argument);
  ElementConfig config;
  for (const double scale : {1e-300, 0.5, 1.0, 1e6}) {
    config.stabilisation_scale = scale;
    EXPECT_NO_THROW(validate(config));
  }
  for (const double scale : {0.0, -1e-300, -1.0, std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    config.stabilisation_scale = scale;
    try {
      validate(config);
      ADD_FAILURE() << scale;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("stabilisation_scale = "), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace polyscalpel
