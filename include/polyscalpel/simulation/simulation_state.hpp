// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/simulation/simulation_config.hpp"

namespace polyscalpel {

/// Motion of a body at one time. One column or flag per vertex.
struct SimulationState {
  Eigen::Matrix3Xd positions;   ///< 3 x n [m], world frame
  Eigen::Matrix3Xd velocities;  ///< 3 x n [m/s]
  /// Held where it is; its velocity is zero. So are retired vertices, which nothing could move.
  std::vector<bool> fixed;
  /// Of a piece that sleeps: at rest, and left out of the step where the strain is corotated. Empty: nothing
  /// sleeps.
  std::vector<char> asleep;
  bool isAsleep(int vertex) const { return !asleep.empty() && asleep[vertex] != 0; }
};

/// At rest in the rest shape. Throws std::invalid_argument for a region that holds no vertex, or an id out of
/// range.
SimulationState makeRestState(const PolyhedralMesh& mesh, const std::vector<FixedRegion>& fixed);

/// Follows a change of the mesh. A new vertex is fixed if both its parents are; a vertex that retires stays
/// where it was last.
void applyMeshChange(SimulationState& state, const MeshChange& change);

}  // namespace polyscalpel
