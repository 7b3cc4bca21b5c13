// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/solver_config.hpp"

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

void validate(const SolverConfig& config) {
  requireInRange("solver.tolerance", config.tolerance, 1e-12, 0.1);
  if (config.error_target) requireInRange("solver.error_target", *config.error_target, 1e-10, 0.1);
  requireInRange("solver.max_iterations", config.max_iterations, 1, 100000);
  requireInRange("solver.projection", config.projection, 0, 20);
  requireInRange("solver.threads", config.threads, 1, 256);
  if (config.step_budget_ms) {
    requirePositive("solver.step_budget_ms", *config.step_budget_ms);
    requireInRange("solver.step_budget_ms", *config.step_budget_ms, 0, 1e6);
  }
  requireInRange("solver.refresh_after_steps", config.refresh_after_steps, 1, 1000000);
}

const char* toString(SolverKind kind) {
  switch (kind) {
    case SolverKind::kAuto:
      return "auto";
    case SolverKind::kDirect:
      return "direct";
    case SolverKind::kJacobi:
      return "jacobi";
    case SolverKind::kFactor:
      return "factor";
    case SolverKind::kAggregates:
      return "aggregates";
  }
  POLYSCALPEL_ASSERT(false);
  return "";
}

}  // namespace polyscalpel
