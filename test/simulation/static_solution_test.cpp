// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/static_solution.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"

namespace polyscalpel {
namespace {

constexpr double kLength = 1, kWidth = 0.2;

ElementConfig smallStrain() {
  ElementConfig config;
  config.strain = Strain::kLinear;
  return config;
}

/// Deflection [m] of the end face's centre under a body force of 98.1 N/m^3 across, clamped at x = 0.
double cantileverDeflection(const PolyhedralMesh& mesh) {
  Assembly assembly(mesh, {1e5, 0.3, 10}, smallStrain(), 0);
  const SimulationState state = makeRestState(mesh, {FixedBox{{0, -1, -1}, {0, 1, 1}}});
  const Eigen::Matrix3Xd forces = Eigen::Vector3d(0, 0, -9.81) * assembly.vertexMasses().transpose();
  const StaticSolution solution = solveStatic(mesh, assembly, state.fixed, forces);
  EXPECT_EQ(solution.status, SolveStatus::kSolved) << solution.message;
  EXPECT_LT(solution.relative_residual, 1e-9);
  for (int i = 0; i < mesh.numVertices(); ++i) {
    const Eigen::Vector3d offset =
        mesh.restPosition(VertexId(i)) - Eigen::Vector3d(kLength, kWidth / 2, kWidth / 2);
    if (offset.norm() < 1e-9) return solution.displacements.col(i).norm();
  }
  ADD_FAILURE() << "no vertex in the middle of the end face";
  return 0;
}

// 0.03767 m: fourth-order elements, converged (four digits known).
TEST(StaticSolution, HexahedralCantileverConverges) {
  constexpr double kExpected = 0.03767;
  std::vector<double> errors;
  for (const int n : {2, 4, 8}) {
    const PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {kLength, kWidth, kWidth}, {5 * n, n, n});
    errors.push_back(std::abs(cantileverDeflection(mesh) / kExpected - 1));
    RecordProperty("relative_error_" + std::to_string(n), std::to_string(errors.back()));
  }
  EXPECT_LT(errors[1], errors[0]);
  EXPECT_LT(errors[2], errors[1]);
  // First-order elements converge with h^2 away from the clamp's edges, whose singularity lowers the order a
  // little: 15.6 % at n = 2 and an order of 1.5 or more leave less than 16 % / 8 at n = 8.
  EXPECT_LT(errors[0], 0.16);
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.5);
  EXPECT_LT(errors[2], 0.02);
}

TEST(StaticSolution, LeavesNoForceUnbalanced) {
  const PolyhedralMesh mesh = makeTetBox({0, 0, 0}, {0.2, 0.1, 0.1}, {4, 2, 2});
  Assembly assembly(mesh, {1e5, 0.3, 1000}, ElementConfig(), 0);
  const SimulationState state = makeRestState(mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}});
  const Eigen::Matrix3Xd forces = Eigen::Vector3d(1, 2, -9.81) * assembly.vertexMasses().transpose();
  const StaticSolution solution = solveStatic(mesh, assembly, state.fixed, forces);
  ASSERT_EQ(solution.status, SolveStatus::kSolved);
  Eigen::Matrix3Xd internal;
  assembly.internalForces(mesh.restPositions() + solution.displacements, internal);
  Eigen::Vector3d reaction = Eigen::Vector3d::Zero(), load = Eigen::Vector3d::Zero();
  for (int i = 0; i < mesh.numVertices(); ++i) {
    if (state.fixed[i]) {
      EXPECT_TRUE(solution.displacements.col(i).isZero(0));
      reaction += internal.col(i);
    } else {
      EXPECT_LT((internal.col(i) - forces.col(i)).norm(), 1e-9 * forces.norm());
      load += forces.col(i);
    }
  }
  EXPECT_LT((reaction + load).norm(), 1e-9 * load.norm());
}

TEST(StaticSolution, NamesAPieceThatIsFreeToMove) {
  PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {3, 1, 1}, {6, 2, 2});
  ASSERT_EQ(cutMesh(mesh, mesh.restPositions(), PlaneCut{{1.7, 0, 0}, {1, 0, 0}}, CuttingConfig(), 1).status,
            CutStatus::kCut);
  Assembly assembly(mesh, {1e5, 0.3, 1000}, smallStrain(), 0);
  const SimulationState state = makeRestState(mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}});
  const StaticSolution solution =
      solveStatic(mesh, assembly, state.fixed, Eigen::Matrix3Xd::Ones(3, mesh.numVertices()));
  EXPECT_EQ(solution.status, SolveStatus::kNotPositiveDefinite);
  EXPECT_NE(solution.message.find("piece 1 of 2"), std::string::npos) << solution.message;
  EXPECT_TRUE(solution.displacements.isZero(0));
}

TEST(StaticSolution, ThreeVerticesHoldABodyUnlessInLine) {
  const PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {2, 1, 1}, {2, 1, 1});
  Assembly assembly(mesh, {1e5, 0.3, 1000}, smallStrain(), 0);
  const Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Ones(3, mesh.numVertices());
  const auto status = [&](const FixedRegion& region) {
    return solveStatic(mesh, assembly, makeRestState(mesh, {region}).fixed, forces).status;
  };
  EXPECT_EQ(status(FixedBox{{0, 0, 0}, {2, 0, 0}}), SolveStatus::kNotPositiveDefinite);  // three in line
  EXPECT_EQ(status(FixedBox{{0, 0, 0}, {0, 1, 0}}), SolveStatus::kNotPositiveDefinite);  // two
  EXPECT_EQ(status(FixedBox{{0, 0, 0}, {0, 1, 1}}), SolveStatus::kSolved);
}

}  // namespace
}  // namespace polyscalpel
