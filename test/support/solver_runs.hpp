// SPDX-License-Identifier: BSD-3-Clause
//
// Systems of a bent beam, solved step by step and cut.
#pragma once

#include <chrono>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "support/body_system.hpp"
#include "support/small_bodies.hpp"

namespace polyscalpel {

constexpr double kLength = 0.4;  // of the beams [m]

inline Eigen::Matrix3Xd bentBeam(const PolyhedralMesh& mesh, double angle = 1.2) {
  return shake(bend(mesh.restPositions(), kLength, angle), 1e-4, 1);
}

inline SolverConfig withKind(SolverKind kind, double tolerance = 1e-11,
                             Precision precision = Precision::kDouble) {
  SolverConfig config;
  config.kind = kind;
  config.tolerance = tolerance;
  config.precision = precision;
  config.max_iterations = 5000;
  return config;
}

struct Solution {
  SolveResult result;
  SolverReport report;
  Eigen::Matrix3Xd x;
};

inline Solution solve(StepSolver& solver, BodySystem& system, const Eigen::Matrix3Xd& b,
                      bool begins_step = true) {
  Solution solution;
  solution.result =
      solver.solve(system, b, begins_step, std::chrono::steady_clock::now(), solution.x, solution.report);
  return solution;
}

inline void expectSolved(const Solution& solution, BodySystem& system, const Eigen::Matrix3Xd& b,
                         double error) {
  EXPECT_EQ(solution.result.status, SolveStatus::kSolved);
  const Eigen::Matrix3Xd expected = solveByFactor(system, b);
  EXPECT_LT((solution.x - expected).norm(), error * expected.norm());
  const std::vector<bool> fixed = system.fixed();
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (fixed[i]) {
      EXPECT_TRUE(solution.x.col(static_cast<int>(i)).isZero(0));
    }
  }
}

/// |A x - b| / |b| over some vertices, in double precision.
inline double residualOf(BodySystem& system, const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& b,
                         const std::vector<int>& vertices) {
  DifferenceMatrix<double> matrix;
  system.assemble(matrix);
  const Eigen::VectorXd given = toPadded<double>(system, b), found = toPadded<double>(system, x);
  Eigen::VectorXd product = Eigen::VectorXd::Zero(found.size());
  multiply(system.pattern(), matrix, system.active(), found.data(), product.data());
  double square_r = 0, square_b = 0;
  for (const int i : vertices) {
    square_r += (product - given).segment<3>(3 * i).squaredNorm();
    square_b += given.segment<3>(3 * i).squaredNorm();
  }
  return std::sqrt(square_r / square_b);
}

constexpr SolverKind kIterativeKinds[] = {SolverKind::kJacobi, SolverKind::kFactor, SolverKind::kAggregates};

/// Cuts the beam from above as deep as `depth`, at x, and tells the solver of it.
inline void cutFromAbove(PolyhedralMesh& mesh, BodySystem& system, StepSolver& solver, double x, double depth,
                         int cut) {
  PolygonCut blade;
  const double lowest = 0.1 - depth;
  blade.corners_world.resize(3, 4);
  blade.corners_world << x, x, x, x, -1, 1, 1, -1, lowest, lowest, 1, 1;
  const CutResult result = cutMesh(mesh, mesh.restPositions(), blade, CuttingConfig(), cut);
  ASSERT_EQ(result.status, CutStatus::kCut) << result.message;
  system.follow(mesh, result.change);
  std::vector<int> touched;
  std::vector<CellId> cells = result.change.changed_cells;
  for (const NewCell& cell : result.change.new_cells) cells.push_back(cell.cell);
  for (const CellId cell : cells) {
    for (const VertexId vertex : mesh.cell(cell).vertices) touched.push_back(vertex.index());
  }
  solver.follow(addedBy(result.change), touched);
  system.linearise(bend(mesh.restPositions(), kLength, 0.8));
}

}  // namespace polyscalpel
