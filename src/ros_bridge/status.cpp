// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/status.hpp"

#include <cmath>
#include <limits>

#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/ros_bridge/yaml_reader.hpp"

namespace polyscalpel {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr double kWindow_s = 1;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// A node in real time that is further behind than this warns.
constexpr double kLargeLag_s = 1;

bool isTetrahedron(const PolyhedralMesh& mesh, const Cell& cell) {
  if (cell.vertices.size() != 4 || cell.faces.size() != 4) return false;
  for (const FaceId face : cell.faces)
    if (mesh.face(face).loop.size() != 3) return false;
  return true;
}

void addValue(DiagnosticStatus& status, const std::string& key, const std::string& value) {
  diagnostic_msgs::KeyValue entry;
  entry.key = key;
  entry.value = value;
  status.values.push_back(entry);
}

void addValue(DiagnosticStatus& status, const std::string& key, double value) {
  addValue(status, key, toText(value));
}

std::uint64_t refusedPoses(const ToolStatus& tool) {
  return tool.poses_not_finite + tool.poses_bad_quaternion + tool.poses_bad_stamp + tool.poses_no_transform;
}

DiagnosticStatus diagnoseSimulation(const StepStatus& status, const StepStatus& previous) {
  DiagnosticStatus entry;
  entry.name = "polyscalpel: simulation";
  entry.hardware_id = "polyscalpel";
  entry.level = DiagnosticStatus::OK;
  entry.message = status.paused                 ? "paused"
                  : status.steps_per_second > 0 ? "running"
                                                : "waiting for poses or the clock";
  if (status.clock == "realtime" && status.lag_s > kLargeLag_s) {
    entry.level = DiagnosticStatus::WARN;
    entry.message = "simulated time has fallen behind";
  }
  if (status.steps_ended_by_budget > previous.steps_ended_by_budget) {
    entry.level = DiagnosticStatus::WARN;
    entry.message = "the budget ended steps before the solver's tolerance";
  }
  if (status.steps_with_fallbacks > previous.steps_with_fallbacks) {
    entry.level = DiagnosticStatus::WARN;
    entry.message = "a solver failed and another took over";
  }
  if (status.steps_halved > previous.steps_halved) {
    entry.level = DiagnosticStatus::WARN;
    entry.message = "steps failed as a whole and were made of shorter ones";
  }
  if (!status.converged) {
    entry.level = DiagnosticStatus::ERROR;
    entry.message = "the last step failed: " + status.message;
  }
  addValue(entry, "step", static_cast<double>(status.step));
  addValue(entry, "time_s", status.time_s);
  addValue(entry, "lag_s", status.lag_s);
  addValue(entry, "steps_per_second", status.steps_per_second);
  addValue(entry, "solver", status.solver);
  addValue(entry, "solver_reason", status.solver_reason);
  addValue(entry, "solver_iterations", status.solver_iterations);
  addValue(entry, "solver_error", status.solver_error);
  addValue(entry, "relative_residual", status.relative_residual);
  addValue(entry, "budget_left_out", status.budget_left_out ? "true" : "false");
  addValue(entry, "steps_ended_by_budget", static_cast<double>(status.steps_ended_by_budget));
  addValue(entry, "steps_with_fallbacks", static_cast<double>(status.steps_with_fallbacks));
  addValue(entry, "steps_halved", static_cast<double>(status.steps_halved));
  addValue(entry, "cells", status.cells);
  addValue(entry, "pieces", status.pieces);
  addValue(entry, "sleeping_pieces", status.sleeping_pieces);
  addValue(entry, "cuts", status.cuts);
  addValue(entry, "cells_left_whole", status.cells_left_whole);
  addValue(entry, "fracture_splits", status.fracture_splits);
  addValue(entry, "debris_pieces", status.debris_pieces);
  addValue(entry, "shortest_edge_relative", status.shortest_edge_relative);
  addValue(entry, "condition_estimate", status.condition_estimate);
  addValue(entry, "volume_relative_error", status.volume_relative_error);
  return entry;
}

DiagnosticStatus diagnoseTool(const ToolStatus& tool, const ToolStatus& previous) {
  DiagnosticStatus entry;
  entry.name = "polyscalpel: tool " + tool.name;
  entry.hardware_id = "polyscalpel";
  entry.level = DiagnosticStatus::OK;
  entry.message = tool.enabled ? "there" : "not there";
  if (tool.clock_jumps > previous.clock_jumps) {
    entry.level = DiagnosticStatus::WARN;
    entry.message = "the clock behind its stamps was set";
  }
  if (!tool.refusal.empty()) {
    entry.level = DiagnosticStatus::WARN;
    entry.message = tool.refusal;
  }
  if (tool.jumps > previous.jumps) {
    entry.level = DiagnosticStatus::WARN;
    entry.message = "jumped further than max_jump_m and was re-seated";
  }
  if (refusedPoses(tool) > refusedPoses(previous)) {
    entry.level = DiagnosticStatus::WARN;
    entry.message = "poses were refused";
  }
  addValue(entry, "enabled", tool.enabled ? "true" : "false");
  addValue(entry, "pending_crossings", tool.pending_crossings);
  addValue(entry, "poses_received", static_cast<double>(tool.poses_received));
  addValue(entry, "poses_not_finite", static_cast<double>(tool.poses_not_finite));
  addValue(entry, "poses_bad_quaternion", static_cast<double>(tool.poses_bad_quaternion));
  addValue(entry, "poses_bad_stamp", static_cast<double>(tool.poses_bad_stamp));
  addValue(entry, "poses_no_transform", static_cast<double>(tool.poses_no_transform));
  addValue(entry, "clock_jumps", static_cast<double>(tool.clock_jumps));
  addValue(entry, "jumps", static_cast<double>(tool.jumps));
  addValue(entry, "timeouts", static_cast<double>(tool.timeouts));
  return entry;
}

}  // namespace

void BodyCounter::fill(StepStatus& status, const Simulation& simulation) {
  const PolyhedralMesh& mesh = simulation.mesh();
  if (!is_current_) {
    tets_ = 0;
    for (int i = 0; i < mesh.cellCapacity(); ++i)
      if (mesh.cell(CellId(i)).isAlive() && isTetrahedron(mesh, mesh.cell(CellId(i)))) ++tets_;
    volume_m3_ = volume(mesh, mesh.restPositions());
    is_current_ = true;
  }
  status.cells = mesh.numCells();
  status.tets = tets_;
  status.vertices = mesh.numVertices();
  status.pieces = simulation.pieces().count;
  status.cuts = simulation.numCuts();
  status.cells_left_whole = simulation.cellsLeftWhole();
  status.fracture_splits = simulation.fracture().cells_split;
  status.fracture_left_whole = simulation.fracture().cells_left_whole;
  status.fracture_area_m2 = simulation.fracture().area_m2;
  status.volume_m3 = volume_m3_;
  status.volume_relative_error =
      std::abs(volume_m3_ + simulation.debris().volume_m3 - simulation.restVolume_m3()) /
      simulation.restVolume_m3();
  status.debris_pieces = simulation.debris().num_pieces;
  status.debris_volume_m3 = simulation.debris().volume_m3;
  const std::optional<MeshQuality> quality = simulation.quality();
  status.shortest_edge_m = quality ? quality->shortest_edge_m : kNone;
  status.shortest_edge_relative = quality ? quality->shortest_edge_relative : kNone;
  status.smallest_cell_volume_relative = quality ? quality->smallest_cell_volume_relative : kNone;
  status.condition_estimate = simulation.conditionEstimate().value_or(kNone);
  status.energy_j = simulation.totalEnergy_j();
  status.moved_mass_kg = simulation.movedMass_kg();
  status.parts = simulation.parts();
}

void fillStep(StepStatus& status, const StepReport& report) {
  status.detection_s = report.times.detection_s;
  status.contact_s = report.times.contact_s;
  status.assembly_s = report.times.assembly_s;
  status.solve_s = report.times.solve_s;
  status.cutting_s = report.times.cutting_s;
  status.update_s = report.times.update_s;
  status.stress_s = report.times.stress_s;
  status.fracture_s = report.times.fracture_s;
  status.fracture_limited = report.fracture_limited;
  status.total_s = report.times.total_s;
  status.converged = report.converged;
  status.message = report.message;
  status.relative_residual = report.relative_residual;
  const bool has_solved = report.solves > 0 || !report.converged;
  status.solver = has_solved ? toString(report.solver.kind) : "";
  status.solver_reason = report.solver.reason;
  status.solver_single = report.solver.is_single;
  status.solver_iterations = report.solver.iterations;
  status.solver_error = report.solver.estimated_error;
  status.solver_fallbacks = report.solver.fallbacks;
  status.budget_ended = report.solver.budget_ended;
  status.half_steps = report.half_steps;
  status.sleeping_pieces = report.sleeping_pieces;
  status.solves = report.solves;
  status.newton_iterations = report.iterations;
  status.contacts = static_cast<int>(report.contacts.size());
}

void countStep(StepStatus& status, const StepReport& report) {
  if (report.solver.budget_ended) ++status.steps_ended_by_budget;
  if (report.solver.fallbacks > 0) ++status.steps_with_fallbacks;
  if (report.half_steps > 0) ++status.steps_halved;
}

void clearStepCounts(StepStatus& status) {
  status.steps_ended_by_budget = 0;
  status.steps_with_fallbacks = 0;
  status.steps_halved = 0;
}

void fillStress(StepStatus& status, const StressField* field) {
  status.error_estimate = field == nullptr ? kNone : field->relative_error;
  status.von_mises_max_pa = field == nullptr ? kNone : vonMises(field->vertex_stresses).maxCoeff();
}

void fillTool(ToolStatus& status, const PoseCounters& counters) {
  status.poses_received = counters.received;
  status.poses_not_finite = counters.not_finite;
  status.poses_bad_quaternion = counters.bad_quaternion;
  status.poses_bad_stamp = counters.bad_stamp;
  status.poses_no_transform = counters.no_transform;
  status.clock_jumps = counters.clock_jumps;
  status.timeouts = counters.timeouts;
}

void RateMeter::add(double wall_s) {
  steps_.push_back(wall_s);
}

double RateMeter::rate_hz(double wall_s) {
  while (!steps_.empty() && steps_.front() < wall_s - kWindow_s) steps_.pop_front();
  if (steps_.size() < 2) return static_cast<double>(steps_.size());
  return static_cast<double>(steps_.size() - 1) / (steps_.back() - steps_.front());
}

diagnostic_msgs::DiagnosticArray makeDiagnostics(const StepStatus& status, const StepStatus& previous) {
  diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = status.header.stamp;
  // Counters start anew with a reset.
  const bool is_newer = previous.step <= status.step;
  array.status.push_back(diagnoseSimulation(status, is_newer ? previous : StepStatus()));
  for (std::size_t i = 0; i < status.tools.size(); ++i) {
    const bool has_previous = is_newer && i < previous.tools.size();
    array.status.push_back(diagnoseTool(status.tools[i], has_previous ? previous.tools[i] : ToolStatus()));
  }
  return array;
}

}  // namespace polyscalpel
