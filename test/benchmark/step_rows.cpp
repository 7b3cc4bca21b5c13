// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/step_rows.hpp"

#include <algorithm>

namespace polyscalpel::report {

void runInTurns(std::vector<StepEntry>& entries) {
  int rounds = 0;
  for (const StepEntry& entry : entries) rounds = std::max(rounds, entry.rounds);
  for (int round = 0; round < rounds; ++round) {
    for (StepEntry& entry : entries)
      if (round < entry.rounds)
        entry.outcomes.push_back(runSteps(*entry.body, entry.solver, entry.steps, entry.answers));
  }
}

Row describeSteps(const StepEntry& entry) {
  const StepBody& body = *entry.body;
  const StepOutcome outcome = medianOutcome(entry.outcomes);
  const bool is_ours = entry.solver.name != "bullet";
  Row row;
  row["body"] = body.name;
  row["solver"] = entry.solver.name;
  row["threads"] = entry.solver.threads;
  row["cells"] = body.mesh.numCells();
  row["unknowns"] = 3 * static_cast<int>(std::count(body.fixed.begin(), body.fixed.end(), false));
  row["steps"] = entry.steps;
  row["rounds"] = entry.rounds;
  if (!outcome.failure.empty()) {
    holdFailed(row, outcome.failure);
    return row;
  }
  row["step_ms"] = outcome.step_ms;
  row["us_per_unknown"] = 1e3 * outcome.step_ms / row["unknowns"].get<int>();
  row["first_ms"] = outcome.first_ms;
  if (entry.steps >= kGateSteps.front()) row["gate_error"] = outcome.gate_error;
  row["memory_mb"] = outcome.memory_mb;
  if (!is_ours) return row;
  row["solved_by"] = toString(outcome.solver.kind);
  row["reason"] = outcome.solver.reason;
  row["iterations"] = outcome.iterations;
  row["fallbacks"] = outcome.fallbacks;
  row["residual"] = outcome.residual;
  row["assembly_ms"] = outcome.assembly_ms;
  row["solve_ms"] = outcome.solve_ms;
  return row;
}

}  // namespace polyscalpel::report
