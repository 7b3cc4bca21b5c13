// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/core/block_matrix.hpp"

#include <gtest/gtest.h>

#include "support/random_block_matrix.hpp"

namespace polyscalpel {
namespace {

TEST(BlockMatrix, FindsEveryBlockInEitherOrderAndNoOther) {
  const RandomBlockMatrix matrix = makeRandomBlockMatrix(12, 0.3, 1);
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 12; ++j) {
      const int block = matrix.pattern.find(i, j);
      EXPECT_EQ(block, matrix.pattern.find(j, i));
      const Eigen::Matrix3d dense = matrix.dense.block<3, 3>(3 * std::max(i, j), 3 * std::min(i, j));
      if (block < 0) {
        EXPECT_TRUE(dense.isZero(0));
      } else {
        EXPECT_EQ(dense, matrix.blocks[block]);
      }
    }
  }
}

TEST(BlockMatrix, MultipliesAsTheDenseMatrix) {
  const RandomBlockMatrix matrix = makeRandomBlockMatrix(20, 0.2, 2);
  const Eigen::Matrix3Xd x = Eigen::Matrix3Xd::Random(3, 20);
  const Eigen::VectorXd expected = matrix.dense * x.reshaped();
  EXPECT_LT((multiply(matrix.pattern, matrix.blocks, x).reshaped() - expected).norm(),
            1e-13 * expected.norm());
}

}  // namespace
}  // namespace polyscalpel
