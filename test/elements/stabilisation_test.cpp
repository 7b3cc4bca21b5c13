// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/stabilisation.hpp"

#include <random>

#include <gtest/gtest.h>

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::MatrixXd;

Matrix3Xd randomPoints(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Matrix3Xd::NullaryExpr(3, n, [&] { return uniform(random); });
}

TEST(NonLinearModes, AreOrthonormalAndKnowNoLinearField) {
  for (const double flatness : {1.0, 1e-3, 1e-7}) {
    for (int n = 5; n <= 14; ++n) {
      Matrix3Xd points = randomPoints(n, static_cast<unsigned>(n));
      points.row(2) *= flatness;
      points.colwise() += points.rowwise().norm();
      const MatrixXd H = nonLinearModes(points);
      ASSERT_EQ(H.rows(), n);
      ASSERT_EQ(H.cols(), n - 4);
      EXPECT_LE((H.transpose() * H - MatrixXd::Identity(n - 4, n - 4)).norm(), 1e-14 * n);
      EXPECT_LE((H.transpose() * Eigen::VectorXd::Ones(n)).norm(), 1e-14 * n);
      points.colwise() -= points.rowwise().mean();
      // The short direction of a flat cell too, relative to its own length.
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_LE((points.row(axis) * H).norm(), 1e-14 * n * points.row(axis).norm());
    }
  }
}

TEST(NonLinearModes, OfATetrahedronAreNone) {
  EXPECT_EQ(nonLinearModes(randomPoints(4, 1)).cols(), 0);
}

TEST(Stabilisation, MatrixIsThatOfTheModesSeenFromTheVertices) {
  const int n = 7, m = 3;
  const Matrix3Xd points = randomPoints(n, 2);
  const MatrixXd half = MatrixXd::Random(3 * m, 3 * m);
  const Stabilisation stabilisation{nonLinearModes(points), half * half.transpose(),
                                    points * nonLinearModes(points)};
  const MatrixXd S = stabilisation.matrix();
  EXPECT_EQ(S, S.transpose());
  const Matrix3Xd moved = randomPoints(n, 3);
  const Matrix3Xd in_modes = moved * stabilisation.modes;
  const double energy = in_modes.reshaped().dot(stabilisation.stiffness * in_modes.reshaped());
  EXPECT_NEAR(moved.reshaped().dot(S * moved.reshaped()), energy, 1e-13 * energy);
  for (int i = 0; i < n; ++i) {
    const double trace = S.block<3, 3>(3 * i, 3 * i).trace();
    EXPECT_NEAR(stabilisation.traceAt(i), trace, 1e-13 * S.trace());
  }
}

TEST(Stabilisation, OfATetrahedronIsEmpty) {
  const Stabilisation none;
  EXPECT_TRUE(none.isEmpty());
  EXPECT_EQ(none.traceAt(0), 0);
}

}  // namespace
}  // namespace polyscalpel
