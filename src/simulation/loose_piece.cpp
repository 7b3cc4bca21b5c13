// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/loose_piece.hpp"

#include <algorithm>
#include <sstream>

#include <Eigen/Geometry>

namespace polyscalpel {

namespace {

// Fixed vertices hold a piece unless they lie on one line: the triangle of the first, the one farthest from
// it and the one farthest from their line must not be flat.
bool isHeld(const PolyhedralMesh& mesh, const std::vector<VertexId>& held) {
  constexpr double kFlatness = 1e-6;  // height over length of that triangle
  if (held.size() < 3) return false;
  const Eigen::Vector3d first = mesh.restPosition(held.front());
  Eigen::Vector3d longest = Eigen::Vector3d::Zero();
  for (const VertexId vertex : held) {
    const Eigen::Vector3d way = mesh.restPosition(vertex) - first;
    if (way.norm() > longest.norm()) longest = way;
  }
  double height = 0;
  for (const VertexId vertex : held) {
    height = std::max(height, longest.normalized().cross(mesh.restPosition(vertex) - first).norm());
  }
  return height > kFlatness * longest.norm();
}

}  // namespace

std::string findLoosePiece(const PolyhedralMesh& mesh, const std::vector<bool>& fixed) {
  const Pieces pieces = findPieces(mesh);
  std::vector<std::vector<VertexId>> held(pieces.count);
  std::vector<int> num_cells(pieces.count, 0);
  std::vector<CellId> first_cell(pieces.count);
  for (const CellId cell : mesh.cells()) {
    const int piece = pieces.piece_of_cell[cell.index()];
    if (num_cells[piece]++ == 0) first_cell[piece] = cell;
    for (const VertexId vertex : mesh.cell(cell).vertices) {
      if (fixed[vertex.index()]) held[piece].push_back(vertex);
    }
  }
  for (int piece = 0; piece < pieces.count; ++piece) {
    std::sort(held[piece].begin(), held[piece].end());
    held[piece].erase(std::unique(held[piece].begin(), held[piece].end()), held[piece].end());
    if (isHeld(mesh, held[piece])) continue;
    std::ostringstream message;
    message << "piece " << piece << " of " << pieces.count << " (" << num_cells[piece]
            << " cells, the first is cell " << first_cell[piece].index() << ") is free to move: it has "
            << held[piece].size() << " fixed vertices and needs three that are not in line";
    return message.str();
  }
  return {};
}

}  // namespace polyscalpel
