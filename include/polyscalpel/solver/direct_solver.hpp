// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/solver/solve_status.hpp"

namespace polyscalpel {

struct SolveResult {
  SolveStatus status = SolveStatus::kSolved;
  double relative_residual = 0;  ///< |A x - b| / |b| over the free vertices; 0 for b = 0
  int refinements = 0;           ///< steps of iterative refinement taken, 0 or 1
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
  /// Factors the matrix on the pattern last analysed. Keeps the matrix, for residuals.
  SolveStatus factorise(const BlockPattern& pattern, const Blocks& blocks);

  /// Solves A x = b with the last factor, which must be there. b: 3 x n, columns of fixed vertices are not
  /// looked at. x: 3 x n, zero at fixed vertices; zero everywhere unless the status is kSolved.
  SolveResult solve(const Eigen::Ref<const Eigen::Matrix3Xd>& b, Eigen::Matrix3Xd& x);

  /// Whether the last factorise() succeeded and no analyse() followed.
  bool hasFactor() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace polyscalpel
