// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/step_solver.hpp"

#include <functional>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/surface.hpp"
#include "support/solver_runs.hpp"

namespace polyscalpel {
namespace {

TEST(StepSolver, EveryKindFindsTheSolution) {
  const PolyhedralMesh mesh = makeTetBeam(4);
  BodySystem system(mesh);
  const Eigen::Matrix3Xd positions = shake(bend(mesh.restPositions(), kLength, 1.2), 0.014, 1);
  int num_inverted = 0;
  for (const CellId cell : mesh.cells()) num_inverted += volume(makeCellSurface(mesh, cell, positions)) < 0;
  EXPECT_GT(num_inverted, 20);
  system.linearise(positions);
  const Eigen::Matrix3Xd b = someLoad(system, 2);
  for (const SolverKind kind : {SolverKind::kDirect, SolverKind::kJacobi, SolverKind::kFactor,
                                SolverKind::kAggregates, SolverKind::kAuto}) {
    for (const bool single : {false, true}) {
      StepSolver solver(
          withKind(kind, single ? 1e-6 : 1e-11, single ? Precision::kSingle : Precision::kDouble));
      const Solution solution = solve(solver, system, b);
      SCOPED_TRACE(toString(kind) + std::string(single ? ", single" : ", double"));
      expectSolved(solution, system, b, single ? 2e-5 : 1e-8);
      EXPECT_EQ(solution.report.kind, kind == SolverKind::kAuto ? SolverKind::kFactor : kind);
      EXPECT_FALSE(solution.report.reason.empty());
      EXPECT_EQ(solution.report.fallbacks, 0);
      EXPECT_FALSE(solution.report.budget_ended);
      const bool iterates = kind != SolverKind::kDirect;
      EXPECT_EQ(solution.report.is_single, single && iterates);
      EXPECT_EQ(solution.report.iterations > 0, iterates);
      EXPECT_EQ(solution.report.estimated_error > 0, iterates);
    }
  }
}

TEST(StepSolver, TheToldResidualIsTheTrueOneInDoublePrecision) {
  const PolyhedralMesh mesh = makeTetBeam(4);
  BodySystem system(mesh);
  system.linearise(bentBeam(mesh));
  const Eigen::Matrix3Xd b = someLoad(system, 3);
  for (const SolverKind kind : kIterativeKinds) {
    for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
      StepSolver solver(withKind(kind, tolerance));
      const Solution solution = solve(solver, system, b);
      const double residual = residualOf(system, solution.x, b, system.active());
      EXPECT_LE(solution.result.relative_residual, tolerance);
      EXPECT_NEAR(solution.result.relative_residual, residual, 1e-3 * residual) << toString(kind);
    }
  }
}

TEST(StepSolver, ChoosesByStepAndSize) {
  const PolyhedralMesh small = makeTetBeam(2), large = makeTetBeam(12);
  const auto chosen = [](const PolyhedralMesh& mesh, double step_s) {
    BodySystem system(mesh, step_s);
    StepSolver solver(SolverConfig{});
    return solve(solver, system, someLoad(system, 3)).report;
  };
  EXPECT_EQ(chosen(small, 1.0 / 60).kind, SolverKind::kFactor);
  EXPECT_EQ(chosen(small, 1e-4).kind, SolverKind::kJacobi);
  EXPECT_EQ(chosen(large, 1.0 / 60).kind, SolverKind::kAggregates);
  EXPECT_NE(chosen(small, 1.0 / 60).reason, chosen(small, 1e-4).reason);
}

TEST(StepSolver, ChoosesThePrecisionByWhatIsAskedFor) {
  BodySystem system(makeTetBeam(2));
  const Eigen::Matrix3Xd b = someLoad(system, 4);
  const auto isSingle = [&](double tolerance, std::optional<double> error_target) {
    SolverConfig config = withKind(SolverKind::kFactor, tolerance, Precision::kAuto);
    config.error_target = error_target;
    StepSolver solver(config);
    return solve(solver, system, b).report.is_single;
  };
  EXPECT_TRUE(isSingle(1e-4, {}));
  EXPECT_FALSE(isSingle(1e-9, {}));
  EXPECT_TRUE(isSingle(1e-9, 1e-3));
  EXPECT_FALSE(isSingle(1e-4, 1e-8));
}

TEST(StepSolver, GoesOnAfterACut) {
  for (const SolverKind kind : kIterativeKinds) {
    for (const bool anew : {false, true}) {
      PolyhedralMesh mesh = makeTetBeam(4);
      BodySystem system(mesh);
      StepSolver solver(withKind(kind));
      system.linearise(bentBeam(mesh));
      for (int step = 0; step < 3; ++step) solve(solver, system, someLoad(system, 5));
      for (int cut = 1; cut <= 3; ++cut) {
        cutFromAbove(mesh, system, solver, 0.1 * cut + 0.003, 0.048, cut);
        if (anew) solver.restart();
        for (int step = 0; step < 3; ++step) {
          const Eigen::Matrix3Xd b = someLoad(system, 6 + step);
          expectSolved(solve(solver, system, b), system, b, 1e-8);
        }
      }
    }
  }
}

// What was made for the uncut body serves on, with the cells around the slit factored: a few iterations more.
TEST(StepSolver, AFactorServesOnAfterASmallCut) {
  PolyhedralMesh mesh = makeTetBeam(6);
  BodySystem system(mesh);
  StepSolver solver(withKind(SolverKind::kFactor, 1e-4, Precision::kAuto));
  system.linearise(bentBeam(mesh));
  const int before = solve(solver, system, someLoad(system, 5)).report.iterations;
  for (int cut = 1; cut <= 2; ++cut) {
    cutFromAbove(mesh, system, solver, 0.1 * cut + 0.003, 0.03, cut);
    for (int step = 0; step < 5; ++step) {
      // It bends on, away from where the patch was factored.
      system.linearise(bend(mesh.restPositions(), kLength, 0.8 + 0.1 * step));
      const Eigen::Matrix3Xd b = someLoad(system, 6 + step);
      const Solution solution = solve(solver, system, b);
      expectSolved(solution, system, b, 1e-2);
      EXPECT_EQ(solution.report.kind, SolverKind::kFactor);
      EXPECT_EQ(solution.report.fallbacks, 0);
      EXPECT_LE(solution.report.iterations, 3 * before);
    }
  }
}

// What touches more than a patch may hold is factored at once, and its step is none the worse.
TEST(StepSolver, ALargeCutIsFactoredAtOnce) {
  PolyhedralMesh mesh = makeTetBeam(2);
  BodySystem system(mesh);
  StepSolver solver(withKind(SolverKind::kFactor, 1e-4, Precision::kAuto));
  system.linearise(bentBeam(mesh));
  const int before = solve(solver, system, someLoad(system, 7)).report.iterations;
  for (int cut = 1; cut <= 3; ++cut) {
    cutFromAbove(mesh, system, solver, 0.1 * cut + 0.003, 0.098, cut);
    for (int step = 0; step < 3; ++step) {
      const Eigen::Matrix3Xd b = someLoad(system, 8 + step);
      const Solution solution = solve(solver, system, b);
      expectSolved(solution, system, b, 1e-2);
      EXPECT_EQ(solution.report.kind, SolverKind::kFactor);
      EXPECT_EQ(solution.report.fallbacks, 0);
      EXPECT_LE(solution.report.iterations, 2 * before + 2);
    }
  }
}

// Parts of a patch turn against each other until it is no use any more: it is factored anew before anything
// slower is tried.
TEST(StepSolver, AWornPatchIsFactoredAnew) {
  PolyhedralMesh mesh = makeTetBeam(6);
  BodySystem system(mesh);
  SolverConfig config = withKind(SolverKind::kFactor, 1e-4, Precision::kAuto);
  config.refresh_after_steps = 1000;
  StepSolver solver(config);
  system.linearise(bentBeam(mesh));
  solve(solver, system, someLoad(system, 5));
  cutFromAbove(mesh, system, solver, 0.203, 0.07, 1);
  for (int step = 0; step < 12; ++step) {
    system.linearise(shake(bend(mesh.restPositions(), kLength, 0.8 + 0.3 * step), 0.001 * step, step));
    const Eigen::Matrix3Xd b = someLoad(system, 6 + step);
    const Solution solution = solve(solver, system, b);
    expectSolved(solution, system, b, 1e-2);
    EXPECT_EQ(solution.report.kind, SolverKind::kFactor) << step;
    EXPECT_EQ(solution.report.fallbacks, 0) << step;
  }
}

// The next factor is of the body as it lies: until it moves on, nothing is left to iterate.
TEST(StepSolver, AFactorTakenOverIsExact) {
  PolyhedralMesh mesh = makeTetBeam(6);
  BodySystem system(mesh);
  SolverConfig config = withKind(SolverKind::kFactor, 1e-4, Precision::kAuto);
  config.refresh_after_steps = 4;
  config.projection = 0;
  StepSolver solver(config);
  system.linearise(bentBeam(mesh));
  EXPECT_GT(solve(solver, system, someLoad(system, 7)).report.iterations, 2);
  cutFromAbove(mesh, system, solver, 0.203, 0.03, 1);
  for (int step = 1; step <= 6; ++step) {
    const Solution solution = solve(solver, system, someLoad(system, 8 + step));
    EXPECT_EQ(solution.report.kind, SolverKind::kFactor);
    if (step <= config.refresh_after_steps) {
      EXPECT_GT(solution.report.iterations, 2) << step;
    } else {
      EXPECT_LE(solution.report.iterations, 2) << step;
    }
  }
}

// Groups of the uncut body serve on, and are made anew a fixed number of steps later: then they are those
// that a new solver has.
TEST(StepSolver, AggregatesServeOnAfterACut) {
  PolyhedralMesh mesh = makeTetBeam(6);
  BodySystem system(mesh);
  SolverConfig config = withKind(SolverKind::kAggregates, 1e-4, Precision::kAuto);
  config.refresh_after_steps = 3;
  config.projection = 0;
  StepSolver solver(config);
  system.linearise(bentBeam(mesh));
  solve(solver, system, someLoad(system, 5));
  for (int cut = 1; cut <= 2; ++cut) cutFromAbove(mesh, system, solver, 0.1 * cut + 0.003, 0.03, cut);
  for (int step = 1; step <= 6; ++step) {
    const Eigen::Matrix3Xd b = someLoad(system, 6 + step);
    const Solution solution = solve(solver, system, b);
    expectSolved(solution, system, b, 1e-2);
    EXPECT_EQ(solution.report.kind, SolverKind::kAggregates);
    EXPECT_EQ(solution.report.fallbacks, 0);
    StepSolver anew(config);
    const Solution by_new = solve(anew, system, b);
    EXPECT_LE(solution.report.iterations, 1.3 * by_new.report.iterations) << step;
    // The first step after the cut is the first stale one.
    EXPECT_EQ(solution.x == by_new.x, step > config.refresh_after_steps) << step;
  }
}

// Cuts that follow on each other faster than factors are made: each step is solved, by the same means in each
// run, and in the end there is a factor.
TEST(StepSolver, CutsWhileAFactorIsBeingMade) {
  std::vector<std::vector<int>> iterations(2);
  for (std::vector<int>& run : iterations) {
    PolyhedralMesh mesh = makeTetBeam(4);
    BodySystem system(mesh);
    SolverConfig config = withKind(SolverKind::kFactor, 1e-4, Precision::kAuto);
    config.refresh_after_steps = 4;
    StepSolver solver(config);
    system.linearise(bentBeam(mesh));
    const auto step = [&](int seed) {
      const Eigen::Matrix3Xd b = someLoad(system, seed);
      const Solution solution = solve(solver, system, b);
      expectSolved(solution, system, b, 1e-2);
      EXPECT_EQ(solution.report.fallbacks, 0);
      run.push_back(solution.report.iterations);
      return solution.report.kind;
    };
    step(1);
    for (int cut = 1; cut <= 8; ++cut) {
      cutFromAbove(mesh, system, solver, 0.04 * cut + 0.003, 0.03, cut);
      for (int k = 0; k < 3; ++k) step(2 + k);
    }
    SolverKind kind = SolverKind::kAuto;
    for (int k = 0; k < 10; ++k) kind = step(20 + k);
    EXPECT_EQ(kind, SolverKind::kFactor);
  }
  EXPECT_EQ(iterations[0], iterations[1]);
}

TEST(StepSolver, EarlierSolutionsSpareIterations) {
  const PolyhedralMesh mesh = makeTetBeam(4);
  for (const SolverKind kind : kIterativeKinds) {
    const auto countIterations = [&](int projection) {
      SolverConfig config = withKind(kind, 1e-4, Precision::kAuto);
      config.projection = projection;
      StepSolver solver(config);
      BodySystem system(mesh);
      int iterations = 0;
      for (int step = 0; step < 12; ++step) {
        // A load that swings slowly while the body bends.
        system.linearise(bentBeam(mesh, 1.2 + 0.01 * step));
        const Eigen::Vector3d direction(std::sin(0.1 * step), 0.2, -std::cos(0.1 * step));
        const Eigen::Matrix3Xd b = direction * system.masses().transpose();
        const Solution solution = solve(solver, system, b);
        expectSolved(solution, system, b, 1e-2);
        iterations += solution.report.iterations;
      }
      return iterations;
    };
    const int without = countIterations(0), with_one = countIterations(1), with_three = countIterations(3);
    EXPECT_LT(with_one, without) << toString(kind);
    EXPECT_LT(with_three, 0.7 * without) << toString(kind);
  }
}

TEST(StepSolver, FactorsWhereIterationFails) {
  const PolyhedralMesh mesh = makeTetBeam(4);
  BodySystem system(mesh);
  system.linearise(bentBeam(mesh));
  for (const SolverKind kind : kIterativeKinds) {
    for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
      SolverConfig config = withKind(kind, 1e-11, precision);
      config.max_iterations = 1;
      StepSolver solver(config);
      for (int step = 0; step < 3; ++step) {
        const Eigen::Matrix3Xd b = someLoad(system, 9 + step);
        const Solution solution = solve(solver, system, b);
        expectSolved(solution, system, b, 1e-9);
        EXPECT_EQ(solution.report.kind, SolverKind::kDirect);
        const int first_fallbacks = precision == Precision::kSingle ? 2 : 1;
        EXPECT_EQ(solution.report.fallbacks, step == 0 ? first_fallbacks : 0);
        EXPECT_FALSE(solution.report.is_single);
        EXPECT_LT(solution.result.relative_residual, 1e-9);
      }
    }
  }
}

TEST(StepSolver, WhatFailedIsTriedAgainEverMoreSeldom) {
  BodySystem system(makeTetBeam(2));
  SolverConfig config = withKind(SolverKind::kJacobi);
  config.max_iterations = 1;
  StepSolver solver(config);
  std::vector<int> tried;
  for (int step = 0; step < 40; ++step) {
    if (solve(solver, system, someLoad(system, step)).report.fallbacks > 0) tried.push_back(step);
  }
  ASSERT_GE(tried.size(), 3U);
  EXPECT_GT(tried[1] - tried[0], 2);
  EXPECT_EQ(tried[2] - tried[1], 2 * (tried[1] - tried[0]));
  solver.restart();
  EXPECT_GT(solve(solver, system, someLoad(system, 41)).report.fallbacks, 0);
}

TEST(StepSolver, AFactorTakesOverWhereAggregatesTakeManyIterations) {
  // Slender, so that stiffness reaches far and a factor is small.
  BodySystem system(makeTetBox({0, 0, 0}, {8, 0.02, 0.02}, {800, 2, 2}), 1.0);
  ASSERT_GT(system.movable().size(), 6000U);
  for (const SolverKind kind : {SolverKind::kAuto, SolverKind::kAggregates}) {
    StepSolver solver(withKind(kind, 1e-8));
    std::vector<SolverReport> reports;
    for (int step = 0; step < 4; ++step) {
      const Eigen::Matrix3Xd b = someLoad(system, step);
      const Solution solution = solve(solver, system, b);
      EXPECT_EQ(solution.result.status, SolveStatus::kSolved);
      EXPECT_LT(residualOf(system, solution.x, b, system.active()), 2e-8);
      reports.push_back(solution.report);
    }
    EXPECT_EQ(reports[0].kind, SolverKind::kAggregates);
    EXPECT_GT(reports[1].iterations, 70);
    EXPECT_EQ(reports[3].kind, kind == SolverKind::kAuto ? SolverKind::kFactor : kind)
        << reports[1].iterations;
    if (kind == SolverKind::kAuto) {
      EXPECT_LT(5 * reports[3].iterations, reports[1].iterations);
    }
  }
}

TEST(StepSolver, EndsOnceItsBudgetIsSpent) {
  BodySystem system(makeTetBeam(4));
  const Eigen::Matrix3Xd b = someLoad(system, 10);
  for (const SolverKind kind : kIterativeKinds) {
    SolverConfig config = withKind(kind);
    config.step_budget_ms = 1;
    StepSolver solver(config);
    Solution solution;
    solution.result =
        solver.solve(system, b, true, std::chrono::steady_clock::now() - std::chrono::seconds(1), solution.x,
                     solution.report);
    EXPECT_EQ(solution.result.status, SolveStatus::kSolved);
    EXPECT_TRUE(solution.report.budget_ended);
    EXPECT_EQ(solution.report.iterations, 1);
    EXPECT_EQ(solution.report.fallbacks, 0);
    EXPECT_TRUE(solution.x.allFinite());
  }
}

/// Points of some boundary faces, each held along a direction and a little across it. stiffness: [N/m].
std::vector<Hold> holdSomeFaces(const BodySystem& system, const PolyhedralMesh& mesh, int count,
                                double stiffness) {
  const double far = system.restPositions().row(0).maxCoeff() - 1e-9;
  std::vector<Hold> holds;
  for (int f = 0; f < mesh.faceCapacity() && static_cast<int>(holds.size()) < count; ++f) {
    const Face& face = mesh.face(FaceId(f));
    if (!face.isAlive() || !face.isBoundary()) continue;
    Hold hold;
    double x = 0;
    for (const VertexId vertex : face.loop) {
      hold.shares.push_back({vertex.index(), 1.0 / static_cast<double>(face.loop.size())});
      x += system.restPositions()(0, vertex.index()) / static_cast<double>(face.loop.size());
    }
    if (x < far) continue;
    const Eigen::Vector3d normal = Eigen::Vector3d(1, 2, 3).normalized();
    hold.stiffness = stiffness * (normal * normal.transpose() + 0.01 * Eigen::Matrix3d::Identity());
    holds.push_back(hold);
    hold.shares.front().weight += 0.1;
    hold.shares.back().weight -= 0.1;
    holds.push_back(hold);  // two on a face
  }
  return holds;
}

TEST(StepSolver, SolvesWithContactsThatComeAndGo) {
  const PolyhedralMesh mesh = makeTetBeam(4);
  BodySystem system(mesh);
  system.linearise(bentBeam(mesh));
  const Eigen::Matrix3Xd b = someLoad(system, 11);
  for (const SolverKind kind : kIterativeKinds) {
    StepSolver solver(withKind(kind));
    for (const double stiffness : {0.0, 1e-3, 10.0, 1e4, 1.0, 0.0}) {
      system.holds = stiffness == 0 ? std::vector<Hold>() : holdSomeFaces(system, mesh, 12, stiffness);
      expectSolved(solve(solver, system, b, stiffness == 0), system, b, 1e-8);
    }
  }
}

TEST(StepSolver, StiffContactsTakeFewIterationsMore) {
  const PolyhedralMesh mesh = makeTetBeam(4);
  BodySystem system(mesh);
  system.linearise(bentBeam(mesh));
  const Eigen::Matrix3Xd b = someLoad(system, 11);
  for (const SolverKind kind : {SolverKind::kFactor, SolverKind::kAggregates}) {
    StepSolver solver(withKind(kind, 1e-4, Precision::kSingle));
    const int free = solve(solver, system, b).report.iterations;
    const bool is_factor = kind == SolverKind::kFactor;
    const std::vector<double> all = {1e-2, 1.0, 1e2, 1e4};
    for (const double stiffness : is_factor ? all : std::vector<double>(all.begin(), all.begin() + 3)) {
      system.holds = holdSomeFaces(system, mesh, 20, stiffness);
      ASSERT_EQ(system.holds.size(), 20U);
      const Solution solution = solve(solver, system, b);
      EXPECT_EQ(solution.report.kind, kind) << stiffness;
      EXPECT_EQ(solution.report.fallbacks, 0);
      EXPECT_LE(solution.report.iterations, is_factor ? free + 3 : 2 * free) << stiffness;
      expectSolved(solution, system, b, 1e-2);
    }
    system.holds.clear();
  }
}

TEST(StepSolver, SaysWhatCannotBeSolved) {
  for (const SolverKind kind : kIterativeKinds) {
    BodySystem system(makeTetBeam(2));
    StepSolver solver(withKind(kind, 1e-4, Precision::kAuto));
    const Eigen::Matrix3Xd b = someLoad(system, 12);
    Eigen::Matrix3Xd bad = b;
    bad(1, system.active()[7]) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(solve(solver, system, bad).result.status, SolveStatus::kNotFinite);
    system.ties.push_back({system.active()[7], -1e3 * Eigen::Matrix3d::Identity()});
    const Solution indefinite = solve(solver, system, b);
    if (kind == SolverKind::kJacobi && indefinite.result.status == SolveStatus::kSolved) {
      // Blocks are as indefinite as the matrix then, and may lead to a solution all the same.
      EXPECT_LT(residualOf(system, indefinite.x, b, system.active()), 1.1e-4);
    } else {
      EXPECT_EQ(indefinite.result.status, SolveStatus::kNotPositiveDefinite) << toString(kind);
    }
    system.ties.clear();
    // And goes on as if nothing had happened.
    const Solution solution = solve(solver, system, b);
    expectSolved(solution, system, b, 1e-3);
    EXPECT_EQ(solution.report.fallbacks, 0);
    EXPECT_TRUE(solve(solver, system, 0 * b).x.isZero(0));
  }
}

/// Cells to take out of a beam so that what is beyond x = 0.2 hangs by these vertices of that plane alone.
std::vector<CellId> cellsBeside(const PolyhedralMesh& mesh, const std::set<int>& hinge) {
  std::vector<CellId> cells;
  for (const CellId id : mesh.cells()) {
    double mean = 0;
    bool touches = false;
    for (const VertexId vertex : mesh.cell(id).vertices) {
      const double x = mesh.restPosition(vertex).x();
      mean += x / static_cast<double>(mesh.cell(id).vertices.size());
      touches = touches || (std::abs(x - 0.2) < 1e-9 && hinge.count(vertex.index()) == 0);
    }
    if (mean > 0.2 && touches) cells.push_back(id);
  }
  return cells;
}

int vertexAt(const PolyhedralMesh& mesh, const Eigen::Vector3d& point) {
  Eigen::Index nearest = 0;
  EXPECT_LT((mesh.restPositions().colwise() - point).colwise().norm().minCoeff(&nearest), 1e-9);
  return static_cast<int>(nearest);
}

TEST(StepSolver, APieceThatHangsByAVertexOrAnEdgeTakesNoMore) {
  const PolyhedralMesh mesh = makeTetBeam(4);
  // Cubes of 0.025 m; tets touch this plane in single vertices, and in edges, where i + j + k is even.
  const int vertex = vertexAt(mesh, {0.2, 0.05, 0.05}), other = vertexAt(mesh, {0.2, 0.075, 0.075});
  for (const SolverKind kind : {SolverKind::kFactor, SolverKind::kAggregates}) {
    int whole = 0;
    for (const std::set<int>& hinge : {std::set<int>{}, {vertex}, {vertex, other}}) {
      BodySystem system(mesh);
      if (!hinge.empty()) {
        const std::vector<CellId> cells = cellsBeside(mesh, hinge);
        EXPECT_GT(cells.size(), 20U);
        system.takeOut(mesh, cells);
        std::set<int> joined;
        for (const int i : system.active()) {
          for (const int j : system.active()) {
            if (mesh.restPosition(VertexId(i)).x() < 0.2 + 1e-9 &&
                mesh.restPosition(VertexId(j)).x() > 0.2 + 1e-9 && system.pattern().find(i, j) >= 0)
              joined.insert(i);
          }
        }
        EXPECT_EQ(joined, hinge);
      }
      system.linearise(bentBeam(mesh));
      StepSolver solver(withKind(kind, 1e-6));
      const Eigen::Matrix3Xd b = someLoad(system, 13);
      const Solution solution = solve(solver, system, b);
      expectSolved(solution, system, b, 1e-3);
      EXPECT_EQ(solution.report.kind, kind);
      EXPECT_EQ(solution.report.fallbacks, 0);
      if (hinge.empty()) whole = solution.report.iterations;
      EXPECT_LE(solution.report.iterations, whole + whole / 2) << toString(kind) << hinge.size();
    }
  }
}

TEST(StepSolver, AnyNumberOfThreadsGivesTheSameBits) {
  const PolyhedralMesh mesh = makeTetBeam(8);
  for (const SolverKind kind : kIterativeKinds) {
    for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
      std::vector<Eigen::Matrix3Xd> expected;
      for (const int threads : {1, 2, 3}) {
        BodySystem system(mesh);
        system.body().setThreads(threads);
        SolverConfig config = withKind(kind, 1e-2, precision);
        config.threads = threads;
        StepSolver solver(config);
        for (int step = 0; step < 2; ++step) {
          system.linearise(bentBeam(mesh, 1 + 0.1 * step));
          const Eigen::Matrix3Xd x = solve(solver, system, someLoad(system, 14 + step)).x;
          if (threads == 1) expected.push_back(x);
          EXPECT_EQ(x, expected[step]) << toString(kind) << threads;
        }
      }
    }
  }
}

}  // namespace
}  // namespace polyscalpel
