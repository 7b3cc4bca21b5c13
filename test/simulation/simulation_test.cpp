// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/simulation.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "scenes.hpp"

namespace polyscalpel {
namespace {

std::set<std::string> partsOf(const Simulation& simulation) {
  return {simulation.parts().begin(), simulation.parts().end()};
}

TEST(Simulation, BuildsOnlyWhatTheSceneAsksFor) {
  using Parts = std::set<std::string>;
  EXPECT_EQ(partsOf(Simulation(blockScene())), (Parts{"mesh", "elements", "dynamics"}));
  EXPECT_EQ(partsOf(Simulation(pressingScene())),
            (Parts{"mesh", "elements", "dynamics", "contact", "tools"}));
  EXPECT_EQ(partsOf(Simulation(cuttingScene())), (Parts{"mesh", "elements", "dynamics", "cutting", "tools"}));
  SimulationConfig config = blockScene();
  config.integration.mode = AnalysisMode::kStatic;
  EXPECT_EQ(partsOf(Simulation(config)), (Parts{"mesh", "elements", "statics"}));
  config.integration.mode = AnalysisMode::kQuasiStatic;
  config.stress = StressConfig();
  EXPECT_EQ(partsOf(Simulation(config)), (Parts{"mesh", "elements", "quasi-statics", "stress"}));
  config = pressingScene();
  config.contact.reset();
  const Simulation without(config);
  EXPECT_EQ(partsOf(without), (Parts{"mesh", "elements", "dynamics", "tools"}));
  EXPECT_EQ(without.toolShape(0), nullptr);
  EXPECT_NE(Simulation(pressingScene()).toolShape(0), nullptr);
}

TEST(Simulation, PartsThatAreNotBuiltTakeNoTime) {
  Simulation plain(blockScene());
  for (int step = 0; step < 3; ++step) {
    const StageTimes times = plain.step({}).times;
    EXPECT_EQ(times.detection_s, 0);
    EXPECT_EQ(times.contact_s, 0);
    EXPECT_EQ(times.cutting_s, 0);
    EXPECT_EQ(times.update_s, 0);
    EXPECT_EQ(times.stress_s, 0);
    EXPECT_GT(times.assembly_s, 0);
    EXPECT_GT(times.solve_s, 0);
    EXPECT_GE(times.total_s, times.assembly_s + times.solve_s);
  }
  Simulation pressing(pressingScene());
  for (int step = 0; step < 20; ++step) {
    const StageTimes times = pressing.step({pressingPose(step)}).times;
    EXPECT_EQ(times.cutting_s, 0);
    EXPECT_EQ(times.update_s, 0);
    if (step > 0) {
      EXPECT_GT(times.detection_s, 0);
    }
  }
  Simulation cutting(cuttingScene());
  for (int step = 0; step < 5; ++step) {
    const StageTimes times = cutting.step({cuttingPose(step)}).times;
    EXPECT_EQ(times.detection_s, 0);
    EXPECT_EQ(times.contact_s, 0);
    EXPECT_EQ(times.update_s, 0);  // nothing is cut yet
    if (step > 0) {
      EXPECT_GT(times.cutting_s, 0);
    }
  }
}

TEST(Simulation, CountsStepsAndTime) {
  Simulation simulation(blockScene());
  EXPECT_EQ(simulation.stepCount(), 0);
  for (int step = 0; step < 7; ++step) simulation.step({});
  EXPECT_EQ(simulation.stepCount(), 7);
  EXPECT_DOUBLE_EQ(simulation.time_s(), 0.07);
  EXPECT_NEAR(simulation.restVolume_m3(), 5e-4, 1e-16);
  EXPECT_EQ(simulation.movedMass_kg(), 0);
  EXPECT_EQ(simulation.numCuts(), 0);
}

TEST(Simulation, SettlesWithFallingEnergy) {
  Simulation simulation(blockScene(true));
  double last = simulation.totalEnergy_j();
  const double scale = std::abs(last);
  for (int step = 0; step < 200; ++step) {
    simulation.step({});
    const double now = simulation.totalEnergy_j();
    EXPECT_LE(now, last + 1e-9 * scale) << step;
    last = now;
  }
  EXPECT_LT(simulation.velocities().colwise().norm().maxCoeff(), 1e-4);
  for (int i = 0; i < simulation.mesh().numVertices(); ++i) {
    if (simulation.fixedVertices()[i]) {
      EXPECT_EQ(simulation.positions().col(i), simulation.mesh().restPositions().col(i));
    }
  }
}

TEST(Simulation, RefusesPosesThatAreNone) {
  Simulation simulation(pressingScene());
  simulation.step({pressingPose(0)});
  const Eigen::Matrix3Xd before = simulation.positions();
  EXPECT_THROW(simulation.step({}), std::invalid_argument);
  EXPECT_THROW(simulation.step({pressingPose(1), pressingPose(1)}), std::invalid_argument);
  Eigen::Isometry3d pose = pressingPose(1);
  pose.translation().y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(simulation.step({pose}), std::invalid_argument);
  pose = pressingPose(1);
  pose.linear() *= 1.001;
  EXPECT_THROW(simulation.step({pose}), std::invalid_argument);
  pose = pressingPose(1);
  pose.linear() *= -1;
  EXPECT_THROW(simulation.step({pose}), std::invalid_argument);
  pose.linear().setZero();
  EXPECT_THROW(simulation.step({pose}), std::invalid_argument);
  EXPECT_EQ(simulation.positions(), before);
  EXPECT_EQ(simulation.stepCount(), 1);
}

TEST(Simulation, ActionEqualsReactionInEveryStep) {
  for (const bool tetrahedra : {true, false}) {
    Simulation simulation(pressingScene(tetrahedra));
    double largest_force = 0;
    for (int step = 0; step < 80; ++step) {
      const Eigen::Isometry3d pose = pressingPose(step);
      const StepReport report = simulation.step({pose});
      ASSERT_TRUE(report.converged) << report.message;
      Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
      double sum_of_norms = 0;
      for (const AppliedContact& contact : report.contacts) {
        EXPECT_EQ(contact.tool, 0);
        force += contact.force_on_tissue_world;
        torque += (contact.point_world - pose.translation()).cross(contact.force_on_tissue_world);
        sum_of_norms += contact.force_on_tissue_world.norm();
      }
      const Wrench& wrench = report.tools[0].wrench_tool;
      EXPECT_LE((pose.linear() * wrench.force + force).norm(), 1e-14 * sum_of_norms);
      EXPECT_LE((pose.linear() * wrench.torque + torque).norm(), 1e-14 * sum_of_norms);
      largest_force = std::max(largest_force, force.norm());
      if (step > 60) {
        EXPECT_LT(force.z(), 0);  // the ball pushes down
      }
    }
    EXPECT_GT(largest_force, 0.1);
    EXPECT_EQ(simulation.numCuts(), 0);
  }
}

// The tissue's momentum changes by what acts on it: the tool's force is what the tissue feels, not only what
// is reported.
TEST(Simulation, ContactForceMovesAFreeBody) {
  SimulationConfig config = pressingScene();
  config.fixed.clear();
  config.integration.gravity_m_s2.setZero();
  config.integration.mass_damping_per_s = 0;
  Simulation simulation(config);
  const double mass = 1000 * simulation.restVolume_m3();
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
  for (int step = 0; step < 30; ++step) {
    for (const AppliedContact& contact : simulation.step({pressingPose(step)}).contacts) {
      impulse += config.integration.time_step_s * contact.force_on_tissue_world;
    }
  }
  EXPECT_GT(impulse.norm(), 1e-4);
  // Lumped masses are not known here, but the centre of mass of a block of equal hexahedra is: weights 1/8 a
  // corner.
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(simulation.mesh().numVertices());
  for (const CellId cell : simulation.mesh().cells()) {
    for (const VertexId vertex : simulation.mesh().cell(cell).vertices) {
      weights[vertex.index()] += mass / simulation.mesh().numCells() / 8;
    }
  }
  EXPECT_LT((simulation.velocities() * weights - impulse).norm(), 1e-9 * impulse.norm());
}

TEST(Simulation, AJumpReseatsTheTool) {
  Simulation simulation(pressingScene());
  StepReport report = simulation.step({pressingPose(0)});
  EXPECT_TRUE(report.tools[0].enabled);
  EXPECT_TRUE(report.tools[0].reseated);  // had no pose before
  EXPECT_FALSE(simulation.step({pressingPose(1)}).tools[0].reseated);
  const Eigen::Isometry3d deep = poseAt({0.05, 0.05, 0.0});
  report = simulation.step({deep});
  EXPECT_TRUE(report.tools[0].reseated);
  EXPECT_TRUE(report.contacts.empty());
  EXPECT_TRUE(report.tools[0].wrench_tool.force.isZero(0));
  report = simulation.step({std::nullopt});
  EXPECT_FALSE(report.tools[0].enabled);
  EXPECT_FALSE(report.tools[0].reseated);
  EXPECT_TRUE(simulation.step({pressingPose(1)}).tools[0].reseated);
}

// A turn moves the far end of a long tool further than its origin.
TEST(Simulation, ATurnIsAJumpOfTheFarEnd) {
  SimulationConfig config = pressingScene();
  config.tools[0].shape->kind = ShapeKind::kCapsule;
  config.tools[0].shape->length_m = 0.2;
  Simulation simulation(config);
  const Eigen::Vector3d above(0.05, 0.05, 0.5);
  simulation.step({poseAt(above)});
  const auto turned = [&](double angle) {
    return poseAt(above) * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX());
  };
  EXPECT_FALSE(simulation.step({turned(0.3)}).tools[0].reseated);       // 0.115 m * 0.3 < 0.05 m
  EXPECT_TRUE(simulation.step({turned(0.3 + 0.6)}).tools[0].reseated);  // 0.115 m * 0.6 > 0.05 m
}

TEST(Simulation, StateStaysWhenTheSolverFails) {
  SimulationConfig config = blockScene();
  config.fixed.clear();
  config.integration.time_step_s = 1;
  config.integration.gravity_m_s2 = {0, 0, -1e308};  // a free fall out of the range of doubles
  Simulation simulation(config);
  bool has_failed = false;
  for (int step = 0; step < 100 && !has_failed; ++step) {
    const Eigen::Matrix3Xd positions = simulation.positions(), velocities = simulation.velocities();
    const std::int64_t count = simulation.stepCount();
    const StepReport report = simulation.step({});
    ASSERT_TRUE(simulation.positions().allFinite());
    ASSERT_TRUE(simulation.velocities().allFinite());
    if (report.converged) continue;
    has_failed = true;
    EXPECT_FALSE(report.message.empty());
    EXPECT_EQ(simulation.positions(), positions);
    EXPECT_EQ(simulation.velocities(), velocities);
    EXPECT_EQ(simulation.stepCount(), count);
  }
  EXPECT_TRUE(has_failed);
}

TEST(Simulation, SameInputGivesTheSameBits) {
  Simulation a(pressingScene()), b(pressingScene());
  for (int step = 0; step < 60; ++step) {
    const StepReport report_a = a.step({pressingPose(step)}), report_b = b.step({pressingPose(step)});
    ASSERT_EQ(a.positions(), b.positions());
    ASSERT_EQ(a.velocities(), b.velocities());
    ASSERT_EQ(report_a.tools[0].wrench_tool.force, report_b.tools[0].wrench_tool.force);
  }
}

TEST(Simulation, ResetIsTheStartBitForBit) {
  Simulation simulation(pressingScene());
  const Eigen::Matrix3Xd start = simulation.positions();
  const auto run = [&] {
    std::vector<Eigen::Matrix3Xd> positions;
    for (int step = 0; step < 60; ++step) {
      simulation.step({pressingPose(step)});
      positions.push_back(simulation.positions());
    }
    return positions;
  };
  const std::vector<Eigen::Matrix3Xd> first = run();
  simulation.reset();
  EXPECT_EQ(simulation.positions(), start);
  EXPECT_TRUE(simulation.velocities().isZero(0));
  EXPECT_EQ(simulation.stepCount(), 0);
  EXPECT_EQ(run(), first);
}

class StaticScene : public testing::TestWithParam<Strain> {};

TEST_P(StaticScene, SagsOnceAndStays) {
  SimulationConfig config = blockScene();
  config.integration.mode = AnalysisMode::kStatic;
  config.element.strain = GetParam();
  Simulation simulation(config);
  const StepReport first = simulation.step({});
  ASSERT_TRUE(first.converged) << first.message;
  EXPECT_GE(first.iterations, 1);
  if (GetParam() == Strain::kLinear) {
    EXPECT_EQ(first.iterations, 1);
  }
  EXPECT_LT(first.relative_residual, config.integration.equilibrium_tolerance);
  const Eigen::Matrix3Xd sagged = simulation.positions();
  EXPECT_LT((sagged - simulation.mesh().restPositions()).row(2).minCoeff(), 0);
  EXPECT_TRUE(simulation.velocities().isZero(0));
  const StepReport second = simulation.step({});
  EXPECT_EQ(second.solves, 0);
  EXPECT_EQ(second.times.solve_s, 0);
  EXPECT_EQ(simulation.positions(), sagged);
}

INSTANTIATE_TEST_SUITE_P(Strains, StaticScene,
                         testing::Values(Strain::kLinear, Strain::kCorotated, Strain::kGreen));

TEST(Simulation, StaticSceneNamesALoosePiece) {
  SimulationConfig config = blockScene();
  config.integration.mode = AnalysisMode::kStatic;
  config.cutting = CuttingConfig();
  Simulation simulation(config);
  ASSERT_TRUE(simulation.step({}).converged);
  ASSERT_EQ(simulation.cut(PlaneCut{{0, 0, 0.03}, {0, 0, 1}}).status, CutStatus::kCut);
  const Eigen::Matrix3Xd before = simulation.positions();
  const StepReport report = simulation.step({});
  EXPECT_FALSE(report.converged);
  EXPECT_NE(report.message.find("piece 1 of 2"), std::string::npos) << report.message;
  EXPECT_EQ(simulation.positions(), before);
}

TEST(Simulation, RefusesASceneThatFixesNothingItNames) {
  SimulationConfig config = blockScene();
  config.fixed = {FixedBox{{5, 5, 5}, {6, 6, 6}}};
  EXPECT_THROW(Simulation{config}, std::invalid_argument);
}

}  // namespace
}  // namespace polyscalpel
