// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "polyscalpel/solver/solver_config.hpp"

namespace polyscalpel {

/// How a step's last system was solved.
struct SolverReport {
  SolverKind kind = SolverKind::kDirect;  ///< what solved it, never kAuto
  std::string reason;                     ///< why it was this one: one sentence
  bool is_single = false;                 ///< matrix and iteration in single precision
  int iterations = 0;                     ///< conjugate gradients of all solves of the step; 0 for kDirect
  /// Estimated |x - A^-1 b| / |x| in the norm of A; 0 for kDirect.
  double estimated_error = 0;
  bool budget_ended = false;  ///< SolverConfig::step_budget_ms ended it before its tolerance was reached
  int fallbacks = 0;          ///< solvers that were tried in vain before this one
};

}  // namespace polyscalpel
