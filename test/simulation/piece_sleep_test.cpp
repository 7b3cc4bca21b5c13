// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/piece_sleep.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel {
namespace {

/// A damped block that stands on its fixed bottom.
SimulationConfig standingBlock() {
  SimulationConfig config;
  BoxMeshConfig box;
  box.counts = {3, 3, 4};
  config.mesh = box;
  config.material = {2e4, 0.4, 1000};
  config.fixed = {FixedBox{{-1, -1, -1}, {1, 1, 0}}};
  config.integration.mass_damping_per_s = 5;
  config.integration.sleep_speed_m_s = 1e-4;
  config.integration.sleep_after_s = 0.1;
  config.cutting = CuttingConfig();
  return config;
}

/// Steps until so many pieces sleep; how many steps that took.
int stepUntilAsleep(Simulation& simulation, int pieces, int at_most = 400) {
  for (int step = 1; step <= at_most; ++step) {
    const StepReport report = simulation.step({});
    EXPECT_TRUE(report.converged) << report.message;
    if (report.sleeping_pieces == pieces) return step;
  }
  ADD_FAILURE() << "nothing fell asleep";
  return at_most;
}

CutReport cutAt(Simulation& simulation, double z) {
  return simulation.cutAll({PlaneCut{{0, 0, z}, {0, 0, 1}}});
}

TEST(PieceSleep, APieceAtRestFallsAsleepAndStaysWhereItIs) {
  Simulation simulation(standingBlock());
  const int steps = stepUntilAsleep(simulation, 1);
  EXPECT_GT(steps, 10);  // at least as long as it has to be slow
  const Eigen::Matrix3Xd positions = simulation.positions();
  EXPECT_TRUE(simulation.velocities().isZero(0));
  for (int step = 0; step < 20; ++step) {
    const StepReport report = simulation.step({});
    EXPECT_TRUE(report.converged);
    EXPECT_EQ(report.sleeping_pieces, 1);
    EXPECT_EQ(report.solver.iterations, 0);
  }
  EXPECT_EQ(simulation.positions(), positions);
  // Where it sleeps is where it would have come to rest, within its speed times a second or two.
  SimulationConfig config = standingBlock();
  config.integration.sleep_speed_m_s = 0;
  Simulation awake(config);
  for (int step = 0; step < steps + 200; ++step) EXPECT_EQ(awake.step({}).sleeping_pieces, 0);
  EXPECT_LT((awake.positions() - positions).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(PieceSleep, ACutWakesItsPieceAlone) {
  Simulation simulation(standingBlock());
  stepUntilAsleep(simulation, 1);
  ASSERT_EQ(cutAt(simulation, 0.06).result.status, CutStatus::kCut);
  // What is cut off falls freely and never sleeps; what still stands does again.
  EXPECT_EQ(simulation.step({}).sleeping_pieces, 0);
  stepUntilAsleep(simulation, 1);
  const auto lowestOf = [&](double from) {
    double lowest = 1;
    for (int i = 0; i < simulation.mesh().numVertices(); ++i) {
      if (simulation.mesh().restPosition(VertexId(i)).z() > from)
        lowest = std::min(lowest, simulation.positions()(2, i));
    }
    return lowest;
  };
  const double before = lowestOf(0.08);
  const Eigen::Matrix3Xd all_before = simulation.positions();
  simulation.step({});
  EXPECT_LT(lowestOf(0.08), before);
  for (int i = 0; i < simulation.mesh().numVertices(); ++i) {
    if (simulation.mesh().restPosition(VertexId(i)).z() < 0.05) {
      EXPECT_EQ(simulation.positions().col(i), all_before.col(i));
    }
  }
}

TEST(PieceSleep, WhatIsAwakeMovesAsIfNothingSlept) {
  SimulationConfig config = standingBlock();
  config.solver.tolerance = 1e-10;
  Simulation sleeping(config);
  config.integration.sleep_speed_m_s = 0;
  Simulation awake(config);
  for (Simulation* const simulation : {&sleeping, &awake})
    ASSERT_EQ(cutAt(*simulation, 0.06).result.status, CutStatus::kCut);
  int slept = 0;
  for (int step = 0; step < 150; ++step) {
    slept += sleeping.step({}).sleeping_pieces;
    awake.step({});
  }
  EXPECT_GT(slept, 10);
  for (int i = 0; i < awake.mesh().numVertices(); ++i) {
    if (awake.mesh().restPosition(VertexId(i)).z() > 0.08) {
      EXPECT_LT((sleeping.positions().col(i) - awake.positions().col(i)).norm(), 1e-7);
    }
  }
}

TEST(PieceSleep, ATouchWakes) {
  SimulationConfig config = standingBlock();
  config.contact = ContactConfig();
  ToolConfig tool;
  tool.shape = ShapeConfig();
  tool.shape->radius_m = 0.02;
  config.tools = {tool};
  Simulation simulation(config);
  const auto at = [](double z) { return Eigen::Isometry3d(Eigen::Translation3d(0.05, 0.05, z)); };
  StepReport report;
  for (int step = 0; step < 400 && report.sleeping_pieces == 0; ++step) report = simulation.step({at(0.15)});
  ASSERT_EQ(report.sleeping_pieces, 1);
  double z = 0.15;
  while (report.contacts.empty() && z > 0.09) {
    z -= 0.001;
    report = simulation.step({at(z)});
  }
  ASSERT_FALSE(report.contacts.empty());
  EXPECT_EQ(report.sleeping_pieces, 0);
  EXPECT_FALSE(simulation.velocities().isZero(0));
}

TEST(PieceSleep, ResetWakes) {
  Simulation simulation(standingBlock());
  const int steps = stepUntilAsleep(simulation, 1);
  const Eigen::Matrix3Xd positions = simulation.positions();
  simulation.reset();
  EXPECT_EQ(stepUntilAsleep(simulation, 1), steps);
  EXPECT_EQ(simulation.positions(), positions);
}

}  // namespace
}  // namespace polyscalpel
