// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace polyscalpel {

/// Which 3 x 3 blocks off the diagonal a symmetric matrix has: one block row a vertex. Rows lie anywhere in
/// one pool, so that a change of the mesh makes anew its own rows only.
struct RowPattern {
  struct Row {
    int first = 0;        ///< the row's entries: [first, first + count)
    int count = 0;        ///< neighbours of the vertex: vertices that share a cell with it
    int first_above = 0;  ///< entries from here on have a column above the row's own index
  };

  std::vector<Row> rows;    ///< one a vertex; empty for a vertex without cells
  std::vector<int> column;  ///< of each entry; ascending within a row
  std::vector<int> mirror;  ///< of each entry: the entry of the transposed block

  int numVertices() const { return static_cast<int>(rows.size()); }
  /// Entries in use or left behind.
  int capacity() const { return static_cast<int>(column.size()); }
  /// The entry of row i and column j, or -1 where they share no cell. O(log of the row).
  int find(int i, int j) const;
};

}  // namespace polyscalpel
