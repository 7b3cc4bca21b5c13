// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <random>
#include <stdexcept>

#include <benchmark/benchmark.h>

#include "benchmark/bench_cuts.hpp"
#include "benchmark/bench_rows.hpp"
#include "benchmark/timing.hpp"
#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel::bench {
namespace {

using Eigen::Vector3d;
using report::median;
using report::StepBody;
using report::StepSubject;

constexpr int kRepetitions = 3;
constexpr int kRuns = 3;  // of a repetition: each step's median counts
constexpr int kStepsBefore = 15, kStepsAfter = 10;
constexpr int kSeries = 20;
constexpr int kMostCellsOfBlade = 50;

PolygonCut square(const Vector3d& centre, const Vector3d& u, const Vector3d& v) {
  PolygonCut cut;
  cut.corners_world.resize(3, 4);
  cut.corners_world << centre - u - v, centre + u - v, centre + u + v, centre - u + v;
  return cut;
}

/// The largest of ever smaller square blades around a random vertex that splits at most 50 cells.
PolygonCut bladeCut(const Simulation& simulation, int index) {
  std::mt19937 random(17 + index);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto somewhere = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  const int num_vertices = static_cast<int>(simulation.positions().cols());
  int vertex = 0;
  do {
    vertex = std::uniform_int_distribution<int>(0, num_vertices - 1)(random);
  } while (simulation.fixedVertices()[vertex]);
  const double h = medianSize(simulation.mesh());
  const Vector3d centre = simulation.positions().col(vertex) + 0.1 * h * somewhere();
  const Vector3d u = somewhere().normalized(), v = u.cross(somewhere()).normalized();
  for (double half = 2.5 * h;; half *= 0.8) {
    PolygonCut cut = square(centre, half * u, half * v);
    PolyhedralMesh mesh = simulation.mesh();
    const CutResult result = cutMesh(mesh, simulation.positions(), cut, {}, 1);
    if (result.cells_split <= kMostCellsOfBlade) return cut;
  }
}

double stepSeconds(Simulation& simulation, SolverReport* solver = nullptr) {
  const double start = report::threadSeconds();
  const StepReport report = simulation.step({});
  const double seconds = report::threadSeconds() - start;
  if (!report.converged) throw std::runtime_error(report.message);
  if (solver) *solver = report.solver;
  return seconds;
}

struct Timeline {
  std::vector<double> before, cut, first, tenth;  // one a cut [s]; tenth: after the last one
  std::vector<int> cells_split;
  std::vector<SolverReport> first_solvers;  // one a cut
};

/// Cuts with one step after each, then nine more.
Timeline cutAndStep(const SimulationConfig& scene, int num_cuts) {
  Timeline times;
  Simulation simulation(scene);
  double before = 0;
  for (int i = 0; i < kStepsBefore; ++i) before = stepSeconds(simulation);
  const auto make = [&](int index) {
    return num_cuts > 0 ? bladeCut(simulation, index) : halfPlane(simulation.positions());
  };
  for (int i = 0; i < std::max(1, num_cuts); ++i) {
    const PolygonCut cut = make(i);
    const double start = report::threadSeconds();
    const CutResult result = simulation.cut(cut);
    times.cut.push_back(report::threadSeconds() - start);
    times.cells_split.push_back(result.cells_split);
    times.before.push_back(before);
    times.first.push_back(stepSeconds(simulation, &times.first_solvers.emplace_back()));
  }
  double tenth = 0;
  for (int i = 1; i < kStepsAfter; ++i) tenth = stepSeconds(simulation);
  times.tenth.push_back(tenth);
  return times;
}

/// Median over the runs of the k-th value.
double medianOf(const std::vector<Timeline>& runs, std::vector<double> Timeline::*values, std::size_t k) {
  std::vector<double> of_runs;
  for (const Timeline& run : runs) of_runs.push_back((run.*values)[k]);
  return median(std::move(of_runs));
}

/// num_cuts: by a blade of up to 50 cells; 0: one plane to half the body's depth.
void afterCutRow(benchmark::State& state, const StepBody& body, int num_cuts) {
  const SimulationConfig scene = report::stepScene(body, SolverConfig());
  for (auto _ : state) {
    std::vector<Timeline> runs;
    try {
      for (int run = 0; run < kRuns; ++run) runs.push_back(cutAndStep(scene, num_cuts));
    } catch (const std::runtime_error& error) {
      state.SkipWithError(error.what());
      return;
    }
    const double before = medianOf(runs, &Timeline::before, 0);
    double worst = 0, cut = 0, worst_in_row = 0, last = before;
    int iterations = 0, fallbacks = 0;
    for (std::size_t k = 0; k < runs[0].first.size(); ++k) {
      const double first = medianOf(runs, &Timeline::first, k);
      worst = std::max(worst, first);
      worst_in_row = std::max(worst_in_row, first / last);
      last = first;
      iterations = std::max(iterations, runs[0].first_solvers[k].iterations);
      fallbacks += runs[0].first_solvers[k].fallbacks;
      cut = std::max(cut, medianOf(runs, &Timeline::cut, k));
    }
    state.SetIterationTime(worst);
    state.counters["before_ms"] = 1e3 * before;
    state.counters["cut_ms"] = 1e3 * cut;
    state.counters["first_ms"] = 1e3 * worst;
    state.counters["tenth_ms"] = 1e3 * medianOf(runs, &Timeline::tenth, 0);
    state.counters["first_iterations"] = iterations;
    state.counters["fallbacks"] = fallbacks;
    state.counters["ratio"] = worst / before;
    state.counters["ratio_in_row"] = worst_in_row;  // to the step before each, which a cut precedes as well
    state.counters["cells_split"] = *std::max_element(runs[0].cells_split.begin(), runs[0].cells_split.end());
  }
}

}  // namespace

void registerStepsAfterCuts(const std::string& folder) {
  for (const StepSubject& subject : stepSubjects(folder)) {
    for (const auto& [cut, num_cuts] :
         {std::pair("blade", 1), std::pair("half_plane", 0), std::pair("blade_series", kSeries)}) {
      const std::string name = "step_after_cut/" + subject.name + "/" + cut;
      if (!subject.make) {
        reportMissing(name, subject.missing);
        continue;
      }
      const auto run = [subject, num_cuts = num_cuts](benchmark::State& state) {
        afterCutRow(state, subject.make(), num_cuts);
      };
      benchmark::RegisterBenchmark(name.c_str(), run)
          ->Unit(benchmark::kMillisecond)
          ->UseManualTime()
          ->Iterations(1)
          ->Repetitions(kRepetitions)
          ->ReportAggregatesOnly();
    }
  }
}

}  // namespace polyscalpel::bench
