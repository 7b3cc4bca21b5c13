// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/single_factor.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "support/body_system.hpp"
#include "support/random_block_matrix.hpp"
#include "support/small_bodies.hpp"

namespace polyscalpel {
namespace {

constexpr double kRounding = std::numeric_limits<float>::epsilon();

Eigen::Matrix3Xd randomPoints(int size, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::Matrix3Xd points(3, size);
  for (double& number : points.reshaped()) number = uniform(engine);
  return points;
}

Eigen::Matrix3Xd solve(SingleFactor& factor, const Eigen::Matrix3Xd& b) {
  Eigen::Matrix3Xf values = b.cast<float>();
  factor.solve(values.data());
  return values.cast<double>();
}

TEST(SingleFactor, UndoesTheMatrixToSinglePrecision) {
  for (const int size : {1, 2, 7, 60, 150}) {
    const RandomBlockMatrix matrix = makeRandomBlockMatrix(size, 0.2, 3);
    SingleFactor factor;
    EXPECT_TRUE(factor.isEmpty());
    ASSERT_EQ(factor.factorise(matrix.pattern, matrix.blocks, std::vector<bool>(size, false)),
              SolveStatus::kSolved);
    EXPECT_FALSE(factor.isEmpty());

    const Eigen::Matrix3Xd x = randomPoints(size, 4);
    const Eigen::Matrix3Xd found = solve(factor, multiply(matrix.pattern, matrix.blocks, x));
    // The matrix is diagonally dominant: rounding is not made larger.
    EXPECT_LT((found - x).norm(), 4 * kRounding * x.norm()) << size;
  }
}

struct BodyMatrix {
  BlockPattern pattern;
  Blocks blocks;
  std::vector<bool> fixed;
};

BodyMatrix makeBodyMatrix(const PolyhedralMesh& mesh) {
  BodySystem system(mesh);
  DifferenceMatrix<double> matrix;
  system.assembleAtRest(matrix);
  BodyMatrix result{toBlockPattern(system.pattern()), {}, system.fixed()};
  convert(system.pattern(), matrix, result.pattern, result.blocks);
  return result;
}

TEST(SingleFactor, UndoesABodysMatrixBesideFixedVertices) {
  for (const PolyhedralMesh& mesh : {makeTetBeam(4), makePolyhedra()}) {
    const BodyMatrix matrix = makeBodyMatrix(mesh);
    SingleFactor factor;
    ASSERT_EQ(factor.factorise(matrix.pattern, matrix.blocks, matrix.fixed), SolveStatus::kSolved);
    Eigen::Matrix3Xd x = randomPoints(mesh.numVertices(), 5);
    for (int i = 0; i < mesh.numVertices(); ++i) {
      if (matrix.fixed[i]) x.col(i).setZero();
    }
    const Eigen::Matrix3Xd b = multiply(matrix.pattern, matrix.blocks, x);
    Eigen::Matrix3Xd error = solve(factor, b) - x;
    for (int i = 0; i < mesh.numVertices(); ++i) {
      if (!matrix.fixed[i]) continue;
      EXPECT_EQ(solve(factor, b).col(i), b.col(i).cast<float>().cast<double>());  // left alone
      error.col(i).setZero();
    }
    // In the norm of the matrix, where its condition plays no part but by its root.
    const double energy = x.cwiseProduct(b).sum();
    const double error_energy = error.cwiseProduct(multiply(matrix.pattern, matrix.blocks, error)).sum();
    EXPECT_LT(std::sqrt(error_energy / energy), 10 * kRounding);
  }
}

// Springs in a row, held by one a part in 1e8 as stiff: pivots drown in the rounding of single precision.
TEST(SingleFactor, DoubleServesWhereSingleIsNotEnough) {
  constexpr int kSize = 30;
  constexpr double kSoft = 1e-8;
  BlockPattern pattern;
  Blocks blocks;
  for (int i = 0; i < kSize; ++i) {
    const double diagonal = (i > 0 ? 1 : kSoft) + (i + 1 < kSize ? 1 : 0);
    pattern.row.push_back(i);
    blocks.emplace_back(diagonal * Eigen::Matrix3d::Identity());
    if (i + 1 < kSize) {
      pattern.row.push_back(i + 1);
      blocks.emplace_back(-Eigen::Matrix3d::Identity());
    }
    pattern.column_start.push_back(pattern.numBlocks());
  }
  SingleFactor factor;
  ASSERT_EQ(factor.factorise(pattern, blocks, std::vector<bool>(kSize, false)), SolveStatus::kSolved);
  // Pulled together, all move by the soft spring's length.
  const Eigen::Matrix3Xd pull = Eigen::Matrix3Xd::Constant(3, kSize, 1);
  const double length = kSize / kSoft;
  EXPECT_LT((solve(factor, pull).array() - length).abs().maxCoeff(), 1e-4 * length);
}

// A factor is made in the memory of the one before.
TEST(SingleFactor, NothingIsLeftOfAnEarlierFactor) {
  SingleFactor factor;
  const BodyMatrix large = makeBodyMatrix(makeTetBeam(4)), small = makeBodyMatrix(makeTetBeam(2));
  const Eigen::Matrix3Xd b = randomPoints(small.pattern.numVertices(), 12);
  ASSERT_EQ(factor.factorise(small.pattern, small.blocks, small.fixed), SolveStatus::kSolved);
  const Eigen::Matrix3Xd x = solve(factor, b);
  ASSERT_EQ(factor.factorise(large.pattern, large.blocks, large.fixed), SolveStatus::kSolved);
  ASSERT_EQ(factor.factorise(small.pattern, small.blocks, small.fixed), SolveStatus::kSolved);
  EXPECT_EQ(solve(factor, b), x);
}

TEST(SingleFactor, IsSymmetricAndPositive) {
  const PolyhedralMesh mesh = makeTetBeam(2);
  const BodyMatrix matrix = makeBodyMatrix(mesh);
  SingleFactor factor;
  ASSERT_EQ(factor.factorise(matrix.pattern, matrix.blocks, matrix.fixed), SolveStatus::kSolved);
  Eigen::Matrix3Xd x = randomPoints(mesh.numVertices(), 6), y = randomPoints(mesh.numVertices(), 7);
  for (int i = 0; i < mesh.numVertices(); ++i) {
    if (!matrix.fixed[i]) continue;
    x.col(i).setZero();
    y.col(i).setZero();
  }
  const Eigen::Matrix3Xd Bx = solve(factor, x), By = solve(factor, y);
  const double xBx = x.cwiseProduct(Bx).sum(), yBy = y.cwiseProduct(By).sum();
  EXPECT_GT(xBx, 0);
  EXPECT_GT(yBy, 0);
  EXPECT_NEAR(x.cwiseProduct(By).sum(), y.cwiseProduct(Bx).sum(), 10 * kRounding * std::sqrt(xBx * yBy));
}

TEST(SingleFactor, EverythingFixedLeavesAllAsItIs) {
  const RandomBlockMatrix matrix = makeRandomBlockMatrix(4, 0.5, 8);
  SingleFactor factor;
  ASSERT_EQ(factor.factorise(matrix.pattern, matrix.blocks, std::vector<bool>(4, true)),
            SolveStatus::kSolved);
  EXPECT_TRUE(factor.isEmpty());
  const Eigen::Matrix3Xd b = Eigen::Matrix3Xd::Constant(3, 4, 7);
  EXPECT_EQ(solve(factor, b), b);
}

TEST(SingleFactor, SaysWhenTheMatrixIsNotPositiveDefinite) {
  RandomBlockMatrix matrix = makeRandomBlockMatrix(40, 0.2, 9);
  const std::vector<bool> fixed(40, false);
  const int diagonal = matrix.pattern.column_start[17];
  const Eigen::Matrix3d block = matrix.blocks[diagonal];
  matrix.blocks[diagonal](1, 1) = -1;
  SingleFactor factor;
  EXPECT_EQ(factor.factorise(matrix.pattern, matrix.blocks, fixed), SolveStatus::kNotPositiveDefinite);
  EXPECT_TRUE(factor.isEmpty());
  // The next matrix is not the worse for it, and a failure leaves nothing of a factor that was there.
  matrix.blocks[diagonal] = block;
  EXPECT_EQ(factor.factorise(matrix.pattern, matrix.blocks, fixed), SolveStatus::kSolved);
  EXPECT_FALSE(factor.isEmpty());
  matrix.blocks[diagonal](1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(factor.factorise(matrix.pattern, matrix.blocks, fixed), SolveStatus::kNotFinite);
  EXPECT_TRUE(factor.isEmpty());
}

TEST(SingleFactor, SameInputGivesTheSameBits) {
  const BodyMatrix matrix = makeBodyMatrix(makeTetBeam(4));
  SingleFactor factor, other;
  ASSERT_EQ(factor.factorise(matrix.pattern, matrix.blocks, matrix.fixed), SolveStatus::kSolved);
  ASSERT_EQ(other.factorise(matrix.pattern, matrix.blocks, matrix.fixed), SolveStatus::kSolved);
  const Eigen::Matrix3Xd b = randomPoints(matrix.pattern.numVertices(), 10);
  const Eigen::Matrix3Xd x = solve(factor, b);
  solve(other, randomPoints(matrix.pattern.numVertices(), 11));  // leaves nothing behind
  EXPECT_EQ(solve(other, b), x);
  SingleFactor copy = other;
  EXPECT_EQ(solve(copy, b), x);
}

}  // namespace
}  // namespace polyscalpel
