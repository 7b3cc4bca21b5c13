// SPDX-License-Identifier: BSD-3-Clause
//
// What the blade's surface leaves hanging together of a cell.
#pragma once

#include <vector>

#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// The vertices of a cell, ascending, that hang together through uncrossed edges, the smallest component
/// first; snapped vertices belong to none. Empty where there is but one component, which is most often so.
std::vector<std::vector<VertexId>> findComponents(const PolyhedralMesh& mesh, const Crossings& crossings,
                                                  CellId cell);

/// Whether all of several components, which snapped vertices alone hold apart, lie on the same side of the
/// blade's surface: it only touches the cell then, as between two sheets of a blade that goes in and out by
/// another way.
bool lieOnOneSide(const PolyhedralMesh& mesh, const Crossings& crossings, CellId cell,
                  const std::vector<std::vector<VertexId>>& components);

/// Whether a component is nothing but vertices that hang in one straight edge, crossed on both sides of them:
/// no cut can part it from the cell.
bool hangInOneEdge(const PolyhedralMesh& mesh, CellId cell, const std::vector<VertexId>& component);

}  // namespace polyscalpel
