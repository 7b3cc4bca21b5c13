// SPDX-License-Identifier: BSD-3-Clause
//
// How far vertices of a cell are from the cut, as far as the cell's crossed edges and snapped corners tell.
#pragma once

#include <optional>
#include <vector>

#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Whether an edge across the cut, or snapped to it at its other end, shows that one of the vertices
/// (ascending) is no nearer to it than distance * localSize, at right angles to the blade's surface. What the
/// corners of the cut themselves tell, which may have been snapped, may be less.
bool isKnownFar(const PolyhedralMesh& mesh, const Crossings& crossings, CellId cell,
                const std::vector<VertexId>& vertices, double distance);

/// Side of the cut on which a vertex lies from which an edge shorter than distance * localSize leads to it.
std::optional<int> sideIfNear(const PolyhedralMesh& mesh, const Crossings& crossings, CellId cell,
                              VertexId vertex, double distance);

}  // namespace polyscalpel
