// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <polyscalpel/StepStatus.h>

#include "polyscalpel/ros_bridge/tool_tracker.hpp"
#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel {

/// Keeps what the status tells about the body and is costly to count, until the body's topology changes.
class BodyCounter {
 public:
  /// To be called after each cut and reset.
  void topologyChanged() { is_current_ = false; }

  /// Fills cells, tets, vertices, pieces, cuts, cells_left_whole, volumes and masses.
  void fill(StepStatus& status, const Simulation& simulation);

 private:
  bool is_current_ = false;
  int tets_ = 0;
  double volume_m3_ = 0;
};

/// Fills the stage times, the solution and the number of contacts.
void fillStep(StepStatus& status, const StepReport& report);

/// Counts the step among those that a budget ended, that needed another solver, or that were halved. To be
/// called once a step.
void countStep(StepStatus& status, const StepReport& report);

/// Sets these counts to 0.
void clearStepCounts(StepStatus& status);

/// Fills what is told of the stress. field: nullptr where there is none.
void fillStress(StepStatus& status, const StressField* field);

/// Fills the counters of one tool.
void fillTool(ToolStatus& status, const PoseCounters& counters);

/// Steps in the last second of wall time.
class RateMeter {
 public:
  /// wall_s: a steady clock [s].
  void add(double wall_s);
  /// Steps a second; 0 when there were none in the last second.
  double rate_hz(double wall_s);
  void clear() { steps_.clear(); }

 private:
  std::deque<double> steps_;
};

/// One entry for the simulation, one for each tool. previous: the status that the last diagnostics were made
/// from.
diagnostic_msgs::DiagnosticArray makeDiagnostics(const StepStatus& status, const StepStatus& previous);

}  // namespace polyscalpel
