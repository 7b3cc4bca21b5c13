// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/equilibrium.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"
#include "polyscalpel/simulation/static_solution.hpp"
#include "scenes.hpp"

namespace polyscalpel {
namespace {

const IsotropicMaterial kMaterial{1e5, 0.4, 1000};

ElementConfig withStrain(Strain strain) {
  ElementConfig config;
  config.strain = strain;
  return config;
}

/// A beam clamped at x = 0: hexahedra, or the polyhedra that a cut into it leaves.
PolyhedralMesh makeBeam(bool notched) {
  PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {0.4, 0.05, 0.05}, {16, 2, 2});
  if (notched) {
    const Eigen::Matrix3Xd notch =
        (Eigen::Matrix3Xd(3, 4) << 0.103, 0.117, 0.117, 0.103, -1, -1, 1, 1, 0.02, 0.2, 0.2, 0.02).finished();
    const CutResult cut = cutMesh(mesh, mesh.restPositions(), PolygonCut{notch}, CuttingConfig(), 1);
    EXPECT_EQ(cut.status, CutStatus::kCut) << cut.message;
  }
  return mesh;
}

struct Beam {
  PolyhedralMesh mesh;
  Assembly assembly;
  SimulationState state;
  Eigen::Matrix3Xd weights;

  Beam(bool notched, Strain strain, double gravity)
      : mesh(makeBeam(notched)),
        assembly(mesh, kMaterial, withStrain(strain), 0),
        state(makeRestState(mesh, {FixedBox{{0, -1, -1}, {0, 1, 1}}})),
        weights(Eigen::Vector3d(0, 0, -gravity) * assembly.vertexMasses().transpose()) {}

  EquilibriumResult solve(const IntegrationConfig& config = {}) {
    return findEquilibrium(mesh, assembly, state.fixed, weights, {}, config, state.positions);
  }
};

class EquilibriumTest : public testing::TestWithParam<std::tuple<bool, Strain>> {};

TEST_P(EquilibriumTest, BalancesAHeavyBeam) {
  const auto [notched, strain] = GetParam();
  Beam beam(notched, strain, 9.81);
  IntegrationConfig config;
  config.equilibrium_tolerance = 1e-9;
  const EquilibriumResult result = beam.solve(config);
  ASSERT_TRUE(result.converged) << result.message;
  EXPECT_LE(result.relative_residual, 1e-9);
  if (strain == Strain::kLinear) {
    EXPECT_EQ(result.iterations, 1);
  }
  // The beam hangs down by more than a third of its length: far beyond small rotations.
  const double sag = (beam.mesh.restPositions() - beam.state.positions).row(2).maxCoeff();
  EXPECT_GT(sag, 0.4 / 3);
  // The gradient of the potential vanishes: checked by the energy alone, along random directions.
  const Eigen::Matrix3Xd& x = beam.state.positions;
  std::srand(1);
  for (int trial = 0; trial < 5; ++trial) {
    Eigen::Matrix3Xd direction = Eigen::Matrix3Xd::Random(3, x.cols());
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      if (beam.state.fixed[i]) direction.col(i).setZero();
    }
    constexpr double kStep = 1e-7;
    const double slope = (beam.assembly.elasticEnergy(x + kStep * direction) -
                          beam.assembly.elasticEnergy(x - kStep * direction)) /
                         (2 * kStep);
    const double work = (beam.weights.array() * direction.array()).sum();
    EXPECT_NEAR(slope, work, 1e-5 * beam.weights.norm() * direction.norm());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Beams, EquilibriumTest,
    testing::Combine(testing::Bool(), testing::Values(Strain::kLinear, Strain::kCorotated, Strain::kGreen)));

TEST(Equilibrium, OfALinearBodyIsTheLinearSolution) {
  Beam beam(true, Strain::kLinear, 9.81);
  const StaticSolution linear = solveStatic(beam.mesh, beam.assembly, beam.state.fixed, beam.weights);
  ASSERT_TRUE(beam.solve().converged);
  const Eigen::Matrix3Xd displacements = beam.state.positions - beam.mesh.restPositions();
  EXPECT_LT((displacements - linear.displacements).norm(), 1e-9 * linear.displacements.norm());
}

TEST(Equilibrium, MeasuresAgreeForASmallLoad) {
  Beam linear(true, Strain::kLinear, 1e-4);
  ASSERT_TRUE(linear.solve().converged);
  const Eigen::Matrix3Xd expected = linear.state.positions - linear.mesh.restPositions();
  for (const Strain strain : {Strain::kCorotated, Strain::kGreen}) {
    Beam beam(true, strain, 1e-4);
    ASSERT_TRUE(beam.solve().converged);
    EXPECT_LT((beam.state.positions - beam.mesh.restPositions() - expected).norm(), 1e-4 * expected.norm());
  }
}

TEST(Equilibrium, IsWhereADampedBodyComesToRest) {
  SimulationConfig config = blockScene();
  config.material = {3e3, 0.3, 1000};
  config.integration.mass_damping_per_s = 20;
  Simulation moving(config);
  for (int step = 0; step < 400; ++step) ASSERT_TRUE(moving.step({}).converged);
  ASSERT_LT(moving.velocities().norm(), 1e-6);
  config.integration.mode = AnalysisMode::kStatic;
  config.integration.equilibrium_tolerance = 1e-8;
  Simulation still(config);
  const StepReport report = still.step({});
  ASSERT_TRUE(report.converged) << report.message;
  const double way = (still.positions() - still.mesh().restPositions()).norm();
  EXPECT_LT((still.positions() - moving.positions()).norm(), 1e-5 * way);
}

TEST(Equilibrium, WithoutForceABodyStaysAndABentOneGoesBack) {
  Beam beam(true, Strain::kCorotated, 0);
  const Eigen::Matrix3Xd rest = beam.state.positions;
  EquilibriumResult result = beam.solve();
  ASSERT_TRUE(result.converged) << result.message;
  EXPECT_LE(result.iterations, 1);  // rounding may ask for a step that is too short to take
  EXPECT_EQ(beam.state.positions, rest);
  for (int i = 0; i < beam.mesh.numVertices(); ++i) {
    const double x = rest(0, i);
    beam.state.positions(2, i) += 2 * x * x;
  }
  IntegrationConfig config;
  config.equilibrium_tolerance = 1e-9;
  result = beam.solve(config);
  ASSERT_TRUE(result.converged) << result.message;
  EXPECT_LT((beam.state.positions - rest).norm(), 1e-6 * rest.norm());
}

TEST(Equilibrium, SaysWhyItDidNotConvergeAndLeavesThePositions) {
  Beam beam(false, Strain::kCorotated, 9.81);
  IntegrationConfig config;
  config.equilibrium_iterations = 1;
  const Eigen::Matrix3Xd before = beam.state.positions;
  const EquilibriumResult result = beam.solve(config);
  EXPECT_FALSE(result.converged);
  EXPECT_GT(result.relative_residual, config.equilibrium_tolerance);
  EXPECT_NE(result.message.find("after 1 Newton steps: relative residual"), std::string::npos)
      << result.message;
  EXPECT_EQ(beam.state.positions, before);

  beam.state.fixed.assign(beam.state.fixed.size(), false);
  const EquilibriumResult loose = beam.solve();
  EXPECT_FALSE(loose.converged);
  EXPECT_NE(loose.message.find("piece 0 of 1"), std::string::npos) << loose.message;
}

/// Presses a ball into the block to the same depth in so many steps; the force on it.
Eigen::Vector3d quasiStaticForce(int num_steps, double& torque_and_force_gap) {
  SimulationConfig config = pressingScene();
  config.integration.mode = AnalysisMode::kQuasiStatic;
  config.integration.gravity_m_s2.setZero();
  config.contact->friction_coefficient = 0;
  config.contact->damping_pa_s_m = 0;
  Simulation simulation(config);
  StepReport report;
  torque_and_force_gap = 0;
  for (int step = 0; step <= num_steps; ++step) {
    const double depth = 0.006 * step / num_steps;
    report = simulation.step({poseAt({0.047, 0.053, 0.05 + 0.0155 - depth})});
    EXPECT_TRUE(report.converged) << report.message;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const AppliedContact& contact : report.contacts) sum += contact.force_on_tissue_world;
    torque_and_force_gap = std::max(torque_and_force_gap, (sum + report.tools[0].wrench_tool.force).norm());
  }
  return report.tools[0].wrench_tool.force;
}

TEST(QuasiStatic, ForceDoesNotDependOnTheNumberOfSteps) {
  double gap_coarse = 0, gap_fine = 0;
  const Eigen::Vector3d coarse = quasiStaticForce(20, gap_coarse), fine = quasiStaticForce(80, gap_fine);
  EXPECT_GT(fine.z(), 0.1);
  // A contact's area and normal are those of the step's start: first order in the step.
  EXPECT_LT((coarse - fine).norm(), 0.05 * fine.norm());
  EXPECT_LT(std::max(gap_coarse, gap_fine), 1e-12 * fine.norm());
}

TEST(QuasiStatic, CutsLikeTheOthersAndNamesWhatFallsOff) {
  SimulationConfig config = cuttingScene();
  config.integration.mode = AnalysisMode::kQuasiStatic;
  Simulation simulation(config);
  bool fell = false;
  for (int step = 0; step <= kCuttingSteps && !fell; ++step) {
    const StepReport report = simulation.step({cuttingPose(step)});
    fell = !report.converged;
    if (fell) {
      EXPECT_NE(report.message.find("piece 1 of 2"), std::string::npos) << report.message;
    }
  }
  EXPECT_TRUE(fell);
  EXPECT_EQ(simulation.pieces().count, 2);
}

}  // namespace
}  // namespace polyscalpel
