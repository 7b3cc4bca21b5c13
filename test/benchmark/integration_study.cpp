// SPDX-License-Identifier: BSD-3-Clause
//
// What a time step costs, and how far off the motion is after one second.
#include <cmath>

#include "benchmark/report.hpp"
#include "benchmark/timing.hpp"
#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel::report {
namespace {

constexpr double kDuration_s = 1;

/// A soft bar, held at one end and let go level: about one and a half swings in a second.
SimulationConfig swingingBar(int n, double time_step_s, SolverKind solver) {
  SimulationConfig config;
  BoxMeshConfig box;
  box.size_m = {0.2, 0.05, 0.05};
  box.counts = {4 * n, n, n};
  config.mesh = box;
  config.fixed = {FixedBox{{0, 0, 0}, {0, 1, 1}}};
  config.material = {3e4, 0.3, 1000};
  config.integration.time_step_s = time_step_s;
  config.integration.mass_damping_per_s = 0;
  config.integration.stiffness_damping_s = 0;
  config.solver.kind = solver;
  return config;
}

struct Run {
  Eigen::Matrix3Xd positions;
  double wall_s = 0;
  double residual = 0;  // largest of all steps
  std::string message;  // why there is no result; empty: all is well
};

Run simulate(const SimulationConfig& config) {
  Run run;
  Simulation simulation(config);
  const int steps = static_cast<int>(std::lround(kDuration_s / config.integration.time_step_s));
  run.wall_s = secondsOf([&] {
    for (int i = 0; i < steps && run.message.empty(); ++i) {
      const StepReport report = simulation.step({});
      run.residual = std::max(run.residual, report.relative_residual);
      if (!report.converged) run.message = report.message;
    }
  });
  run.positions = simulation.positions();
  return run;
}

}  // namespace

Rows studyIntegration(const Context& context) {
  const int n = context.byMode(2, 3, 4);
  const double finest_s = context.byMode(5e-4, 2e-4, 1e-4);
  const int repeats = context.byMode(1, 3, 9);
  const std::vector<double> steps_s = {1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2};
  context.progress->beginSection("integration", 1 + repeats);
  context.progress->beginTask("reference");
  // The error is of first order in h, so half a step beside a whole one gives the limit to second order.
  const Run coarse = simulate(swingingBar(n, finest_s, SolverKind::kDirect));
  const Run fine = simulate(swingingBar(n, finest_s / 2, SolverKind::kDirect));
  const Eigen::Matrix3Xd reference = 2 * fine.positions - coarse.positions;
  const Simulation rest(swingingBar(n, finest_s, SolverKind::kDirect));
  const double displacement = (reference - rest.positions()).norm();

  struct Series {
    SolverKind solver;
    double time_step_s;
    std::vector<Run> runs = {};
  };
  std::vector<Series> all;
  for (const SolverKind solver : {SolverKind::kDirect, SolverKind::kAuto})
    for (const double step_s : steps_s) all.push_back({solver, step_s});
  for (int repeat = 0; repeat < repeats; ++repeat) {
    context.progress->beginTask("round " + std::to_string(repeat + 1));
    for (Series& series : all)
      series.runs.push_back(simulate(swingingBar(n, series.time_step_s, series.solver)));
  }
  Rows rows;
  for (const Series& series : all) {
    const Run& run = series.runs.front();
    std::vector<double> wall_s;
    for (const Run& repeated : series.runs) wall_s.push_back(repeated.wall_s);
    Row row;
    row["time_step_s"] = series.time_step_s;
    row["solver"] = toString(series.solver);
    row["relative_residual"] = run.residual;
    row["cells"] = rest.mesh().numCells();
    row["error_after_1_s"] = (run.positions - reference).norm() / displacement;
    row["wall_ms_per_simulated_s"] = 1e3 * median(wall_s);
    row["step_ms"] = 1e3 * median(wall_s) / std::lround(kDuration_s / series.time_step_s);
    row["reference"] =
        "extrapolated from steps of " + std::to_string(1e3 * finest_s) + " ms and half of that";
    row["reference_step_change"] = (fine.positions - coarse.positions).norm() / displacement;
    if (!run.message.empty()) holdFailed(row, run.message);
    holdAtMost(row, "relative_residual",
               series.solver == SolverKind::kDirect ? 1e-6 : SolverConfig().tolerance);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace polyscalpel::report
