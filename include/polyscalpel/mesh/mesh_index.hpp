// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "polyscalpel/mesh/cell_tree.hpp"
#include "polyscalpel/mesh/piece_tracker.hpp"

namespace polyscalpel {

/// What the owner of a mesh keeps beside it, so that a cut costs what it touches and not a look at every
/// cell. A value that refers to nothing.
struct MeshIndex {
  MeshIndex() = default;
  /// The tree is empty until it is first fitted.
  explicit MeshIndex(const PolyhedralMesh& mesh) : pieces(mesh) {}

  /// Follows a change of the mesh that was not made by a cut which has got this index.
  void update(const PolyhedralMesh& mesh, const MeshChange& change) {
    tree.update(mesh, change);
    pieces.update(mesh, change);
  }

  CellTree tree;
  PieceTracker pieces;
};

}  // namespace polyscalpel
