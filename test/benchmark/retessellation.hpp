// SPDX-License-Identifier: BSD-3-Clause
//
// What a cutter does that knows tetrahedra only: it divides every cell that a cut has made, and every
// neighbour of one, into tetrahedra that conform. Our own baseline to compare with.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel::report {

enum class Retessellation {
  /// As few tetrahedra as we can: a face is divided by diagonals alone, chosen for the best worst triangle,
  /// so that neighbours agree; a cell is coned from that vertex of its own whose worst tetrahedron is best,
  /// and only where all of these are bad from a new vertex inside.
  kFewest,
  /// The plain one: each face that is no triangle gets a vertex in its middle, each cell that is no
  /// tetrahedron one inside.
  kMiddles,
};

struct Tetrahedra {
  Eigen::Matrix3Xd points;                ///< 3 x n, one column per vertex [m]
  std::vector<std::array<int, 4>> cells;  ///< of positive volume
};

/// The mesh's rest shape as tetrahedra. The first numVertices() points are the mesh's own vertices.
Tetrahedra retessellate(const PolyhedralMesh& mesh, Retessellation rule);

/// The same as cells of a mesh.
PolyhedralMesh toMesh(const Tetrahedra& tetrahedra);

}  // namespace polyscalpel::report
