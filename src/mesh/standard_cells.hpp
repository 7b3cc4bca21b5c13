// SPDX-License-Identifier: BSD-3-Clause
//
// Outward face loops of the cells that mesh files and generators know, from their corners in Gmsh's order.
#pragma once

#include <array>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Tetrahedron: (p1 - p0) . ((p2 - p0) x (p3 - p0)) > 0.
inline PolyhedralMesh::CellLoops makeTetLoops(const std::array<int, 4>& v) {
  return {{v[0], v[2], v[1]}, {v[0], v[1], v[3]}, {v[1], v[2], v[3]}, {v[0], v[3], v[2]}};
}

/// Pyramid: base 0 1 2 3 counter-clockwise seen from the apex 4.
inline PolyhedralMesh::CellLoops makePyramidLoops(const std::array<int, 5>& v) {
  return {{v[0], v[3], v[2], v[1]},
          {v[0], v[1], v[4]},
          {v[1], v[2], v[4]},
          {v[2], v[3], v[4]},
          {v[3], v[0], v[4]}};
}

/// Prism: triangle 0 1 2 counter-clockwise seen from the opposite triangle 3 4 5.
inline PolyhedralMesh::CellLoops makePrismLoops(const std::array<int, 6>& v) {
  return {{v[0], v[2], v[1]},
          {v[3], v[4], v[5]},
          {v[0], v[1], v[4], v[3]},
          {v[1], v[2], v[5], v[4]},
          {v[2], v[0], v[3], v[5]}};
}

/// Hexahedron: bottom 0 1 2 3 counter-clockwise seen from the top 4 5 6 7.
inline PolyhedralMesh::CellLoops makeHexLoops(const std::array<int, 8>& v) {
  return {{v[0], v[3], v[2], v[1]}, {v[4], v[5], v[6], v[7]}, {v[0], v[1], v[5], v[4]},
          {v[1], v[2], v[6], v[5]}, {v[2], v[3], v[7], v[6]}, {v[3], v[0], v[4], v[7]}};
}

}  // namespace polyscalpel
