// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "benchmark/report.hpp"
#include "benchmark/step_runs.hpp"

namespace polyscalpel::report {

/// One solver on one body, run several times.
struct StepEntry {
  const StepBody* body = nullptr;
  StepSolverChoice solver;
  int steps = 0;
  int rounds = 1;
  GateAnswers answers = {};
  std::vector<StepOutcome> outcomes = {};
};

/// Runs the entries in turns, each as often as it says.
void runInTurns(std::vector<StepEntry>& entries);

/// The medians of an entry's runs, once they are there.
Row describeSteps(const StepEntry& entry);

}  // namespace polyscalpel::report
