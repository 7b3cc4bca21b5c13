// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/simulation_state.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

TEST(SimulationState, RegionsFixTheirVertices) {
  const PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {2, 1, 1}, {2, 1, 1});
  const SimulationState state =
      makeRestState(mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}, FixedSphere{{2, 1, 1}, 0.5}, FixedVertices{{2}}});
  EXPECT_EQ(state.positions, mesh.restPositions());
  EXPECT_TRUE(state.velocities.isZero(0));
  for (int i = 0; i < mesh.numVertices(); ++i) {
    const Eigen::Vector3d X = mesh.restPosition(VertexId(i));
    EXPECT_EQ(state.fixed[i], X.x() == 0 || X == Eigen::Vector3d(2, 1, 1) || i == 2);
  }
}

TEST(SimulationState, RefusesRegionsThatHoldNothing) {
  const PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  EXPECT_THROW(makeRestState(mesh, {FixedBox{{2, 2, 2}, {3, 3, 3}}}), std::invalid_argument);
  EXPECT_THROW(makeRestState(mesh, {FixedSphere{{0.5, 0.5, 0.5}, 0.1}}), std::invalid_argument);
  EXPECT_THROW(makeRestState(mesh, {FixedVertices{{8}}}), std::invalid_argument);
  EXPECT_NO_THROW(makeRestState(mesh, {FixedVertices{{7}}}));
}

TEST(SimulationState, NewVerticesTakeTheirParentsValues) {
  const PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  SimulationState state = makeRestState(mesh, {FixedVertices{{0, 1}}});
  state.positions.setRandom();
  state.velocities.setRandom();
  const auto vertex = [](int i) { return VertexId(i); };
  MeshChange change;
  change.new_vertices = {{vertex(8), {vertex(0), vertex(1)}, 0.25},
                         {vertex(9), {vertex(1), vertex(2)}, 0.5},
                         {vertex(10), {vertex(8), vertex(8)}, 0.3}};  // a copy of a new vertex
  const Eigen::Matrix3Xd before = state.positions;
  applyMeshChange(state, change);
  ASSERT_EQ(state.positions.cols(), 11);
  ASSERT_EQ(state.velocities.cols(), 11);
  EXPECT_EQ(state.positions.leftCols(8), before);
  EXPECT_EQ(state.positions.col(8), 0.75 * before.col(0) + 0.25 * before.col(1));
  EXPECT_EQ(state.velocities.col(9), 0.5 * state.velocities.col(1) + 0.5 * state.velocities.col(2));
  EXPECT_EQ(state.positions.col(10), state.positions.col(8));
  EXPECT_TRUE(state.fixed[8]);
  EXPECT_FALSE(state.fixed[9]);
  EXPECT_TRUE(state.fixed[10]);
}

}  // namespace
}  // namespace polyscalpel
