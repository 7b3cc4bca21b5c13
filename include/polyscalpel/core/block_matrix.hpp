// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

namespace polyscalpel {

/// Which 3 x 3 blocks of a symmetric matrix are there: one block row and column a vertex, only blocks on and
/// below the diagonal, column by column. Every diagonal block is there, as the first of its column.
struct BlockPattern {
  std::vector<int> column_start = {0};  ///< numVertices() + 1 positions in `row`
  std::vector<int> row;                 ///< block row of each block, >= its column, ascending within a column

  int numVertices() const { return static_cast<int>(column_start.size()) - 1; }
  int numBlocks() const { return static_cast<int>(row.size()); }

  /// Position of the block of vertices i and j (in either order), or -1 where they share no cell. O(log of
  /// the column).
  int find(int i, int j) const;
};

/// Values on a BlockPattern, in its order. The block at (row i, column j) is d f_i / d x_j; the one above the
/// diagonal is its transpose.
using Blocks = std::vector<Eigen::Matrix3d>;

/// y = A x, 3 x n each, one column per vertex. Summed in a fixed order.
Eigen::Matrix3Xd multiply(const BlockPattern& pattern, const Blocks& blocks,
                          const Eigen::Ref<const Eigen::Matrix3Xd>& x);

}  // namespace polyscalpel
