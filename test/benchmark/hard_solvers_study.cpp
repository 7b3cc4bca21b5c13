// SPDX-License-Identifier: BSD-3-Clause
//
// What each solver of ours makes of motions that are hard on it.
#include <algorithm>
#include <exception>

#include "benchmark/hard_motions.hpp"
#include "benchmark/report.hpp"
#include "benchmark/step_runs.hpp"

namespace polyscalpel::report {
namespace {

/// Of a motion that has one way to go; the second where we lose.
constexpr double kLargestDeviation = 1e-3, kLargestWhereWeLose = 1e-2;
/// The direct solver is what the others are compared with.
constexpr double kResidualOfDirect = 1e-10;

/// A run, step by step.
struct HardRun {
  StepOutcome outcome;
  std::vector<Eigen::Matrix3Xd> positions;
  std::vector<int> iterations;
  int half_steps = 0;
};

HardRun runMotion(const HardMotion& motion, const std::string& solver) {
  HardRun run;
  run.outcome = runSteps(motion.body, ours(solver), motion.steps, GateAnswers{}, [&](const Stepper& stepper) {
    run.positions.push_back(stepper.positions());
    run.iterations.push_back(stepper.result().solver.iterations);
    run.half_steps += stepper.result().half_steps;
  });
  return run;
}

/// Farthest that a run lies from another after the same step, over the longest way of that from rest; in the
/// norm over all vertices.
double largestDeviation(const HardMotion& motion, const HardRun& run, const HardRun& reference) {
  const Eigen::Matrix3Xd rest = motion.body.mesh.restPositions();
  double farthest = 0, longest = motion.body.start ? (*motion.body.start - rest).norm() : 0;
  for (std::size_t step = 0; step < run.positions.size(); ++step) {
    const double deviation = (run.positions[step] - reference.positions[step]).norm();
    farthest = deviation <= farthest ? farthest : deviation;  // not a number stays
    longest = std::max(longest, (reference.positions[step] - rest).norm());
  }
  return farthest / longest;
}

void describe(const HardMotion& motion, const HardRun& run, const HardRun& reference, Row& row) {
  const Eigen::Matrix3Xd& end = run.positions.back();
  double iterations = 0;
  for (const int of_step : run.iterations) iterations += of_step;
  row["solved_by"] = toString(run.outcome.solver.kind);
  row["iterations"] = iterations / motion.steps;
  row["most_iterations"] = *std::max_element(run.iterations.begin(), run.iterations.end());
  row["fallbacks"] = run.outcome.fallbacks;
  row["half_steps"] = run.half_steps;
  row["residual"] = run.outcome.residual;
  row["not_finite"] = static_cast<int>(end.size() - end.array().isFinite().count());
  row["inverted_at_start"] = motion.body.start ? countInverted(motion.body, *motion.body.start) : 0;
  row["inverted_at_end"] = countInverted(motion.body, end);
  row["quantity"] = motion.quantity;
  row["value"] = motion.value(motion.body, end);
  row["bound"] = motion.bound;
  holdEqual(row, "not_finite", 0);
  holdAtMost(row, "value", motion.bound);
  if (&run == &reference) {
    holdAtMost(row, "residual", kResidualOfDirect);
  } else {
    row["deviation"] = largestDeviation(motion, run, reference);
    if (motion.is_chaotic.empty())
      holdAtMost(row, "deviation", motion.we_lose.empty() ? kLargestDeviation : kLargestWhereWeLose);
  }
  // What a scene gets by default finds its way without a second try.
  if (row["solver"] == "auto" && motion.we_lose.empty()) holdEqual(row, "fallbacks", 0);
  row["step_ms"] = run.outcome.step_ms;
  row["note"] = motion.we_lose.empty() ? motion.is_chaotic : "we lose: " + motion.we_lose;
}

Rows studyMotion(const std::string& name, const HardMotion& motion) {
  Rows rows;
  const HardRun direct = runMotion(motion, "direct");
  const auto add = [&](const std::string& solver, const HardRun& run) {
    Row row;
    row["case"] = name;
    row["solver"] = solver;
    row["steps"] = motion.steps;
    row["time_step_s"] = motion.body.time_step_s;
    row["cells"] = motion.body.mesh.numCells();
    row["unknowns"] =
        3 * static_cast<int>(std::count(motion.body.fixed.begin(), motion.body.fixed.end(), false));
    if (!run.outcome.failure.empty()) {
      holdFailed(row, run.outcome.failure);
    } else if (!direct.outcome.failure.empty()) {
      holdFailed(row, "there is nothing to compare with");
    } else {
      describe(motion, run, direct, row);
    }
    rows.push_back(std::move(row));
  };
  add("direct", direct);
  for (const std::string solver : {"factor", "aggregates", "jacobi", "auto"})
    add(solver, runMotion(motion, solver));
  return rows;
}

}  // namespace

Rows studyHardSolvers(const Context& context) {
  const std::vector<HardMotionEntry> entries = hardMotions();
  context.progress->beginSection("hard solvers", static_cast<int>(entries.size()));
  Rows rows;
  for (const HardMotionEntry& entry : entries) {
    context.progress->beginTask(entry.name);
    try {
      const Rows more = studyMotion(entry.name, entry.make(context));
      rows.insert(rows.end(), more.begin(), more.end());
    } catch (const std::exception& error) {  // the other motions' rows are not lost
      Row row;
      row["case"] = entry.name;
      holdFailed(row, error.what());
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace polyscalpel::report
