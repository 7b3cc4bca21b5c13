// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/cutting/crack_growth.hpp"
#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// What drives cracks at these positions (3 x numVertices(), one column per vertex [m]): the cells of
/// materials with a strength, ascending, of which a principal stress may pass it. The stress of a cell is the
/// mean of its vertices', each smoothed over the cells of the same kind around it. O(cells).
///
/// velocities: 3 x numVertices() [m/s]. Rayleigh's damping in proportion to the stiffness is a viscosity, so
/// its stress, stiffness_damping_s times that of the rate of strain, counts: without it the tissue beside a
/// new crack would look strained until it has come back from its deformation. 0 where nothing damps.
std::vector<CellLoad> findCellLoads(const PolyhedralMesh& mesh, const Assembly& assembly,
                                    const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                    const Eigen::Ref<const Eigen::Matrix3Xd>& velocities,
                                    double stiffness_damping_s);

}  // namespace polyscalpel
