// SPDX-License-Identifier: BSD-3-Clause
//
// The stages of a time step, each by itself on a bent body, and the least that each has to move through
// memory.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "benchmark/step_bodies.hpp"
#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/solver/preconditioner.hpp"

namespace polyscalpel::report {

/// A body twisted by half a radian from one end to the other, with all that a step's stages take.
struct BentBody {
  /// body: must live on.
  explicit BentBody(const StepBody& body);

  CorotatedBody& corotated() { return *assembly.corotatedBody(); }
  /// Forces, and what the matrix is made from.
  void linearise() { assembly.lineariseWithForces(positions, ahead, forces); }
  /// The matrix in single precision.
  void assemble();
  void multiply() { polyscalpel::multiply(corotated().pattern(), matrix, active, x.data(), y.data()); }

  const StepBody& body;
  Assembly assembly;
  double stiffness_scale = 0;
  Eigen::Matrix3Xd positions, ahead, forces;
  DifferenceMatrix<float> matrix;
  DifferenceMatrix<double> rest_matrix;
  std::vector<int> active;
  std::vector<float> rotations;
  Eigen::VectorXf x, y;
};

/// What the solver of this name (factor, aggregates or jacobi) divides by; nullptr where a factor failed.
/// bent: must live on.
std::unique_ptr<Preconditioner> makePreconditioner(const std::string& solver, BentBody& bent);

/// What a stage must read and write at the least.
struct StageTraffic {
  double moved_bytes = 0;  ///< what has to come by, as often as it has to
  double held_bytes = 0;   ///< the same, each byte once: this much cache would hold it
  std::int64_t items = 0;  ///< what the stage goes through
  std::string item;        ///< what one of these is
};

/// Of BentBody::multiply().
StageTraffic productTraffic(BentBody& bent);

struct StepStage {
  std::string name;
  std::function<void()> run;              ///< once, as in a step; by one thread
  std::function<StageTraffic()> traffic;  ///< counted when it is asked for
};

/// linearise, assemble, product and precondition. bent: must live on. Throws std::runtime_error where the
/// preconditioner fails.
std::vector<StepStage> stepStages(const std::string& preconditioner, BentBody& bent);

/// A body whose stages are looked at, and what it is preconditioned by.
struct StageSubject {
  std::string name;
  std::string preconditioner;
  std::function<StepBody()> make;
};

/// A beam of 10,240 tetrahedra, a ball of 40,000 and a beam of 2,048 hexahedra, as the generator makes them.
std::vector<StageSubject> stageSubjects();

}  // namespace polyscalpel::report
