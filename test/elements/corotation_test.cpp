// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/corotation.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace polyscalpel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d randomMatrix(std::mt19937& generator) {
  std::normal_distribution<double> normal;
  return Matrix3d::NullaryExpr([&] { return normal(generator); });
}

Matrix3d randomRotation(std::mt19937& generator) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(generator), normal(generator), normal(generator), normal(generator))
      .normalized()
      .toRotationMatrix();
}

void expectRotation(const Matrix3d& R) {
  ASSERT_TRUE(R.allFinite());
  EXPECT_LE((R.transpose() * R - Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_NEAR(R.determinant(), 1, 1e-14);
}

TEST(PolarRotation, RandomMatricesOfAnyScale) {
  std::mt19937 generator(1);
  for (const double scale : {1e-300, 1e-12, 1.0, 1e12, 1e150, 1e300}) {
    for (int i = 0; i < 2000; ++i) {
      const Matrix3d F = randomMatrix(generator);
      const Matrix3d R = polarRotation(scale * F);
      expectRotation(R);
      const Matrix3d S = R.transpose() * F;
      EXPECT_LE((S - S.transpose()).norm(), 1e-14 * F.norm());
    }
  }
}

TEST(PolarRotation, RecoversTheRotationOfAStretchedBody) {
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> stretch(0.2, 3);
  for (int i = 0; i < 5000; ++i) {
    const Matrix3d R = randomRotation(generator);
    const Matrix3d Q = randomRotation(generator);
    const Vector3d stretches(stretch(generator), stretch(generator), stretch(generator));
    const Matrix3d F = R * Q * stretches.asDiagonal() * Q.transpose();
    EXPECT_LE((polarRotation(F) - R).norm(), 2e-14);
  }
}

TEST(PolarRotation, ARotationIsItsOwn) {
  std::mt19937 generator(3);
  EXPECT_LE((polarRotation(Matrix3d::Identity()) - Matrix3d::Identity()).norm(), 1e-15);
  for (int i = 0; i < 1000; ++i) {
    const Matrix3d R = randomRotation(generator);
    EXPECT_LE((polarRotation(R) - R).norm(), 2e-15);
  }
}

TEST(PolarRotation, InvertedIsMirroredInTheLeastStretchedDirection) {
  std::mt19937 generator(4);
  for (int i = 0; i < 2000; ++i) {
    const Matrix3d R = randomRotation(generator);
    const Matrix3d Q = randomRotation(generator);
    const Matrix3d F = R * Q * Vector3d(1.5, 0.9, -0.4).asDiagonal() * Q.transpose();
    EXPECT_LE((polarRotation(F) - R).norm(), 1e-14);
  }
}

TEST(PolarRotation, DegenerateMatricesGiveARotationThatFits) {
  std::mt19937 generator(5);
  for (int i = 0; i < 500; ++i) {
    const Matrix3d A = randomRotation(generator), B = randomRotation(generator);
    for (const Vector3d& stretches :
         {Vector3d(1, 0.5, 0), Vector3d(1, 1, 0), Vector3d(1, 0, 0), Vector3d(1, 0.5, 1e-17),
          Vector3d(1, 1e-9, 1e-9), Vector3d(1, 1, -1), Vector3d(-1, -1, -1), Vector3d(1, 1e-9, -1e-9)}) {
      const Matrix3d F = A * stretches.asDiagonal() * B.transpose();
      const Matrix3d R = polarRotation(F);
      expectRotation(R);
      const Matrix3d S = R.transpose() * F;
      EXPECT_LE((S - S.transpose()).norm(), 1e-14);
      // Of all rotations R maximises tr(R^T F) = s0 + s1 + sign(det F) s2.
      const Vector3d sizes = stretches.cwiseAbs();
      const double sign = stretches.prod() < 0 ? -1 : 1;
      EXPECT_NEAR(S.trace(), sizes.sum() - (1 - sign) * sizes.minCoeff(), 1e-14);
    }
  }
  expectRotation(polarRotation(Matrix3d::Zero()));
  expectRotation(polarRotation(-Matrix3d::Identity()));
  expectRotation(polarRotation(Matrix3d::Constant(1)));
  expectRotation(polarRotation(Matrix3d::Constant(std::numeric_limits<double>::denorm_min())));
  expectRotation(polarRotation(Matrix3d::Constant(std::numeric_limits<double>::max())));
}

TEST(PolarRotation, NonFiniteInputIsNotHidden) {
  Matrix3d F = Matrix3d::Identity();
  F(1, 2) = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(polarRotation(F).array().isNaN().all());
  F(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(polarRotation(F).array().isNaN().all());
}

TEST(MeanDeformationGradient, IsTheGradientOfALinearMapAnywhere) {
  std::mt19937 generator(6);
  Eigen::Matrix<double, 3, 4> points;
  points << Matrix3d::Identity() + 0.1 * randomMatrix(generator), Vector3d(0.1, 0.2, -0.3);
  Eigen::Matrix4d system;
  system << points, Eigen::RowVector4d::Ones();
  const Eigen::Matrix3Xd gradient = Eigen::Matrix4d(system.inverse()).leftCols<3>().transpose();
  const Matrix3d F = randomMatrix(generator);
  const Eigen::Matrix3Xd moved = (F * points).colwise() + Vector3d(100, -200, 300);
  // 300 m away the positions themselves are rounded to 6e-14.
  EXPECT_LE((meanDeformationGradient(moved, gradient) - F).norm(), 1e-12);
}

}  // namespace
}  // namespace polyscalpel
