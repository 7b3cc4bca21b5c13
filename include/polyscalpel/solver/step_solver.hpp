// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/difference_matrix.hpp"
#include "polyscalpel/solver/direct_solver.hpp"
#include "polyscalpel/solver/solver_config.hpp"
#include "polyscalpel/solver/solver_report.hpp"
#include "polyscalpel/solver/turned_factor.hpp"

namespace polyscalpel {

/// The system of one step as its solver asks for it.
class StepSystem {
 public:
  virtual ~StepSystem() = default;
  virtual const RowPattern& pattern() const = 0;
  /// Vertices that are not fixed, ascending.
  virtual const std::vector<int>& movable() const = 0;
  /// Of these, those that do not sleep. Vertices that share a cell sleep together.
  virtual const std::vector<int>& active() const = 0;
  /// 3 x n [m].
  virtual const Eigen::Matrix3Xd& restPositions() const = 0;
  /// The matrix as it is now.
  virtual void assemble(DifferenceMatrix<float>& matrix) = 0;
  virtual void assemble(DifferenceMatrix<double>& matrix) = 0;
  /// The same in the rest shape, without contacts, for all that is movable.
  virtual void assembleAtRest(DifferenceMatrix<double>& matrix) = 0;
  /// The same as the body lies now. rotations: of each movable vertex then.
  virtual void assembleBody(DifferenceMatrix<double>& matrix, std::vector<float>& rotations) = 0;
  /// Rotation of each vertex, 9 numbers, column by column.
  virtual void vertexRotations(std::vector<float>& rotations) = 0;
};

/// Solves a body's steps one after the other, by what SolverConfig says, and by something slower where that
/// fails: double precision, then a direct factor.
class StepSolver {
 public:
  explicit StepSolver(const SolverConfig& config);
  ~StepSolver();
  StepSolver(StepSolver&&) noexcept;
  StepSolver& operator=(StepSolver&&) noexcept;

  /// To be called before the first step and whenever the pattern or the movable vertices have changed.
  void restart();
  /// To be called instead of restart() after a cut, so that what was made for the uncut body serves on:
  /// vertices that were added, ascending, and the vertices of all cells that the cut made or changed.
  void follow(const std::vector<AddedVertex>& added, const std::vector<int>& touched);

  /// x = A^-1 b, 3 x n; zero at vertices that are not active. begins_step: false where contacts alone have
  /// changed since the last solve. step_start: when the step began, for its budget.
  SolveResult solve(StepSystem& system, const Eigen::Matrix3Xd& b, bool begins_step,
                    std::chrono::steady_clock::time_point step_start, Eigen::Matrix3Xd& x,
                    SolverReport& report);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace polyscalpel
