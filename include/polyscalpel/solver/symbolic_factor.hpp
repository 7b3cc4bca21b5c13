// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/solver/solve_status.hpp"

namespace polyscalpel {

/// Two kinds of orders of elimination that keep a factor sparse.
enum class Ordering { kUndecided, kMinimumDegree, kNestedDissection };

/// Where the Cholesky factor L of a symmetric block matrix without the rows and columns of fixed vertices has
/// blocks, row and column a vertex in order of elimination. Columns that have (nearly) the same rows form a
/// supernode.
struct SymbolicFactor {
  struct Supernode {
    int first_column = 0, num_columns = 0;
    int first_row = 0, num_rows = 0;  ///< in `rows`: below the diagonal block
  };
  std::vector<int> order;             ///< the vertex of each row and column
  std::vector<Supernode> supernodes;  ///< in postorder; the parent of one has its first row among its columns
  std::vector<int> rows;              ///< rows of L, ascending within a supernode

  /// Numbers in the supernodes' columns.
  std::size_t numValues() const;
};

/// Orders and analyses (CHOLMOD). fixed: one flag a vertex. ordering: if undecided, the better one of the two
/// is found, which takes five times as long, and written there.
SolveStatus analyse(const BlockPattern& pattern, const std::vector<bool>& fixed, Ordering& ordering,
                    SymbolicFactor& factor);

}  // namespace polyscalpel
