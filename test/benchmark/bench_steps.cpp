// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <optional>
#include <regex>

#include <benchmark/benchmark.h>

#include "benchmark/bench_rows.hpp"
#include "benchmark/step_runs.hpp"
#include "polyscalpel/core/checks.hpp"

namespace polyscalpel::bench {
namespace {

using report::StepBody;
using report::StepOutcome;
using report::StepSolverChoice;
using report::StepSubject;

constexpr int kRounds = 3;
constexpr int kSteps = report::kGateSteps.back();

std::string rowName(const StepSubject& subject, const StepSolverChoice& solver) {
  const std::string name = "step/" + subject.name + "/" + solver.name;
  return solver.threads == 1 ? name : name + "/threads:" + std::to_string(solver.threads);
}

/// As Google Benchmark reads --benchmark_filter, and as it completes a row's name.
bool isAskedFor(const std::string& row_name) {
  const std::string row = row_name + "/iterations:1/repeats:" + std::to_string(kRounds) + "/manual_time";
  std::string filter = benchmark::GetBenchmarkFilter();
  if (filter.empty() || filter == "all") return true;
  const bool excludes = filter.front() == '-';
  if (excludes) filter.erase(0, 1);
  return std::regex_search(row, std::regex(filter)) != excludes;
}

/// All solvers of a body in turns, run after run, when the first of its rows is asked for: what the machine
/// does beside it meets them all.
class Race {
 public:
  Race(StepSubject subject, std::vector<StepSolverChoice> solvers)
      : subject_(std::move(subject)), solvers_(std::move(solvers)) {}

  /// The outcome that belongs to the next repetition of a row.
  const StepOutcome& next(std::size_t solver) {
    if (outcomes_.empty()) run();
    POLYSCALPEL_ASSERT(!outcomes_[solver].empty());
    return outcomes_[solver][shown_[solver]++ % kRounds];
  }
  const StepBody& body() const { return *body_; }
  int threads(std::size_t solver) const { return solvers_[solver].threads; }

 private:
  void run() {
    body_ = subject_.make();
    outcomes_.resize(solvers_.size());
    shown_.resize(solvers_.size());
    const report::GateAnswers answers = report::gateAnswers(*body_, kSteps);
    for (int round = 0; round < kRounds; ++round)
      for (std::size_t i = 0; i < solvers_.size(); ++i)
        if (isAskedFor(rowName(subject_, solvers_[i])))
          outcomes_[i].push_back(report::runSteps(*body_, solvers_[i], kSteps, answers));
  }

  StepSubject subject_;
  std::vector<StepSolverChoice> solvers_;
  std::optional<StepBody> body_;
  std::vector<std::vector<StepOutcome>> outcomes_;  // by solver, then by round
  std::vector<int> shown_;                          // by solver: repetitions so far
};

void stepRow(benchmark::State& state, Race& race, std::size_t solver) {
  const StepOutcome& outcome = race.next(solver);
  for (auto _ : state) state.SetIterationTime(1e-3 * outcome.step_ms);
  if (!outcome.failure.empty()) {
    state.SkipWithError(outcome.failure.c_str());
    return;
  }
  const StepBody& body = race.body();
  const double unknowns = 3.0 * static_cast<double>(std::count(body.fixed.begin(), body.fixed.end(), false));
  state.counters["gate_error"] = outcome.gate_error;
  state.counters["iterations"] = outcome.iterations;
  state.counters["first_ms"] = outcome.first_ms;
  state.counters["assembly_ms"] = outcome.assembly_ms;
  state.counters["solve_ms"] = outcome.solve_ms;
  state.counters["threads"] = race.threads(solver);
  state.counters["fallbacks"] = outcome.fallbacks;
  state.counters["cells"] = body.mesh.numCells();
  state.counters["unknowns"] = unknowns;
  state.counters["us_per_unknown"] = 1e3 * outcome.step_ms / unknowns;
}

void registerRace(const StepSubject& subject, const std::vector<StepSolverChoice>& solvers) {
  if (!subject.make) {
    reportMissing("step/" + subject.name, subject.missing);
    return;
  }
  const auto race = std::make_shared<Race>(subject, solvers);
  for (std::size_t i = 0; i < solvers.size(); ++i) {
    const std::string name = rowName(subject, solvers[i]);
    if (!solvers[i].start) {
      reportMissing(name, "built without Bullet");
      continue;
    }
    auto* const row = benchmark::RegisterBenchmark(
        name.c_str(), [race, i](benchmark::State& state) { stepRow(state, *race, i); });
    row->Unit(benchmark::kMillisecond)->UseManualTime()->Iterations(1)->Repetitions(kRounds);
    row->ReportAggregatesOnly();
  }
}

}  // namespace

void reportMissing(const std::string& row, const std::string& why) {
  benchmark::RegisterBenchmark(row.c_str(),
                               [why](benchmark::State& state) { state.SkipWithError(why.c_str()); });
}

std::vector<StepSubject> stepSubjects(const std::string& folder) {
  std::vector<StepSubject> subjects = report::knownSubjects(folder);
  constexpr int kBeam = 8, kHalfBall = 10;
  subjects.push_back({"tet_beam10k", [] { return report::makeTetBeam(kBeam); }, {}});
  subjects.push_back({"ball40k", [] { return report::makeStepBall(kHalfBall); }, {}});
  return subjects;
}

void registerSteps(const std::string& folder) {
  using report::ours;
  for (const StepSubject& subject : stepSubjects(folder)) {
    std::vector<StepSolverChoice> solvers = {ours("direct"),  ours("factor"),    ours("aggregates"),
                                             ours("auto"),    ours("factor", 2), ours("aggregates", 2),
                                             ours("auto", 2), report::bullet()};
    // Elsewhere 500 iterations are not enough.
    if (subject.name == "beam10k" || subject.name == "tet_beam10k") solvers.push_back(ours("jacobi"));
    registerRace(subject, solvers);
  }
  // As many unknowns as the beam of tetrahedra has, and a body of cells of all kinds.
  constexpr int kHexBeam = 8, kHalfCutBall = 4, kCuts = 9;
  const std::vector<StepSubject> polyhedra = {
      {"hex" + std::to_string(kHexBeam), [] { return report::makeHexBeam(kHexBeam); }, {}},
      {"cut_ball", [] { return report::makeCutStepBall(kHalfCutBall, kCuts); }, {}}};
  for (const StepSubject& subject : polyhedra) {
    registerRace(subject, {ours("direct"), ours("factor"), ours("aggregates"), ours("auto"),
                           ours("factor", 2), ours("aggregates", 2), ours("auto", 2)});
  }
}

}  // namespace polyscalpel::bench
