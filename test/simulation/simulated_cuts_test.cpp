// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/simulation.hpp"
#include "scenes.hpp"

namespace polyscalpel {
namespace {

void expectSound(const Simulation& simulation) {
  EXPECT_TRUE(checkMesh(simulation.mesh()).empty()) << checkMesh(simulation.mesh()).front();
  ASSERT_EQ(simulation.positions().cols(), simulation.mesh().numVertices());
  ASSERT_EQ(simulation.velocities().cols(), simulation.mesh().numVertices());
  ASSERT_EQ(simulation.fixedVertices().size(), static_cast<std::size_t>(simulation.mesh().numVertices()));
  EXPECT_TRUE(simulation.positions().allFinite());
  EXPECT_TRUE(simulation.velocities().allFinite());
  EXPECT_EQ(simulation.pieces().count, findPieces(simulation.mesh()).count);
}

TEST(SimulatedCuts, ABladeDrawnThroughLeavesTwoPieces) {
  for (const bool tetrahedra : {false, true}) {
    Simulation simulation(cuttingScene(tetrahedra));
    const int cells_before = simulation.mesh().numCells();
    int num_events = 0, most_pending = 0;
    for (int step = 0; step <= kCuttingSteps; ++step) {
      const StepReport report = simulation.step({cuttingPose(step)});
      ASSERT_TRUE(report.converged) << report.message;
      expectSound(simulation);
      EXPECT_EQ(simulation.numPending(0), report.tools[0].pending_crossings);
      ASSERT_EQ(simulation.pendingPoints(0).cols(), simulation.numPending(0));
      most_pending = std::max(most_pending, simulation.numPending(0));
      for (const CutReport& event : report.cuts) {
        EXPECT_EQ(event.tool, 0);
        EXPECT_EQ(event.result.status, CutStatus::kCut);
        EXPECT_EQ(event.result.cut, 1) << "one stroke keeps its number";
        ++num_events;
        EXPECT_GT(report.times.update_s, 0);
      }
    }
    EXPECT_EQ(simulation.pieces().count, 2);
    EXPECT_EQ(simulation.numCuts(), 1);
    EXPECT_GT(num_events, 1);
    EXPECT_GT(most_pending, 0);
    EXPECT_EQ(simulation.numPending(0), 0) << "the blade has left";
    EXPECT_GT(simulation.mesh().numCells(), cells_before);
    EXPECT_NEAR(volume(simulation.mesh(), simulation.mesh().restPositions()), simulation.restVolume_m3(),
                1e-9 * simulation.restVolume_m3());
  }
}

TEST(SimulatedCuts, ABladeThatVanishesLeavesASoundMesh) {
  Simulation simulation(cuttingScene());
  for (int step = 0; step <= kCuttingSteps / 2; ++step) simulation.step({cuttingPose(step)});
  for (int step = 0; step < 10; ++step) {
    const StepReport report = simulation.step({std::nullopt});
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_EQ(report.tools[0].pending_crossings, 0);
    expectSound(simulation);
  }
  EXPECT_GT(simulation.numCuts(), 0);
}

TEST(SimulatedCuts, AJumpDoesNotCut) {
  SimulationConfig config = cuttingScene();
  Simulation simulation(config);
  simulation.step({cuttingPose(0)});
  const int vertices = simulation.mesh().numVertices();
  const StepReport report =
      simulation.step({cuttingPose(kCuttingSteps)});  // right through the block, in one step
  EXPECT_TRUE(report.tools[0].reseated);
  EXPECT_TRUE(report.cuts.empty());
  EXPECT_EQ(simulation.mesh().numVertices(), vertices);
}

TEST(SimulatedCuts, ResetAndReplayAreBitForBit) {
  Simulation simulation(cuttingScene(true)), other(cuttingScene(true));
  const Eigen::Matrix3Xd start = simulation.positions();
  std::vector<Eigen::Matrix3Xd> first;
  for (int step = 0; step <= kCuttingSteps; ++step) {
    simulation.step({cuttingPose(step)});
    other.step({cuttingPose(step)});
    first.push_back(simulation.positions());
    ASSERT_EQ(simulation.positions(), other.positions()) << step;
  }
  EXPECT_GT(simulation.numCuts(), 0);
  simulation.reset();
  EXPECT_EQ(simulation.positions(), start);
  EXPECT_EQ(simulation.mesh().restPositions(), start);
  EXPECT_EQ(simulation.numCuts(), 0);
  EXPECT_EQ(simulation.pieces().count, 1);
  EXPECT_EQ(simulation.movedMass_kg(), 0);
  for (int step = 0; step <= kCuttingSteps; ++step) {
    simulation.step({cuttingPose(step)});
    ASSERT_EQ(simulation.positions(), first[step]) << step;
  }
}

TEST(SimulatedCuts, ResistanceDoesTheWorkOfFracture) {
  SimulationConfig config = cuttingScene();
  config.material.fracture_toughness_j_m2 = 200;
  config.material.youngs_modulus_pa = 1e6;  // hardly moves, so that the blade's travel is the relative one
  config.integration.gravity_m_s2.setZero();
  Simulation simulation(config);
  double work = 0, area = 0;
  for (int step = 0; step <= kCuttingSteps; ++step) {
    const StepReport report = simulation.step({cuttingPose(step)});
    const Eigen::Vector3d force = cuttingPose(step).linear() * report.tools[0].wrench_tool.force;
    if (step > 0) {
      work -= force.dot(cuttingPose(step).translation() - cuttingPose(step - 1).translation());
    }
    if (report.cuts.empty()) {
      EXPECT_TRUE(force.isZero(0));
    } else {
      EXPECT_LT(force.x(), 0);  // against the motion
    }
    for (const CutReport& event : report.cuts) area += event.result.cut_area_m2;
  }
  EXPECT_NEAR(area, 0.1 * 0.1, 1e-6);
  EXPECT_NEAR(work, 200 * area, 1e-3 * work);
}

TEST(SimulatedCuts, EachMaterialResistsWithItsOwnToughness) {
  SimulationConfig config = cuttingScene();
  config.material.fracture_toughness_j_m2 = 50;
  config.material.youngs_modulus_pa = 1e6;
  config.integration.gravity_m_s2.setZero();
  RegionConfig tough;
  tough.name = "tough";
  tough.cells = RegionBox{{0.05, 0, 0}, {0.1, 0.1, 0.05}};
  tough.material = config.material;
  tough.material.fracture_toughness_j_m2 = 200;
  config.regions = {tough};
  Simulation simulation(config);
  double work = 0;
  for (int step = 0; step <= kCuttingSteps; ++step) {
    const StepReport report = simulation.step({cuttingPose(step)});
    if (step == 0) continue;
    const Eigen::Vector3d force = cuttingPose(step).linear() * report.tools[0].wrench_tool.force;
    work -= force.dot(cuttingPose(step).translation() - cuttingPose(step - 1).translation());
  }
  const double expected = (50 + 200) * 0.05 * 0.1;  // half of the area each
  EXPECT_NEAR(work, expected, 1e-3 * expected);
}

TEST(SimulatedCuts, TwoBladesCutTheSameBody) {
  SimulationConfig config = cuttingScene(true);
  config.tools.push_back(config.tools[0]);
  config.tools[1].name = "second";
  Simulation simulation(config);
  constexpr int kLag = 20;
  for (int step = 0; step <= kCuttingSteps + kLag; ++step) {
    // The second stands upright and follows 6 cm behind: both are in the block for a while.
    const Eigen::Isometry3d upright = poseAt({-0.02 + 3e-3 * (step - kLag), 0.043, 0.025}) *
                                      Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX());
    const StepReport report = simulation.step({cuttingPose(step), upright});
    ASSERT_TRUE(report.converged) << report.message;
    expectSound(simulation);
  }
  EXPECT_EQ(simulation.pieces().count, 4);
  EXPECT_EQ(simulation.numCuts(), 2) << "one number a stroke, also where strokes overlap in time";
}

TEST(SimulatedCuts, TheServiceCutsTheBodyAsItLies) {
  SimulationConfig config = cuttingScene();
  Simulation simulation(config);
  for (int step = 0; step < 5; ++step) simulation.step({std::nullopt});
  const Eigen::Matrix3Xd before = simulation.positions();
  const CutResult missed = simulation.cut(PlaneCut{{5, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(missed.status, CutStatus::kMissed);
  EXPECT_FALSE(missed.message.empty());
  EXPECT_EQ(simulation.positions(), before);
  EXPECT_EQ(simulation.numCuts(), 0);
  EXPECT_THROW(simulation.cut(PlaneCut{{0.05, 0, 0}, {0, 0, 0}}), std::invalid_argument);
  EXPECT_EQ(simulation.positions(), before);

  const CutResult result = simulation.cut(PlaneCut{{0.04, 0, 0}, {1, 0, 0}});
  ASSERT_EQ(result.status, CutStatus::kCut) << result.message;
  EXPECT_EQ(result.pieces_after, 2);
  EXPECT_EQ(simulation.pieces().count, 2);
  EXPECT_EQ(simulation.numCuts(), 1);
  EXPECT_EQ(simulation.positions().leftCols(before.cols()), before);
  expectSound(simulation);
  for (const NewVertex& vertex : result.change.new_vertices) {
    EXPECT_EQ(simulation.fixedVertices()[vertex.vertex.index()],
              simulation.fixedVertices()[vertex.parents[0].index()] &&
                  simulation.fixedVertices()[vertex.parents[1].index()]);
    EXPECT_NEAR(simulation.positions()(0, vertex.vertex.index()), 0.04, 1e-3 + 0.05 * 0.025);
  }
  for (int step = 0; step < 20; ++step) {
    ASSERT_TRUE(simulation.step({std::nullopt}).converged);
    expectSound(simulation);
  }

  SimulationConfig without = blockScene();
  EXPECT_THROW(Simulation(without).cut(PlaneCut{{0.05, 0, 0}, {1, 0, 0}}), std::invalid_argument);
}

// A free block that a ball pushes and bends: the cuts tell what they do to it, and the energy of all of it
// agrees.
TEST(SimulatedCuts, AFlyingBodyIsCutWithoutAPush) {
  for (const bool tetrahedra : {false, true}) {
    SimulationConfig config = pressingScene(tetrahedra);
    config.fixed.clear();
    config.integration.gravity_m_s2.setZero();
    config.cutting = CuttingConfig();
    Simulation simulation(config);
    const double mass = simulation.pieceTable().front().mass_kg;
    const std::vector<Eigen::Vector3d> normals = {{1, 0.3, 0.2}, {-0.2, 1, 0.1}, {0.3, 0.1, 1}};
    for (int step = 0; step < 60; ++step) {
      const StepReport report = simulation.step({pressingPose(step)});
      ASSERT_TRUE(report.converged) << report.message;
      if (step < 30 || step % 10 != 0) continue;
      const double speed = simulation.velocities().colwise().norm().maxCoeff();
      const double energy = simulation.totalEnergy_j(), scale = mass * speed * speed;
      ASSERT_GT(speed, 1e-3);
      const Eigen::Vector3d middle = simulation.positions().rowwise().mean();
      const CutReport event = simulation.cutAll({PlaneCut{middle, normals[step / 10 - 3]}});
      ASSERT_EQ(event.result.status, CutStatus::kCut);
      const CutBalance& balance = event.balance;
      EXPECT_LT(balance.momentum_change.norm(), 1e-12 * mass * speed);
      EXPECT_LE(balance.kinetic_energy_change_j, 1e-12 * scale);
      EXPECT_NE(balance.kinetic_energy_change_j, 0);
      const double told =
          balance.kinetic_energy_change_j + balance.elastic_energy_after_j - balance.elastic_energy_before_j;
      EXPECT_NEAR(simulation.totalEnergy_j() - energy, told, 1e-11 * (energy + scale));
    }
  }
}

TEST(SimulatedCuts, PressingTheCutBodyKeepsActionAndReaction) {
  SimulationConfig config = pressingScene();
  config.cutting = CuttingConfig();
  Simulation simulation(config);
  for (int step = 0; step < 80; ++step) {
    if (step == 45) {
      ASSERT_EQ(simulation.cut(PlaneCut{{0.05, 0, 0}, {1, 0.2, 0.1}}).status, CutStatus::kCut);
    }
    const Eigen::Isometry3d pose = pressingPose(step);
    const StepReport report = simulation.step({pose});
    ASSERT_TRUE(report.converged) << report.message;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    double sum_of_norms = 0;
    for (const AppliedContact& contact : report.contacts) {
      force += contact.force_on_tissue_world;
      sum_of_norms += contact.force_on_tissue_world.norm();
    }
    EXPECT_LE((pose.linear() * report.tools[0].wrench_tool.force + force).norm(), 1e-14 * sum_of_norms);
    if (step > 60) {
      EXPECT_LT(force.z(), 0);
    }
  }
  expectSound(simulation);
}

}  // namespace
}  // namespace polyscalpel
