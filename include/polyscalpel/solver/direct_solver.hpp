// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/block_matrix.hpp"

namespace polyscalpel {

enum class SolveStatus {
  kSolved,
  kNotPositiveDefinite,  ///< the matrix is singular, indefinite, or so near to it that rounding decides
  kOutOfMemory,          ///< or too large for 32-bit indices
  kNotFinite,            ///< an infinity or NaN in the matrix, the right-hand side or the solution
  kInaccurate,           ///< the residual stays above DirectSolver::kLargestResidual after refinement
};

/// One sentence for a user.
const char* toString(SolveStatus status);

struct SolveResult {
  SolveStatus status = SolveStatus::kSolved;
  double relative_residual = 0;  ///< |A x - b| / |b| over the free vertices; 0 for b = 0
  int refinements = 0;           ///< steps of iterative refinement taken, 0 or 1
};

/// A factor L of P A P^T as dense panels, one a supernode: columns that have the same rows.
struct FactorPanels {
  struct Supernode {
    int first_column = 0, num_columns = 0, num_rows = 0;
    const int* rows = nullptr;  ///< num_rows, ascending; first the columns themselves
    double* values = nullptr;   ///< num_rows x num_columns, column by column; the part above the diagonal is
                                ///< undefined
  };
  std::vector<Supernode> supernodes;
  std::vector<int> places;  ///< of each row of L: its dof, 3 a vertex, fixed ones counted
};

/// Sparse Cholesky factorisation (CHOLMOD, supernodal) of a symmetric block matrix without the rows and
/// columns of fixed vertices. Fill-reducing ordering and symbolic analysis once a pattern, numeric factor
/// once a matrix. Same input, same bits: BLAS is held to one thread, for the whole process.
class DirectSolver {
 public:
  /// A residual above this is refined once.
  static constexpr double kRefinedResidual = 1e-10;
  /// A residual above this after refinement is no solution.
  static constexpr double kLargestResidual = 1e-6;

  DirectSolver();
  ~DirectSolver();
  DirectSolver(DirectSolver&&) noexcept;
  DirectSolver& operator=(DirectSolver&&) noexcept;

  /// Orders and analyses a pattern. The first one decides between two kinds of orderings for all later ones.
  /// fixed: one flag a vertex. Forgets any factor.
  SolveStatus analyse(const BlockPattern& pattern, const std::vector<bool>& fixed);
  /// The same with a given order of elimination: all vertices that are not fixed, each once.
  SolveStatus analyse(const BlockPattern& pattern, const std::vector<bool>& fixed,
                      const std::vector<int>& order);

  /// Factors the matrix on the pattern last analysed. Keeps the matrix, for residuals.
  SolveStatus factorise(const BlockPattern& pattern, const Blocks& blocks);

  /// Solves A x = b with the last factor, which must be there. b: 3 x n, columns of fixed vertices are not
  /// looked at. x: 3 x n, zero at fixed vertices; zero everywhere unless the status is kSolved.
  SolveResult solve(const Eigen::Ref<const Eigen::Matrix3Xd>& b, Eigen::Matrix3Xd& x);

  /// Numbers in the panels that factorise() will fill, once the pattern is analysed.
  std::size_t factorSize() const;

  /// The factor, which must be there: the solver's own numbers, gone when it factors or analyses again.
  /// Nothing is to be solved for with them once they have been changed.
  FactorPanels panels();

  /// Whether the last factorise() succeeded and no analyse() followed.
  bool hasFactor() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace polyscalpel
