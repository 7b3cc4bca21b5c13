// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/solver/solve_status.hpp"
#include "polyscalpel/solver/symbolic_factor.hpp"

namespace polyscalpel {

/// A sparse Cholesky factor in single precision, for preconditioners: half the memory to go through, and a
/// solve that is nothing but products with dense panels. With the diagonal block L11 of a supernode and what
/// is below it, L21, a panel holds L11^-1 and L21 L11^-1: then going down is
///   y = L11^-1 b,  b_below -= L21 L11^-1 b,
/// and going up x = L11^-T y - (L21 L11^-1)^T x_below, one product each.
class SingleFactor {
 public:
  /// Orders, analyses and factors in single precision, where that is not enough in double. fixed: one flag a
  /// vertex. Empty unless the status is kSolved.
  SolveStatus factorise(const BlockPattern& pattern, const Blocks& blocks, const std::vector<bool>& fixed,
                        Ordering ordering = Ordering::kUndecided);
  /// The same with the analysis given.
  SolveStatus factorise(SymbolicFactor symbolic, const BlockPattern& pattern, const Blocks& blocks);

  /// x = A^-1 b in place; 3 numbers a vertex, those of fixed ones are left alone. Allocates nothing; not for
  /// two threads at once.
  void solve(float* values);

  bool isEmpty() const { return order_.empty(); }
  /// Numbers in the panels.
  std::size_t numValues() const { return values_.size(); }

 private:
  struct Supernode {
    int first_column = 0, num_columns = 0;  // unknowns
    int first_row = 0, num_rows = 0;        // the first one's vertex in rows_; below the diagonal block
    int leading = 0, padded_columns = 0;
    std::size_t first_value = 0;
  };
  template <class Scalar>
  SolveStatus fill(const SymbolicFactor& symbolic, const BlockPattern& pattern, const Blocks& blocks,
                   Scalar smallest_pivot, std::vector<Scalar>& values);
  template <class Scalar>
  static void invertDiagonal(const Supernode& node, Scalar* panel, std::vector<Scalar>& room);

  std::vector<Supernode> supernodes_;
  std::vector<int> rows_;  // places of vertices
  std::vector<float> values_;
  std::vector<int> order_;  // the vertex of each place
  std::vector<float> permuted_, column_room_, row_room_;
};

}  // namespace polyscalpel
