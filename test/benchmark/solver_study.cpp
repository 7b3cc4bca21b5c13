// SPDX-License-Identifier: BSD-3-Clause
//
// What a step costs by each solver, at which error; and how that grows with the body.
#include <algorithm>
#include <cmath>
#include <exception>

#include "benchmark/report.hpp"
#include "benchmark/step_rows.hpp"

namespace polyscalpel::report {
namespace {

/// The error that every solver of ours keeps.
constexpr double kGate = 1e-4;

Row missingRow(const std::string& body, const std::string& why) {
  Row row;
  row["body"] = body;
  row["solver"] = "not measured";
  row["note"] = why;
  return row;
}

Rows studySubject(const StepSubject& subject, const Context& context) {
  if (!subject.make) return {missingRow(subject.name, subject.missing)};
  const StepBody body = subject.make();
  const int steps = kGateSteps.back(), rounds = context.byMode(1, 3, 5);
  const GateAnswers answers = gateAnswers(body, steps);
  std::vector<StepEntry> entries;
  for (const StepSolverChoice& solver :
       {ours("direct"), ours("factor"), ours("aggregates"), ours("auto"), ours("auto", 2), bullet()})
    if (solver.start) entries.push_back({&body, solver, steps, rounds, answers});
  // Once: where diagonal blocks alone need more iterations than are allowed, each step takes long.
  entries.push_back({&body, ours("jacobi"), steps, 1, answers});
  runInTurns(entries);
  Rows rows;
  for (const StepEntry& entry : entries) {
    Row row = describeSteps(entry);
    if (entry.solver.name != "bullet") holdAtMost(row, "gate_error", kGate);
    rows.push_back(std::move(row));
  }
  if (!bullet().start) {
    Row row =
        missingRow(body.name, "Bullet's headers and libraries were not there when the report was built");
    row["solver"] = "bullet";
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Slope of log time against log cells, least squares, over the rows from 40,000 cells on.
void addExponent(const std::string& family, Rows& rows) {
  constexpr int kFewestCells = 40000;
  std::vector<double> x, y;
  for (const Row& row : rows) {
    if (row["solver"] != "auto" || row["cells"] < kFewestCells || !row.contains("step_ms")) continue;
    x.push_back(std::log(row["cells"].get<double>()));
    y.push_back(std::log(row["step_ms"].get<double>()));
  }
  if (x.size() < 2) return;
  const Eigen::Map<Eigen::VectorXd> cells(x.data(), static_cast<Eigen::Index>(x.size()));
  const Eigen::Map<Eigen::VectorXd> times(y.data(), static_cast<Eigen::Index>(y.size()));
  const Eigen::VectorXd off = cells.array() - cells.mean();
  Row row;
  row["family"] = family;
  row["body"] = family + "s from " + std::to_string(kFewestCells) + " cells on";
  row["exponent"] = off.dot(times) / off.squaredNorm();
  rows.push_back(std::move(row));
}

Rows scaleFamily(const std::string& family, const std::vector<StepBody>& bodies, const Context& context) {
  // Direct factors of larger bodies take seconds a step.
  constexpr int kMostCellsToFactor = 50000, kSteps = 20, kStepsOfLarge = 10;
  const int rounds = context.byMode(1, 3, 5);
  std::vector<StepEntry> entries;
  for (const StepBody& body : bodies) {
    const bool is_large = body.mesh.numCells() > kMostCellsToFactor;
    const int steps = is_large ? kStepsOfLarge : kSteps;
    const GateAnswers answers = is_large ? GateAnswers{} : gateAnswers(body, steps);
    entries.push_back({&body, ours("auto"), steps, rounds, answers});
    if (is_large || context.mode == Mode::kQuick) continue;
    entries.push_back({&body, ours("direct"), steps, 1, answers});
  }
  runInTurns(entries);
  Rows rows;
  for (const StepEntry& entry : entries) {
    Row row;
    row["family"] = family;
    row.update(describeSteps(entry));
    if (entry.body->mesh.numCells() > kMostCellsToFactor)
      row.erase("gate_error");  // nothing to compare with
    else
      holdAtMost(row, "gate_error", kGate);
    rows.push_back(std::move(row));
  }
  addExponent(family, rows);
  return rows;
}

void append(Rows& rows, const Rows& more) {
  rows.insert(rows.end(), more.begin(), more.end());
}

}  // namespace

Rows studySolvers(const Context& context) {
  std::vector<StepSubject> subjects = knownSubjects(context.meshes_folder);
  const int beam = context.byMode(4, 8, 8), ball = context.byMode(3, 6, 10);
  subjects.push_back({"beam", [beam] { return makeTetBeam(beam); }, {}});
  subjects.push_back({"ball", [ball] { return makeStepBall(ball); }, {}});
  context.progress->beginSection("solvers", static_cast<int>(subjects.size()));
  Rows rows;
  for (const StepSubject& subject : subjects) {
    context.progress->beginTask(subject.name);
    try {
      append(rows, studySubject(subject, context));
    } catch (const std::exception& error) {  // the other bodies' rows are not lost
      Row row = missingRow(subject.name, error.what());
      holdFailed(row, error.what());
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

Rows studyScaling(const Context& context) {
  const std::vector<int> beams = context.byMode<std::vector<int>>({8, 13}, {8, 13, 19, 23}, {8, 13, 19, 23});
  const std::vector<int> balls = context.byMode<std::vector<int>>({6, 10}, {6, 10, 15, 18}, {6, 10, 15, 18});
  context.progress->beginSection("scaling", 2);
  Rows rows;
  const auto study = [&](const std::string& family, const std::vector<int>& sizes, StepBody (*make)(int)) {
    context.progress->beginTask(family + "s");
    std::vector<StepBody> bodies;
    for (const int size : sizes) bodies.push_back(make(size));
    append(rows, scaleFamily(family, bodies, context));
  };
  study("beam", beams, makeTetBeam);
  study("ball", balls, makeStepBall);
  return rows;
}

}  // namespace polyscalpel::report
