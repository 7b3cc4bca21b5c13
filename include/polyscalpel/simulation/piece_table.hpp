// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// A connected piece of tissue, in rest shape.
struct PieceProperties {
  CellId smallest_cell;  ///< the smallest id of its cells: names the piece as long as no cut changes it
  int num_cells = 0;
  double volume_m3 = 0;
  double mass_kg = 0;  ///< density times volume, summed over its cells
};

/// Pieces that were taken away because they were smaller than CuttingConfig::debris_volume_m3.
struct Debris {
  int num_pieces = 0;
  double volume_m3 = 0;  ///< rest shape
  double mass_kg = 0;
  MeshChange change;  ///< what it removed: follows on that of the cut
};

/// One entry a piece, in the order of their numbers. O(cells): the sums are made anew, so that they do not
/// depend on the cuts that led to the pieces, nor differ after a state has been saved and loaded.
std::vector<PieceProperties> measurePieces(const Pieces& pieces, const Assembly& assembly);

/// Cells of the pieces whose volume is below the limit, ascending. The largest piece (the first of equals) is
/// never among them. A limit of 0 keeps all.
std::vector<CellId> findDebris(const PolyhedralMesh& mesh, const Pieces& pieces,
                               const std::vector<PieceProperties>& table, double smallest_volume_m3);

}  // namespace polyscalpel
