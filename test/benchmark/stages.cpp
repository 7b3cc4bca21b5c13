// SPDX-License-Identifier: BSD-3-Clause
//
// What each part of a scene costs in a step. The same block, with one part more from row to row.
#include <functional>
#include <memory>
#include <optional>

#include "benchmark/report.hpp"
#include "benchmark/timing.hpp"
#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel::report {
namespace {

constexpr double kTimeStep_s = 0.01;

struct Scene {
  std::string name;
  SimulationConfig config;
};

SimulationConfig block(int n) {
  SimulationConfig config;
  BoxMeshConfig box;
  box.size_m = {0.1, 0.1, 0.05};
  box.counts = {2 * n, 2 * n, n};
  config.mesh = box;
  config.fixed = {FixedBox{{0, 0, 0}, {0.1, 0.1, 0}}};
  config.element.strain = Strain::kLinear;
  config.element.exact_force = false;
  config.integration.time_step_s = kTimeStep_s;
  return config;
}

/// Tool 0 presses and slides, tool 1 is a blade. Both are there in every scene that has tools.
std::vector<Scene> scenes(int n) {
  std::vector<Scene> result = {{"gravity, linear strain", block(n)}};
  const auto add = [&](const std::string& name, const std::function<void(SimulationConfig&)>& change) {
    Scene scene{name, result.back().config};
    change(scene.config);
    result.push_back(std::move(scene));
  };
  add("+ corotation", [](SimulationConfig& config) { config.element.strain = Strain::kCorotated; });
  add("+ exact force", [](SimulationConfig& config) { config.element.exact_force = true; });
  add("+ contact", [](SimulationConfig& config) {
    config.contact = ContactConfig();
    ToolConfig ball;
    ball.name = "ball";
    ball.shape = ShapeConfig();
    ball.shape->radius_m = 0.015;
    config.tools = {ball};
  });
  add("+ cutting", [](SimulationConfig& config) {
    config.cutting = CuttingConfig();
    ToolConfig blade;
    blade.name = "blade";
    blade.blade_edge_tool = (Eigen::Matrix3Xd(3, 2) << 0, 0, 0, 0, 0, 0.06).finished();
    config.tools.push_back(blade);
  });
  add("+ stress", [](SimulationConfig& config) { config.stress = StressConfig(); });
  return result;
}

/// The ball rests 6 mm deep in the top, sliding slowly; the blade is drawn through the half without the ball.
std::vector<std::optional<Eigen::Isometry3d>> poses(const SimulationConfig& config, int step, int num_steps) {
  const double t = static_cast<double>(step) / num_steps;
  std::vector<std::optional<Eigen::Isometry3d>> result;
  if (!config.tools.empty())
    result.emplace_back(
        Eigen::Translation3d(0.04 + 0.02 * t, 0.03, 0.059 + 0.006 * std::max(0.0, 1 - 4 * t)));
  if (config.tools.size() > 1) result.emplace_back(Eigen::Translation3d(-0.01 + 0.1 * t, 0.073, 0.022));
  return result;
}

}  // namespace

Rows studyStages(const Context& context) {
  const int n = context.byMode(4, 6, 8);
  const int num_steps = context.byMode(40, 100, 400);
  const std::vector<Scene> all = scenes(n);
  context.progress->beginSection("stages", 10);
  std::vector<std::unique_ptr<Simulation>> simulations;
  for (const Scene& scene : all) simulations.push_back(std::make_unique<Simulation>(scene.config));

  const std::vector<std::pair<std::string, double StageTimes::*>> stages = {
      {"detection_ms", &StageTimes::detection_s}, {"contact_ms", &StageTimes::contact_s},
      {"assembly_ms", &StageTimes::assembly_s},   {"solve_ms", &StageTimes::solve_s},
      {"cutting_ms", &StageTimes::cutting_s},     {"update_ms", &StageTimes::update_s},
      {"total_ms", &StageTimes::total_s}};
  std::vector<std::vector<StageTimes>> times(all.size());
  std::vector<std::string> failures(all.size());
  std::vector<int> contacts(all.size());
  for (int step = 0; step < num_steps; ++step) {
    if (step % std::max(1, num_steps / 10) == 0) context.progress->beginTask("step " + std::to_string(step));
    for (std::size_t i = 0; i < all.size(); ++i) {
      const StepReport report = simulations[i]->step(poses(all[i].config, step, num_steps));
      if (!report.converged) failures[i] = report.message;
      contacts[i] += static_cast<int>(report.contacts.size());
      if (step > 0) times[i].push_back(report.times);
    }
  }

  Rows rows;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Row row;
    row["scene"] = all[i].name;
    row["cells_before"] = simulations[0]->mesh().numCells();
    row["cells"] = simulations[i]->mesh().numCells();
    row["unknowns_before"] = 3 * simulations[0]->mesh().numVertices();
    row["steps"] = num_steps;
    double sum_of_means = 0, mean_total = 0;
    for (const auto& [name, stage] : stages) {
      double mean = 0, largest = 0;
      for (const StageTimes& of_step : times[i]) {
        mean += 1e3 * of_step.*stage / times[i].size();
        largest = std::max(largest, 1e3 * of_step.*stage);
      }
      row[name] = mean;
      if (name == "total_ms") {
        std::vector<double> totals;
        for (const StageTimes& of_step : times[i]) totals.push_back(1e3 * of_step.total_s);
        row["median_total_ms"] = median(totals);
        row["largest_total_ms"] = largest;
        mean_total = mean;
      } else {
        sum_of_means += mean;
      }
    }
    row["other_ms"] = mean_total - sum_of_means;
    row["contacts_per_step"] = static_cast<double>(contacts[i]) / num_steps;
    std::string parts;
    for (const std::string& part : simulations[i]->parts()) parts += (parts.empty() ? "" : ", ") + part;
    row["parts"] = parts;
    if (!failures[i].empty()) holdFailed(row, failures[i]);
    // A part that the scene does not build costs nothing, to the last bit.
    if (!all[i].config.contact) {
      holdAtMost(row, "detection_ms", 0);
      holdAtMost(row, "contact_ms", 0);
    }
    if (!all[i].config.cutting) {
      holdAtMost(row, "cutting_ms", 0);
      holdAtMost(row, "update_ms", 0);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace polyscalpel::report
