// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/direct_solver.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "polyscalpel/core/types.hpp"
#include "support/random_block_matrix.hpp"

namespace polyscalpel {
namespace {

TEST(DirectSolver, AgreesWithADenseSolver) {
  for (const int size : {1, 2, 7, 60}) {
    const RandomBlockMatrix matrix = makeRandomBlockMatrix(size, 0.2, 3);
    const Eigen::Matrix3Xd b = Eigen::Matrix3Xd::Random(3, size);
    DirectSolver solver;
    ASSERT_EQ(solver.analyse(matrix.pattern, std::vector<bool>(size, false)), SolveStatus::kSolved);
    EXPECT_FALSE(solver.hasFactor());
    ASSERT_EQ(solver.factorise(matrix.pattern, matrix.blocks), SolveStatus::kSolved);
    EXPECT_TRUE(solver.hasFactor());
    Eigen::Matrix3Xd x;
    const SolveResult result = solver.solve(b, x);
    EXPECT_EQ(result.status, SolveStatus::kSolved);
    EXPECT_LT(result.relative_residual, 1e-13);
    const Eigen::VectorXd expected = matrix.dense.llt().solve(Eigen::VectorXd(b.reshaped()));
    EXPECT_LT((x.reshaped() - expected).norm(), 1e-12 * expected.norm()) << size;
  }
}

TEST(DirectSolver, FixedVerticesDropOut) {
  const int size = 30;
  const RandomBlockMatrix matrix = makeRandomBlockMatrix(size, 0.2, 4);
  std::vector<bool> fixed(size, false);
  std::vector<int> free_dofs;
  for (int i = 0; i < size; ++i) {
    fixed[i] = i % 4 == 0 || i == size - 1;
    for (int c = 0; c < 3 && !fixed[i]; ++c) free_dofs.push_back(3 * i + c);
  }
  Eigen::Matrix3Xd b = Eigen::Matrix3Xd::Random(3, size);
  const Eigen::VectorXd b_free = b.reshaped()(free_dofs);
  for (int i = 0; i < size; ++i) {
    if (fixed[i]) b.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());  // not looked at
  }
  DirectSolver solver;
  ASSERT_EQ(solver.analyse(matrix.pattern, fixed), SolveStatus::kSolved);
  ASSERT_EQ(solver.factorise(matrix.pattern, matrix.blocks), SolveStatus::kSolved);
  Eigen::Matrix3Xd x;
  ASSERT_EQ(solver.solve(b, x).status, SolveStatus::kSolved);
  const Eigen::VectorXd expected = matrix.dense(free_dofs, free_dofs).llt().solve(b_free);
  EXPECT_LT((x.reshaped()(free_dofs) - expected).norm(), 1e-12 * expected.norm());
  for (int i = 0; i < size; ++i) {
    if (fixed[i]) {
      EXPECT_TRUE(x.col(i).isZero(0));
    }
  }
}

TEST(DirectSolver, EverythingFixedIsSolvedByZero) {
  const RandomBlockMatrix matrix = makeRandomBlockMatrix(3, 0.5, 5);
  DirectSolver solver;
  ASSERT_EQ(solver.analyse(matrix.pattern, std::vector<bool>(3, true)), SolveStatus::kSolved);
  ASSERT_EQ(solver.factorise(matrix.pattern, matrix.blocks), SolveStatus::kSolved);
  Eigen::Matrix3Xd x;
  EXPECT_EQ(solver.solve(Eigen::Matrix3Xd::Ones(3, 3), x).status, SolveStatus::kSolved);
  EXPECT_TRUE(x.isZero(0));
}

TEST(DirectSolver, NoLoadHasNoSolutionButZero) {
  const RandomBlockMatrix matrix = makeRandomBlockMatrix(5, 0.5, 6);
  DirectSolver solver;
  ASSERT_EQ(solver.analyse(matrix.pattern, std::vector<bool>(5, false)), SolveStatus::kSolved);
  ASSERT_EQ(solver.factorise(matrix.pattern, matrix.blocks), SolveStatus::kSolved);
  Eigen::Matrix3Xd x;
  const SolveResult result = solver.solve(Eigen::Matrix3Xd::Zero(3, 5), x);
  EXPECT_EQ(result.status, SolveStatus::kSolved);
  EXPECT_EQ(result.relative_residual, 0);
  EXPECT_TRUE(x.isZero(0));
}

TEST(DirectSolver, SaysWhenTheMatrixIsNotPositiveDefinite) {
  RandomBlockMatrix matrix = makeRandomBlockMatrix(40, 0.2, 7);
  matrix.blocks[matrix.pattern.column_start[17]](1, 1) = -1;
  DirectSolver solver;
  ASSERT_EQ(solver.analyse(matrix.pattern, std::vector<bool>(40, false)), SolveStatus::kSolved);
  EXPECT_EQ(solver.factorise(matrix.pattern, matrix.blocks), SolveStatus::kNotPositiveDefinite);
  EXPECT_FALSE(solver.hasFactor());
  // The next matrix is not the worse for it.
  matrix.blocks[matrix.pattern.column_start[17]](1, 1) = 1000;
  EXPECT_EQ(solver.factorise(matrix.pattern, matrix.blocks), SolveStatus::kSolved);
}

TEST(DirectSolver, SaysWhenInputIsNotFinite) {
  RandomBlockMatrix matrix = makeRandomBlockMatrix(10, 0.5, 8);
  DirectSolver solver;
  ASSERT_EQ(solver.analyse(matrix.pattern, std::vector<bool>(10, false)), SolveStatus::kSolved);
  for (const double bad : {kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    Blocks blocks = matrix.blocks;
    blocks.back()(2, 1) = bad;
    EXPECT_EQ(solver.factorise(matrix.pattern, blocks), SolveStatus::kNotFinite);
    ASSERT_EQ(solver.factorise(matrix.pattern, matrix.blocks), SolveStatus::kSolved);
    Eigen::Matrix3Xd b = Eigen::Matrix3Xd::Ones(3, 10), x;
    b(1, 4) = bad;
    EXPECT_EQ(solver.solve(b, x).status, SolveStatus::kNotFinite);
    EXPECT_TRUE(x.isZero(0));
  }
}

TEST(DirectSolver, SaysWhenTheSolutionOverflows) {
  RandomBlockMatrix matrix = makeRandomBlockMatrix(10, 0.5, 9);
  for (Eigen::Matrix3d& block : matrix.blocks) block *= 1e-200;
  DirectSolver solver;
  ASSERT_EQ(solver.analyse(matrix.pattern, std::vector<bool>(10, false)), SolveStatus::kSolved);
  ASSERT_EQ(solver.factorise(matrix.pattern, matrix.blocks), SolveStatus::kSolved);
  Eigen::Matrix3Xd x;
  EXPECT_EQ(solver.solve(Eigen::Matrix3Xd::Constant(3, 10, 1e200), x).status, SolveStatus::kNotFinite);
  EXPECT_TRUE(x.isZero(0));
}

// Chains of springs whose stiffnesses alternate over some orders of magnitude, as slivers make them. What is
// said about the residual is true, and a solution is given only where it is small.
TEST(DirectSolver, TellsTheTrueResidualOfABadlyConditionedMatrix) {
  const int size = 200;
  for (const int orders : {3, 6, 12, 18}) {
    BlockPattern pattern;
    Blocks blocks;
    const auto stiffness = [&](int i) { return std::pow(10.0, orders * (i * 7 % 13) / 12.0); };
    for (int column = 0; column < size; ++column) {
      pattern.row.push_back(column);
      blocks.push_back((stiffness(column) + stiffness(column + 1)) * Eigen::Matrix3d::Identity());
      if (column + 1 < size) {
        pattern.row.push_back(column + 1);
        blocks.push_back(-stiffness(column + 1) * Eigen::Matrix3d::Identity());
      }
      pattern.column_start.push_back(static_cast<int>(pattern.row.size()));
    }
    DirectSolver solver;
    ASSERT_EQ(solver.analyse(pattern, std::vector<bool>(size, false)), SolveStatus::kSolved);
    const SolveStatus factored = solver.factorise(pattern, blocks);
    if (factored != SolveStatus::kSolved) {  // so near to singular that rounding decides
      EXPECT_EQ(factored, SolveStatus::kNotPositiveDefinite);
      EXPECT_EQ(orders, 18);
      continue;
    }
    const Eigen::Matrix3Xd b = Eigen::Matrix3Xd::Random(3, size);
    Eigen::Matrix3Xd x;
    const SolveResult result = solver.solve(b, x);
    EXPECT_TRUE(result.refinements == 1 || result.relative_residual <= DirectSolver::kRefinedResidual);
    if (result.relative_residual <= DirectSolver::kLargestResidual) {
      EXPECT_EQ(result.status, SolveStatus::kSolved);
      const double residual = (multiply(pattern, blocks, x) - b).norm() / b.norm();
      EXPECT_NEAR(result.relative_residual, residual, 0.5 * residual + 1e-12);
    } else {
      EXPECT_EQ(result.status, SolveStatus::kInaccurate);
      EXPECT_TRUE(x.isZero(0));
    }
    if (orders == 3) {
      EXPECT_EQ(result.status, SolveStatus::kSolved);
    }
    if (orders == 18) {
      EXPECT_NE(result.status, SolveStatus::kSolved);
    }
  }
}

TEST(DirectSolver, SameInputGivesTheSameBits) {
  const RandomBlockMatrix matrix = makeRandomBlockMatrix(150, 0.1, 10);
  const Eigen::Matrix3Xd b = Eigen::Matrix3Xd::Random(3, 150);
  Eigen::Matrix3Xd first, again, from_new, x;
  DirectSolver solver;
  ASSERT_EQ(solver.analyse(matrix.pattern, std::vector<bool>(150, false)), SolveStatus::kSolved);
  ASSERT_EQ(solver.factorise(matrix.pattern, matrix.blocks), SolveStatus::kSolved);
  solver.solve(b, first);
  solver.solve(Eigen::Matrix3Xd::Ones(3, 150), x);
  ASSERT_EQ(solver.analyse(matrix.pattern, std::vector<bool>(150, false)), SolveStatus::kSolved);
  ASSERT_EQ(solver.factorise(matrix.pattern, matrix.blocks), SolveStatus::kSolved);
  solver.solve(b, again);
  DirectSolver other;
  ASSERT_EQ(other.analyse(matrix.pattern, std::vector<bool>(150, false)), SolveStatus::kSolved);
  ASSERT_EQ(other.factorise(matrix.pattern, matrix.blocks), SolveStatus::kSolved);
  DirectSolver moved = std::move(other);
  moved.solve(b, from_new);
  EXPECT_EQ(first, again);
  EXPECT_EQ(first, from_new);
}

}  // namespace
}  // namespace polyscalpel
