// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "polyscalpel/mesh/mesh_io.hpp"
#include "polyscalpel/simulation/simulation_config.hpp"

namespace polyscalpel {

/// Makes or reads the mesh and looks through it once. Throws std::invalid_argument for a file that cannot be
/// read (readMesh) and for a mesh that fails checkMesh: cutting relies on every invariant, and what a cut
/// makes of a broken mesh could not be told from a fault of its own.
MeshFile makeSceneMesh(const MeshConfig& config);

}  // namespace polyscalpel
