// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/solve_status.hpp"

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

const char* toString(SolveStatus status) {
  switch (status) {
    case SolveStatus::kSolved:
      return "solved";
    case SolveStatus::kNotPositiveDefinite:
      return "the matrix is not positive definite";
    case SolveStatus::kOutOfMemory:
      return "the factor does not fit into memory";
    case SolveStatus::kNotFinite:
      return "the matrix, the right-hand side or the solution is not finite";
    case SolveStatus::kInaccurate:
      return "the residual is too large";
  }
  POLYSCALPEL_ASSERT(false);
  return "";
}

}  // namespace polyscalpel
