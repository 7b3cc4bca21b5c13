// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace polyscalpel
