// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/simulation/simulation_config.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"

namespace polyscalpel {

/// Which pieces of a body sleep: those of which no vertex has been faster than
/// IntegrationConfig::sleep_speed_m_s for sleep_after_s.
class PieceSleep {
 public:
  explicit PieceSleep(const IntegrationConfig& config) : config_(config) {}

  /// To be called first, with change = nullptr, and after every change of the mesh: pieces with changed or
  /// new cells wake. Marks the vertices of sleeping pieces in the state. pieces: of the mesh as it is now.
  void follow(const PolyhedralMesh& mesh, const Pieces& pieces, const MeshChange* change,
              SimulationState& state);
  /// Wakes the piece of a cell.
  void wake(const Pieces& pieces, CellId cell, SimulationState& state);
  /// After each step: what has been slow for long enough falls asleep, at rest.
  void track(SimulationState& state);

  int numAsleep() const;

 private:
  struct Piece {
    double slow_s = 0;
    bool is_asleep = false;
  };
  void mark(SimulationState& state) const;

  IntegrationConfig config_;
  std::vector<Piece> pieces_;         // by number
  std::vector<int> piece_of_vertex_;  // -1 for a retired vertex
};

}  // namespace polyscalpel
