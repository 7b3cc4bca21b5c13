// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <random>

#include <Eigen/Core>

#include "polyscalpel/core/block_matrix.hpp"

namespace polyscalpel {

/// A symmetric positive definite block matrix, sparse and dense.
struct RandomBlockMatrix {
  BlockPattern pattern;
  Blocks blocks;
  Eigen::MatrixXd dense;
};

/// density: part of the pairs of vertices that have a block. Diagonally dominant.
inline RandomBlockMatrix makeRandomBlockMatrix(int num_vertices, double density, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  RandomBlockMatrix matrix;
  matrix.dense.setZero(3 * num_vertices, 3 * num_vertices);
  for (int column = 0; column < num_vertices; ++column) {
    for (int row = column; row < num_vertices; ++row) {
      if (row != column && uniform(engine) > 2 * density - 1) continue;
      Eigen::Matrix3d block;
      for (double& entry : block.reshaped()) entry = uniform(engine);
      if (row == column)
        block = block + block.transpose().eval() + 6.0 * num_vertices * Eigen::Matrix3d::Identity();
      matrix.pattern.row.push_back(row);
      matrix.blocks.push_back(block);
      matrix.dense.block<3, 3>(3 * row, 3 * column) = block;
      matrix.dense.block<3, 3>(3 * column, 3 * row) = block.transpose();
    }
    matrix.pattern.column_start.push_back(static_cast<int>(matrix.pattern.row.size()));
  }
  return matrix;
}

}  // namespace polyscalpel
