// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/solver_config.hpp"

#include <sstream>
#include <stdexcept>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

namespace {

constexpr double kLargestBudget_ms = 1e6;

void requireBudget(const std::string& name, double budget_ms) {
  if (budget_ms > 0 && budget_ms <= kLargestBudget_ms) return;
  std::ostringstream message;
  message << name << " = " << budget_ms << ": must be finite and in (0, " << kLargestBudget_ms << "]";
  throw std::invalid_argument(message.str());
}

}  // namespace

void validate(const SolverConfig& config) {
  requireInRange("solver.tolerance", config.tolerance, 1e-12, 0.1);
  if (config.error_target) requireInRange("solver.error_target", *config.error_target, 1e-10, 0.1);
  requireIntInRange("solver.max_iterations", config.max_iterations, 1, 100000);
  requireIntInRange("solver.projection", config.projection, 0, 20);
  requireIntInRange("solver.threads", config.threads, 1, 256);
  if (config.step_budget_ms) requireBudget("solver.step_budget_ms", *config.step_budget_ms);
  requireIntInRange("solver.refresh_after_steps", config.refresh_after_steps, 1, 1000000);
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
