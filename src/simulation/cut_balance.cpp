// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/cut_balance.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"

namespace polyscalpel {

namespace {

std::vector<CellId> cellsBefore(const MeshChange& change) {
  std::vector<CellId> cells = change.removed_cells;
  cells.insert(cells.end(), change.changed_cells.begin(), change.changed_cells.end());
  return cells;
}

std::vector<CellId> cellsAfter(const MeshChange& change) {
  std::vector<CellId> cells = change.changed_cells;
  for (const NewCell& cell : change.new_cells) cells.push_back(cell.cell);
  return cells;
}

double sumOfProducts(const std::vector<int>& vertices, const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  double sum = 0;
  for (const int i : vertices) sum += a.col(i).dot(b.col(i));
  return sum;
}

/// Smallest e in [0, 1] with excess - slope e + curvature / 2 e^2 <= 0, or nothing.
std::optional<double> shrinkage(double excess, double slope, double curvature) {
  const double discriminant = slope * slope - 2 * curvature * excess;
  if (!(slope > 0) || discriminant < 0) return std::nullopt;
  const double e = 2 * excess / (slope + std::sqrt(discriminant));
  if (e > 1) return std::nullopt;
  return e;
}

}  // namespace

CutLedger::CutLedger(const SimulationState& state, const Assembly& assembly, const MeshChange& change,
                     const Pieces& pieces, bool is_moving)
    : elastic_energy_(assembly.elasticEnergy(cellsBefore(change), state.positions)),
      is_moving_(is_moving && !state.velocities.isZero(0)) {
  if (!is_moving_) return;
  piece_of_cell_ = pieces.piece_of_cell;
  masses_ = assembly.vertexMasses();
  velocities_ = state.velocities;
  assembly.multiplyMass(velocities_, momenta_);
}

// The free vertices around which something has changed, ascending, by the piece that they were in.
std::vector<std::vector<int>> CutLedger::findGroups(const PolyhedralMesh& mesh, const MeshChange& change,
                                                    const Assembly& assembly) const {
  std::map<int, std::vector<int>> groups;
  std::vector<char> is_taken(mesh.numVertices(), 0);
  const auto take = [&](int piece, int vertex) {
    if (!is_taken[vertex]) groups[piece].push_back(vertex);
    is_taken[vertex] = 1;
  };
  const auto takeCell = [&](int piece, CellId cell) {
    for (const VertexId vertex : mesh.cell(cell).vertices) take(piece, vertex.index());
  };
  for (const CellId cell : change.changed_cells) takeCell(piece_of_cell_[cell.index()], cell);
  for (const NewCell& cell : change.new_cells) takeCell(piece_of_cell_[cell.parent.index()], cell.cell);
  // The mass floor reaches beyond the cells that have changed, and so does a vertex whose copy left it.
  for (int i = 0; i < static_cast<int>(masses_.size()); ++i) {
    if (is_taken[i] || assembly.vertexMasses()[i] == masses_[i]) continue;
    take(piece_of_cell_[cellsAround(mesh, VertexId(i)).front().index()], i);
  }
  std::vector<std::vector<int>> result;
  for (auto& [piece, vertices] : groups) {
    std::sort(vertices.begin(), vertices.end());
    result.push_back(std::move(vertices));
  }
  return result;
}

void CutLedger::correctVelocities(const std::vector<std::vector<int>>& groups, const Assembly& assembly,
                                  SimulationState& state) const {
  const Eigen::VectorXd& masses = assembly.vertexMasses();
  const Eigen::Index num_before = masses_.size();
  Eigen::Matrix3Xd& v = state.velocities;
  Eigen::Matrix3Xd momenta, increments = Eigen::Matrix3Xd::Zero(3, v.cols()), increment_momenta;
  assembly.multiplyMass(v, momenta);
  std::vector<double> excess(groups.size(), 0);  // of kinetic energy [J]
  std::vector<std::vector<int>> free(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    Eigen::Vector3d missing = Eigen::Vector3d::Zero();
    double mass = 0;
    for (const int i : groups[g]) {
      missing -= momenta.col(i);
      excess[g] += 0.5 * momenta.col(i).dot(v.col(i));
      if (i < num_before) {
        missing += momenta_.col(i);
        excess[g] -= 0.5 * momenta_.col(i).dot(velocities_.col(i));
      }
      if (state.fixed[i]) continue;
      free[g].push_back(i);
      mass += masses[i];
    }
    if (!(mass > 0)) continue;
    for (const int i : free[g]) increments.col(i) = missing / mass;
  }
  assembly.multiplyMass(increments, increment_momenta);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    excess[g] += sumOfProducts(free[g], increments, momenta) +
                 0.5 * sumOfProducts(free[g], increments, increment_momenta);
  }
  v += increments;
  momenta += increment_momenta;

  // Takes w away from the velocities by the part that the energy asks for. Pieces share no cell, so that
  // their energies do not depend on each other.
  Eigen::Matrix3Xd w = Eigen::Matrix3Xd::Zero(3, v.cols()), w_momenta;
  const auto shrink = [&](const auto& setDifference, const auto& apply) {
    bool any = false;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (!(excess[g] > 0)) continue;
      setDifference(free[g]);
      any = true;
    }
    if (!any) return;
    assembly.multiplyMass(w, w_momenta);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (!(excess[g] > 0)) continue;
      const double slope = sumOfProducts(free[g], w, momenta),
                   curvature = sumOfProducts(free[g], w, w_momenta);
      apply(g, shrinkage(excess[g], slope, curvature), slope, curvature);
    }
  };
  const auto reduce = [&](std::size_t g, double e) {
    for (const int i : free[g]) v.col(i) -= e * w.col(i);
    excess[g] = 0;
  };
  shrink(
      [&](const std::vector<int>& vertices) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        double mass = 0;
        for (const int i : vertices) {
          sum += masses[i] * v.col(i);
          mass += masses[i];
        }
        for (const int i : vertices) w.col(i) = v.col(i) - sum / mass;
      },
      [&](std::size_t g, const std::optional<double>& e, double, double) {
        if (e) reduce(g, *e);
      });
  shrink(
      [&](const std::vector<int>& vertices) {
        for (const int i : vertices) w.col(i) = v.col(i);
      },
      [&](std::size_t g, const std::optional<double>& e, double slope, double curvature) {
        // None: only with a consistent mass; the least energy there is then.
        reduce(g, e ? *e : curvature > 0 ? std::clamp(slope / curvature, 0.0, 1.0) : 0);
      });
}

CutBalance CutLedger::settle(const PolyhedralMesh& mesh, const MeshChange& change, const Assembly& assembly,
                             SimulationState& state) const {
  POLYSCALPEL_ASSERT(state.positions.cols() == assembly.numVertices());
  CutBalance balance;
  balance.elastic_energy_before_j = elastic_energy_;
  balance.elastic_energy_after_j = assembly.elasticEnergy(cellsAfter(change), state.positions);
  if (!is_moving_) return balance;
  correctVelocities(findGroups(mesh, change, assembly), assembly, state);
  Eigen::Matrix3Xd momenta;
  assembly.multiplyMass(state.velocities, momenta);
  for (Eigen::Index i = 0; i < momenta.cols(); ++i) {
    const bool is_new = i >= masses_.size();
    const Eigen::Vector3d before = is_new ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(momenta_.col(i));
    const Eigen::Vector3d difference = momenta.col(i) - before;
    balance.momentum_change += difference;
    balance.angular_momentum_change += Eigen::Vector3d(state.positions.col(i)).cross(difference);
    balance.kinetic_energy_change_j += 0.5 * momenta.col(i).dot(state.velocities.col(i));
    if (!is_new) balance.kinetic_energy_change_j -= 0.5 * before.dot(velocities_.col(i));
  }
  return balance;
}

}  // namespace polyscalpel
