// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/core/block_matrix.hpp"

#include <algorithm>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

int BlockPattern::find(int i, int j) const {
  const int column = std::min(i, j), wanted = std::max(i, j);
  POLYSCALPEL_ASSERT(column >= 0 && wanted < numVertices());
  const auto first = row.begin() + column_start[column], last = row.begin() + column_start[column + 1];
  const auto found = std::lower_bound(first, last, wanted);
  return found != last && *found == wanted ? static_cast<int>(found - row.begin()) : -1;
}

Eigen::Matrix3Xd multiply(const BlockPattern& pattern, const Blocks& blocks,
                          const Eigen::Ref<const Eigen::Matrix3Xd>& x) {
  POLYSCALPEL_ASSERT(x.cols() == pattern.numVertices() &&
                     static_cast<int>(blocks.size()) == pattern.numBlocks());
  Eigen::Matrix3Xd y = Eigen::Matrix3Xd::Zero(3, x.cols());
  for (int column = 0; column < pattern.numVertices(); ++column) {
    const int diagonal = pattern.column_start[column];
    y.col(column) += blocks[diagonal] * x.col(column);
    for (int k = diagonal + 1; k < pattern.column_start[column + 1]; ++k) {
      const int row = pattern.row[k];
      y.col(row) += blocks[k] * x.col(column);
      y.col(column) += blocks[k].transpose() * x.col(row);
    }
  }
  return y;
}

}  // namespace polyscalpel
