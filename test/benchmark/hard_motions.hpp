// SPDX-License-Identifier: BSD-3-Clause
//
// Motions that are hard on what solves a step's system.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "benchmark/report.hpp"
#include "benchmark/step_bodies.hpp"

namespace polyscalpel::report {

struct HardMotion {
  StepBody body;
  int steps = 0;
  std::string quantity;  ///< what value() is
  /// Of the positions after the last step.
  double (*value)(const StepBody& body, const Eigen::Matrix3Xd& positions) = nullptr;
  double bound = 0;  ///< value() is at most this, whatever solves
  /// Why two solvers may go different ways to the same end; empty: they may not.
  std::string is_chaotic;
  std::string we_lose;  ///< why iterations do badly, where they are known to; empty: they do not
};

/// A motion before its body is made.
struct HardMotionEntry {
  std::string name;
  std::function<HardMotion(const Context&)> make;
};

std::vector<HardMotionEntry> hardMotions();

/// Cells whose mean deformation is a mirror image, flat, or not a number.
int countInverted(const StepBody& body, const Eigen::Matrix3Xd& positions);

}  // namespace polyscalpel::report
