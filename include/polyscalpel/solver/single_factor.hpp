// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/solver/direct_solver.hpp"

namespace polyscalpel {

/// A sparse Cholesky factor in single precision, for preconditioners: half the memory to go through, and a
/// solve that is nothing but products with dense panels. With the diagonal block L11 of a supernode and what
/// is below it, L21, a panel holds L11^-1 and L21 L11^-1: then going down is
///   y = L11^-1 b,  b_below -= L21 L11^-1 b,
/// and going up x = L11^-T y - (L21 L11^-1)^T x_below, one product each.
class SingleFactor {
 public:
  static constexpr std::size_t kAnySize = std::numeric_limits<std::size_t>::max();

  /// Orders, analyses and factors (CHOLMOD, in double precision). fixed: one flag a vertex. most_values: a
  /// factor of more numbers is not made, kOutOfMemory. order: vertices in the order to eliminate them, all
  /// that are not fixed, each once; empty: a good one is found, which takes a third of the time.
  SolveStatus factorise(const BlockPattern& pattern, const Blocks& blocks, const std::vector<bool>& fixed,
                        std::size_t most_values = kAnySize, const std::vector<int>& order = {});

  /// x = A^-1 b in place; 3 numbers a vertex, those of fixed ones are left alone. Allocates nothing; not for
  /// two threads at once.
  void solve(float* values);

  /// Vertices in the order in which they were eliminated, without fixed ones.
  std::vector<int> order() const;
  bool isEmpty() const { return places_.empty(); }
  /// Numbers in the panels.
  std::size_t numValues() const { return values_.size(); }

 private:
  struct Supernode {
    int first_column = 0, num_columns = 0;
    int first_row = 0, num_rows = 0;  // in rows_: below the diagonal block
    int leading = 0, padded_columns = 0;
    std::size_t first_value = 0;
  };
  void takePanel(const FactorPanels::Supernode& given, const Supernode& node);

  std::vector<Supernode> supernodes_;
  std::vector<int> rows_;
  std::vector<float> values_;
  std::vector<int> places_;  // of each permuted unknown among 3 numbers a vertex
  std::vector<float> permuted_, column_room_, row_room_;
};

}  // namespace polyscalpel
