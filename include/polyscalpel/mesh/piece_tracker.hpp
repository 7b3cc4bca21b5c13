// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// The pieces of a mesh (findPieces()), followed from change to change at the cost of what a change has
/// touched and of the smaller parts of what it has divided.
///
/// Numbers are in [0, count), at the start as findPieces() gives them. A piece that is not divided keeps its
/// number. Of one that is, the part with most cells keeps it, of equal ones the one with the smallest cell
/// id; the others get the next free numbers, by their smallest cell ids. Where all cells of a piece are
/// removed, the piece with the highest number takes over its number.
class PieceTracker {
 public:
  PieceTracker() = default;
  explicit PieceTracker(const PolyhedralMesh& mesh);

  void update(const PolyhedralMesh& mesh, const MeshChange& change);

  const Pieces& pieces() const { return pieces_; }
  int count() const { return pieces_.count; }
  /// Number of cells of a piece.
  int numCells(int piece) const { return num_cells_[piece]; }

 private:
  void divide(const PolyhedralMesh& mesh, int piece, const std::vector<CellId>& suspects);
  void removeEmptyPieces(const PolyhedralMesh& mesh, std::vector<int> emptied);
  void refreshMember(const PolyhedralMesh& mesh, int piece, const std::vector<CellId>& candidates);

  Pieces pieces_;
  std::vector<int> num_cells_;   ///< by piece
  std::vector<CellId> members_;  ///< by piece, some cell of it
  std::vector<int> flood_;       ///< by cell id, -1 but within divide()
};

}  // namespace polyscalpel
