// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/solver/solve_status.hpp"
#include "polyscalpel/solver/symbolic_factor.hpp"

namespace polyscalpel {

/// Where a supernode's panel lies: its columns of L, rows as in SymbolicFactor, 3 numbers each, column by
/// column.
struct PanelPlace {
  std::size_t first_value = 0;
  int leading = 0;  ///< numbers from a column to the next
};

/// Cholesky's factor of a block matrix in the given precision, supernode by supernode: each gathers its
/// columns and what its children have left for it, factors them, and leaves for its parent what they take
/// from the rows below (I. S. Duff, J. K. Reid, "The Multifrontal Solution of Indefinite Sparse Symmetric
/// Linear Equations", ACM Transactions on Mathematical Software 9(3), 1983).
///
/// values: zeros; panels' parts above the diagonal are undefined afterwards. kNotPositiveDefinite: also where
/// less than `smallest_pivot` of a diagonal entry is left to divide by. kNotFinite: of the blocks.
/// Scalar: float or double.
template <class Scalar>
SolveStatus factorMultifrontal(const SymbolicFactor& symbolic, const BlockPattern& pattern,
                               const Blocks& blocks, const std::vector<PanelPlace>& panels,
                               Scalar smallest_pivot, std::vector<Scalar>& values);

extern template SolveStatus factorMultifrontal<float>(const SymbolicFactor&, const BlockPattern&,
                                                      const Blocks&, const std::vector<PanelPlace>&, float,
                                                      std::vector<float>&);
extern template SolveStatus factorMultifrontal<double>(const SymbolicFactor&, const BlockPattern&,
                                                       const Blocks&, const std::vector<PanelPlace>&, double,
                                                       std::vector<double>&);

}  // namespace polyscalpel
