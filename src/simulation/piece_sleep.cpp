// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/piece_sleep.hpp"

#include <algorithm>

namespace polyscalpel {

void PieceSleep::follow(const PolyhedralMesh& mesh, const Pieces& pieces, const MeshChange* change,
                        SimulationState& state) {
  const std::vector<Piece> before = pieces_;
  pieces_.assign(pieces.count, Piece());
  piece_of_vertex_.assign(mesh.numVertices(), -1);
  for (const CellId cell : mesh.cells()) {
    for (const VertexId vertex : mesh.cell(cell).vertices)
      piece_of_vertex_[vertex.index()] = pieces.piece_of_cell[cell.index()];
  }
  if (!change || state.asleep.empty()) {
    state.asleep.clear();
    return;
  }
  // A piece whose vertices have all slept goes on: numbers may have changed hands.
  const std::size_t num_before = state.asleep.size();
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    pieces_[k].is_asleep = true;
    if (k < before.size()) pieces_[k].slow_s = before[k].slow_s;
  }
  for (std::size_t i = 0; i < piece_of_vertex_.size(); ++i) {
    if (piece_of_vertex_[i] >= 0 && (i >= num_before || !state.asleep[i]))
      pieces_[piece_of_vertex_[i]].is_asleep = false;
  }
  const auto wakeCell = [&](CellId cell) { pieces_[pieces.piece_of_cell[cell.index()]] = Piece(); };
  for (const CellId cell : change->changed_cells) wakeCell(cell);
  for (const NewCell& cell : change->new_cells) wakeCell(cell.cell);
  mark(state);
}

void PieceSleep::wake(const Pieces& pieces, CellId cell, SimulationState& state) {
  Piece& piece = pieces_[pieces.piece_of_cell[cell.index()]];
  piece.slow_s = 0;
  if (!piece.is_asleep) return;
  piece.is_asleep = false;
  mark(state);
}

void PieceSleep::track(SimulationState& state) {
  const double limit = config_.sleep_speed_m_s * config_.sleep_speed_m_s;
  std::vector<char> is_slow(pieces_.size(), 1);
  for (std::size_t i = 0; i < piece_of_vertex_.size(); ++i) {
    const int piece = piece_of_vertex_[i];
    if (piece >= 0 && state.velocities.col(static_cast<Eigen::Index>(i)).squaredNorm() > limit)
      is_slow[piece] = 0;
  }
  bool any = false;
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    Piece& piece = pieces_[k];
    if (piece.is_asleep) continue;
    piece.slow_s = is_slow[k] ? piece.slow_s + config_.time_step_s : 0;
    piece.is_asleep = is_slow[k] && piece.slow_s >= config_.sleep_after_s;
    any = any || piece.is_asleep;
  }
  if (any) mark(state);
}

void PieceSleep::mark(SimulationState& state) const {
  state.asleep.assign(piece_of_vertex_.size(), 0);
  for (std::size_t i = 0; i < piece_of_vertex_.size(); ++i) {
    if (piece_of_vertex_[i] < 0 || !pieces_[piece_of_vertex_[i]].is_asleep) continue;
    state.asleep[i] = 1;
    state.velocities.col(static_cast<Eigen::Index>(i)).setZero();
  }
}

int PieceSleep::numAsleep() const {
  return static_cast<int>(
      std::count_if(pieces_.begin(), pieces_.end(), [](const Piece& piece) { return piece.is_asleep; }));
}

}  // namespace polyscalpel
