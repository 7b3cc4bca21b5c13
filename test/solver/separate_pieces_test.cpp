// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of several pieces, each of which is a system of its own.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "support/solver_runs.hpp"

namespace polyscalpel {
namespace {

/// Cuts a mesh by planes that do not cross within it; how many of them each vertex lies beyond.
std::vector<int> cutIntoSlices(PolyhedralMesh& mesh, const std::vector<PlaneCut>& planes) {
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const CutResult result =
        cutMesh(mesh, mesh.restPositions(), planes[k], CuttingConfig(), static_cast<int>(k + 1));
    EXPECT_EQ(result.status, CutStatus::kCut) << result.message;
  }
  std::vector<int> slice(mesh.numVertices(), 0);
  for (const CellId cell : mesh.cells()) {
    const std::vector<VertexId>& vertices = mesh.cell(cell).vertices;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const VertexId vertex : vertices)
      middle += mesh.restPosition(vertex) / static_cast<double>(vertices.size());
    const auto beyond = std::count_if(planes.begin(), planes.end(), [&](const PlaneCut& plane) {
      return plane.normal_world.dot(middle - plane.point_world) > 0;
    });
    for (const VertexId vertex : vertices) slice[vertex.index()] = static_cast<int>(beyond);
  }
  return slice;
}

// The residual of all would hardly tell of it.
TEST(StepSolverOfPieces, ALightPieceIsSolvedToTheToleranceOfItsOwnLoad) {
  PolyhedralMesh mesh = makeTetBeam(4);
  const std::vector<int> slice = cutIntoSlices(mesh, {{{0.398, 0.098, 0.098}, {1, 1, 1}}});
  BodySystem system(mesh);
  std::vector<int> corner;
  double mass = 0;
  for (const int i : system.active()) {
    if (slice[i] == 0) continue;
    corner.push_back(i);
    mass += system.masses()[i];
  }
  ASSERT_GT(mass, 0);
  ASSERT_LT(mass, 1e-4 * system.masses().sum());
  system.linearise(bentBeam(mesh));
  const Eigen::Matrix3Xd b = someLoad(system, 5);
  for (const SolverKind kind : kIterativeKinds) {
    for (const double tolerance : {1e-2, 1e-4}) {
      StepSolver solver(withKind(kind, tolerance));
      const Solution solution = solve(solver, system, b);
      ASSERT_EQ(solution.result.status, SolveStatus::kSolved);
      EXPECT_LE(solution.result.relative_residual, tolerance);
      EXPECT_LE(residualOf(system, solution.x, b, corner), tolerance) << toString(kind);
    }
  }
}

// Iterated as one, they take what their spectra together are worth, here twice as many.
TEST(StepSolverOfPieces, PiecesTakeNoMoreIterationsThanTheHardestOfThem) {
  PolyhedralMesh mesh = makeTetBeam(4);
  std::vector<PlaneCut> planes;
  for (int k = 1; k < 16; ++k) planes.push_back({{0.0253 * k, 0.05, 0.05}, {1, 0.02 * k, 0.01 * k}});
  const std::vector<int> slice = cutIntoSlices(mesh, planes);
  BodySystem system(mesh);
  system.linearise(bentBeam(mesh));
  const Eigen::Matrix3Xd b = someLoad(system, 5);
  const auto iterations = [&](const Eigen::Matrix3Xd& load) {
    StepSolver solver(withKind(SolverKind::kJacobi, 1e-8));
    const Solution solution = solve(solver, system, load);
    expectSolved(solution, system, load, 1e-5);
    return solution.report.iterations;
  };
  int most = 0;
  for (int k = 0; k < 16; ++k) {
    Eigen::Matrix3Xd alone = b;
    for (int i = 0; i < mesh.numVertices(); ++i) {
      if (slice[i] != k) alone.col(i).setZero();
    }
    most = std::max(most, iterations(alone));
  }
  EXPECT_GT(most, 10);
  EXPECT_LE(iterations(b), most);
}

// Its numbers are then too small for single precision.
TEST(StepSolverOfPieces, APieceThatHardlyMovesStopsNone) {
  PolyhedralMesh mesh = makeTetBeam(4);
  const std::vector<int> slice = cutIntoSlices(mesh, {{{0.21, 0.05, 0.05}, {1, 0.1, 0.2}}});
  BodySystem system(mesh);
  system.linearise(bentBeam(mesh));
  for (const double part : {1e-12, 1e-30, 1e-38, 1e-40, 1e-42, 1e-43, 0.0}) {
    Eigen::Matrix3Xd b = someLoad(system, 5);
    for (int i = 0; i < mesh.numVertices(); ++i) {
      if (slice[i] > 0) b.col(i) *= part;
    }
    for (const SolverKind kind : kIterativeKinds) {
      for (const bool by_error : {false, true}) {
        SolverConfig config = withKind(kind, 1e-4, Precision::kAuto);
        if (by_error) config.error_target = 1e-4;
        StepSolver solver(config);
        const Solution solution = solve(solver, system, b);
        expectSolved(solution, system, b, 1e-2);
        EXPECT_EQ(solution.report.fallbacks, 0) << toString(kind) << part << by_error;
      }
    }
  }
}

// What was made for the whole body joins the pieces of the cut one until it is renewed.
TEST(StepSolverOfPieces, WhatServedTheWholeServesOnAfterACutThrough) {
  for (const SolverKind kind : kIterativeKinds) {
    for (const double tolerance : {1e-4, 1e-8}) {
      PolyhedralMesh mesh = makeTetBeam(4);
      BodySystem system(mesh);
      StepSolver solver(withKind(kind, tolerance, Precision::kAuto));
      system.linearise(bentBeam(mesh));
      for (int step = 0; step < 3; ++step) solve(solver, system, someLoad(system, 5));
      for (int cut = 1; cut <= 3; ++cut) {
        cutFromAbove(mesh, system, solver, 0.4 - 0.09 * cut, 0.2, cut);
        EXPECT_EQ(findPieces(mesh).count, cut + 1);
        for (int step = 0; step < 4; ++step) {
          const Eigen::Matrix3Xd b = someLoad(system, 6 + step);
          const Solution solution = solve(solver, system, b);
          expectSolved(solution, system, b, 100 * tolerance);
          EXPECT_EQ(solution.report.fallbacks, 0) << toString(kind) << cut << step;
        }
      }
    }
  }
}

}  // namespace
}  // namespace polyscalpel
