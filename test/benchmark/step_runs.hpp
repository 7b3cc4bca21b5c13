// SPDX-License-Identifier: BSD-3-Clause
//
// The same steps of a body by one solver after the other.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "benchmark/step_bodies.hpp"
#include "polyscalpel/simulation/time_integration.hpp"

namespace polyscalpel::report {

/// A body in motion.
class Stepper {
 public:
  virtual ~Stepper() = default;
  /// One step. Throws std::runtime_error where it fails.
  virtual void step() = 0;
  virtual Eigen::Matrix3Xd positions() const = 0;
  /// Of the last step; as default-constructed where nothing is known.
  virtual const IntegrationResult& result() const = 0;
};

/// Who steps.
struct StepSolverChoice {
  std::string name;
  int threads = 1;
  std::function<std::unique_ptr<Stepper>(const StepBody&)> start;
};

/// Ours by its name: direct, factor, aggregates, jacobi or auto; all else by default, but for
/// jacobi a tolerance of 1e-5.
StepSolverChoice ours(const std::string& kind, int threads = 1, double tolerance = SolverConfig().tolerance);

/// Bullet's deformable body, from the rest shape and held in place, on the same tetrahedra, with lumped
/// masses and its own settings: one Newton iteration a step, of at most 300 conjugate gradients to 1e-6 of
/// its own measure. Its start is empty where Bullet's headers and libraries were not there.
StepSolverChoice bullet();

/// What the steps of one run came to; times of the median step after the first.
struct StepOutcome {
  std::string failure;                   ///< why there are no values; empty: all is well
  double step_ms = 0;                    ///< work of the thread where there is one, wall time otherwise
  double first_ms = 0;                   ///< the first step, which prepares the solver
  double assembly_ms = 0, solve_ms = 0;  ///< wall time
  double iterations = 0;                 ///< mean of a step
  double gate_error = 0;                 ///< largest relative error of the displacements at kGateSteps
  double residual = 0;                   ///< largest of all steps
  double memory_mb = 0;                  ///< what assembly, solver and state hold after the last step
  SolverReport solver;                   ///< of the last step
  int fallbacks = 0;                     ///< of all steps
};

/// Called after each step, whose time it is not part of.
using StepObserver = std::function<void(const Stepper& stepper)>;

/// The given number of steps, the first included. answers: displacements to compare with; those after the
/// last step are left out. observe: may be empty.
StepOutcome runSteps(const StepBody& body, const StepSolverChoice& choice, int steps,
                     const GateAnswers& answers, const StepObserver& observe = {});

/// The body's known displacements, or those of our own direct solver, whose residual is below 1e-10.
GateAnswers gateAnswers(const StepBody& body, int steps);

/// Median of several runs value by value; the first failure, if there is any. outcomes: at least 1.
StepOutcome medianOutcome(const std::vector<StepOutcome>& outcomes);

}  // namespace polyscalpel::report
