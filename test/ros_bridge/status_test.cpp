// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/status.hpp"

#include <cmath>
#include <functional>
#include <string>

#include <gtest/gtest.h>

namespace polyscalpel {
namespace {

TEST(Status, TellsOfTheStressOrThatThereIsNone) {
  StepStatus status;
  fillStress(status, nullptr);
  EXPECT_TRUE(std::isnan(status.error_estimate));
  EXPECT_TRUE(std::isnan(status.von_mises_max_pa));
  StressField field;
  field.relative_error = 0.125;
  field.vertex_stresses = SymmetricTensors::Zero(6, 3);
  field.vertex_stresses(5, 1) = -2;  // pure shear: sqrt(3) times as much
  fillStress(status, &field);
  EXPECT_EQ(status.error_estimate, 0.125);
  EXPECT_NEAR(status.von_mises_max_pa, 2 * std::sqrt(3.0), 1e-12);
  fillStress(status, nullptr);
  EXPECT_TRUE(std::isnan(status.error_estimate)) << "what was there does not stay";
}

TEST(Status, TellsOfTheStep) {
  StepReport report;
  report.solves = 7;
  report.iterations = 5;
  report.times.stress_s = 1e-3;
  report.times.fracture_s = 1.5e-3;
  report.fracture_limited = true;
  report.times.total_s = 2e-3;
  StepStatus status;
  fillStep(status, report);
  EXPECT_EQ(status.solves, 7);
  EXPECT_EQ(status.newton_iterations, 5);
  EXPECT_EQ(status.stress_s, 1e-3);
  EXPECT_EQ(status.fracture_s, 1.5e-3);
  EXPECT_TRUE(status.fracture_limited);
  EXPECT_EQ(status.total_s, 2e-3);
}

TEST(Status, TellsHowTheStepWasSolved) {
  StepStatus status;
  StepReport report;
  fillStep(status, report);
  EXPECT_EQ(status.solver, "") << "nothing was solved";
  report.solves = 1;
  fillStep(status, report);
  EXPECT_EQ(status.solver, "direct");
  EXPECT_EQ(status.solver_iterations, 0);
  EXPECT_FALSE(status.solver_single);
  EXPECT_FALSE(status.budget_ended);
  report.solver.kind = SolverKind::kAggregates;
  report.solver.reason = "the body is large";
  report.solver.is_single = true;
  report.solver.iterations = 12;
  report.solver.estimated_error = 1e-3;
  report.solver.budget_ended = true;
  report.solver.fallbacks = 2;
  report.half_steps = 4;
  report.sleeping_pieces = 3;
  fillStep(status, report);
  EXPECT_EQ(status.solver, "aggregates");
  EXPECT_EQ(status.solver_reason, "the body is large");
  EXPECT_TRUE(status.solver_single);
  EXPECT_EQ(status.solver_iterations, 12);
  EXPECT_EQ(status.solver_error, 1e-3);
  EXPECT_TRUE(status.budget_ended);
  EXPECT_EQ(status.solver_fallbacks, 2);
  EXPECT_EQ(status.half_steps, 4);
  EXPECT_EQ(status.sleeping_pieces, 3);
  fillStep(status, StepReport());
  EXPECT_EQ(status.solver, "") << "what was there does not stay";
  EXPECT_EQ(status.solver_reason, "");
  report = StepReport();
  report.converged = false;
  fillStep(status, report);
  EXPECT_EQ(status.solver, "direct") << "the solver that failed is told";
}

/// The entry of the simulation in the diagnostics.
diagnostic_msgs::DiagnosticStatus diagnose(const StepStatus& status, const StepStatus& previous) {
  return makeDiagnostics(status, previous).status.front();
}

std::string valueOf(const diagnostic_msgs::DiagnosticStatus& entry, const std::string& key) {
  for (const diagnostic_msgs::KeyValue& value : entry.values)
    if (value.key == key) return value.value;
  return "no " + key;
}

TEST(Status, DiagnosticsNameTheSolverAndWhy) {
  StepStatus status;
  status.converged = true;
  status.solver = "factor";
  status.solver_reason = "the body is small";
  status.solver_iterations = 9;
  status.solver_error = 0.25;
  status.sleeping_pieces = 2;
  status.budget_left_out = true;
  const diagnostic_msgs::DiagnosticStatus entry = diagnose(status, StepStatus());
  EXPECT_EQ(entry.level, diagnostic_msgs::DiagnosticStatus::OK) << "left out as documented";
  EXPECT_EQ(valueOf(entry, "solver"), "factor");
  EXPECT_EQ(valueOf(entry, "solver_reason"), "the body is small");
  EXPECT_EQ(valueOf(entry, "solver_iterations"), "9");
  EXPECT_EQ(valueOf(entry, "solver_error"), "0.25");
  EXPECT_EQ(valueOf(entry, "sleeping_pieces"), "2");
  EXPECT_EQ(valueOf(entry, "budget_left_out"), "true");
}

TEST(Status, DiagnosticsWarnOfStepsThatDidNotGoAsAsked) {
  struct Case {
    std::function<void(StepReport&)> change;
    std::string word;
  };
  const Case cases[] = {
      {[](StepReport& report) { report.solver.budget_ended = true; }, "budget"},
      {[](StepReport& report) { report.solver.fallbacks = 1; }, "another took over"},
      {[](StepReport& report) { report.half_steps = 2; }, "shorter"},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.word);
    StepStatus previous;
    previous.converged = true;
    previous.step = 1;
    StepReport bad;
    one.change(bad);
    countStep(previous, bad);

    StepStatus status = previous;
    status.step = 2;
    countStep(status, StepReport());
    EXPECT_EQ(diagnose(status, previous).level, diagnostic_msgs::DiagnosticStatus::OK) << "told before";
    countStep(status, bad);
    countStep(status, StepReport());
    const diagnostic_msgs::DiagnosticStatus entry = diagnose(status, previous);
    EXPECT_EQ(entry.level, diagnostic_msgs::DiagnosticStatus::WARN) << "not the last step, but since then";
    EXPECT_NE(entry.message.find(one.word), std::string::npos) << entry.message;
    status.converged = false;
    EXPECT_EQ(diagnose(status, previous).level, diagnostic_msgs::DiagnosticStatus::ERROR);

    status.converged = true;
    status.step = 0;
    clearStepCounts(status);
    EXPECT_EQ(diagnose(status, previous).level, diagnostic_msgs::DiagnosticStatus::OK) << "after a reset";
    countStep(status, bad);
    EXPECT_EQ(diagnose(status, previous).level, diagnostic_msgs::DiagnosticStatus::WARN)
        << "the first since a reset";
  }
}

}  // namespace
}  // namespace polyscalpel
