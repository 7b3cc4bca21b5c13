// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/status.hpp"

#include <cmath>

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

}  // namespace
}  // namespace polyscalpel
