// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/simulation/simulation_config.hpp"

namespace polyscalpel {

/// What each cell of an uncut mesh is made of: kind 0 the scene's material and element, kind i + 1 those of
/// regions[i]. region_names: as in MeshFile. config: valid.
///
/// Throws std::invalid_argument, naming the regions, for one that holds no cell, one whose cells all lie in
/// regions of higher order, a physical group that the mesh does not have, and two regions that share a cell
/// without different orders.
CellKinds makeCellKinds(const PolyhedralMesh& mesh, const SimulationConfig& config,
                        const std::map<std::string, int>& region_names);

}  // namespace polyscalpel
