// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/piece_table.hpp"

#include <algorithm>

namespace polyscalpel {

std::vector<PieceProperties> measurePieces(const Pieces& pieces, const Assembly& assembly) {
  std::vector<PieceProperties> table(pieces.count);
  assembly.visitVolumes([&](CellId cell, int kind, double volume_m3) {
    PieceProperties& piece = table[pieces.piece_of_cell[cell.index()]];
    if (piece.num_cells++ == 0) piece.smallest_cell = cell;  // cells ascend
    piece.volume_m3 += volume_m3;
    piece.mass_kg += assembly.kind(kind).material.density_kg_m3 * volume_m3;
  });
  return table;
}

std::vector<CellId> findDebris(const PolyhedralMesh& mesh, const Pieces& pieces,
                               const std::vector<PieceProperties>& table, double smallest_volume_m3) {
  const auto is_smaller = [](const PieceProperties& a, const PieceProperties& b) {
    return a.volume_m3 < b.volume_m3;
  };
  const auto largest = std::max_element(table.begin(), table.end(), is_smaller);
  const auto isDebris = [&](int piece) {
    return table[piece].volume_m3 < smallest_volume_m3 && largest != table.begin() + piece;
  };
  std::vector<CellId> cells;
  bool has_debris = false;
  for (int piece = 0; piece < pieces.count; ++piece) has_debris |= isDebris(piece);
  if (!has_debris) return cells;  // as after most cuts: no look at every cell
  for (const CellId cell : mesh.cells()) {
    if (isDebris(pieces.piece_of_cell[cell.index()])) cells.push_back(cell);
  }
  return cells;
}

}  // namespace polyscalpel
