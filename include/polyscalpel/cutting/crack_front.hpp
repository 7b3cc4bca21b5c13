// SPDX-License-Identifier: BSD-3-Clause
//
// Where slits end within the body. A front is not kept anywhere: it is where the two sides of a slit, which
// lie in the same place in rest shape, are still joined. So a slit that a blade has left has one too.
#pragma once

#include <vector>

#include "polyscalpel/cutting/crossed_edge.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Whether the edge lies on the front of a slit: two faces of cuts, back to back in rest shape, meet there.
bool isOnCrackFront(const PolyhedralMesh& mesh, VertexId a, VertexId b);

/// Whether an edge of the vertex lies on the front of a slit.
bool isOnCrackFront(const PolyhedralMesh& mesh, VertexId vertex);

/// What of fronts is in a cell.
struct CellFront {
  std::vector<VertexId> vertices;  ///< on a front, ascending
  int slit = 0;  ///< number of the slit that ends at an edge of the cell, the smallest; 0: none does
  Edge edge;     ///< the longest such edge
};

/// The two cells beside a slit's end have its front too, but the crack does not go on into them: for these it
/// is no end.
CellFront findFront(const PolyhedralMesh& mesh, CellId cell);

/// Whether a cell around one of the cell's vertices has a vertex on a front.
bool isNearFront(const PolyhedralMesh& mesh, CellId cell);

}  // namespace polyscalpel
