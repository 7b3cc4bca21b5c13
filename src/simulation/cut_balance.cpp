// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/cut_balance.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"

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

double sumOfProducts(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return a.cwiseProduct(b).sum();
}

/// Velocities of the vertices of one group, one column each, and how they may be changed.
class GroupMotion {
 public:
  GroupMotion(const std::vector<int>& vertices, const Assembly& assembly, const SimulationState& state)
      : vertices_(vertices), assembly_(assembly), v_(state.velocities(Eigen::all, vertices)) {
    p_ = assembly.hasConsistentMass() ? multiplyFull(state.velocities) : scale(v_);
    free_mass_ = 0;
    for (const int i : vertices) {
      is_free_.push_back(!state.fixed[i]);
      if (is_free_.back()) free_mass_ += assembly.vertexMasses()[i];
    }
  }

  const Eigen::Matrix3Xd& velocities() const { return v_; }
  /// Of these vertices, with all others moving as they do.
  const Eigen::Matrix3Xd& momenta() const { return p_; }
  double freeMass() const { return free_mass_; }

  /// The same vector at the free vertices.
  Eigen::Matrix3Xd uniform(const Eigen::Vector3d& value) const {
    Eigen::Matrix3Xd w = Eigen::Matrix3Xd::Zero(3, v_.cols());
    for (Eigen::Index k = 0; k < w.cols(); ++k) {
      if (is_free_[k]) w.col(k) = value;
    }
    return w;
  }
  /// Velocities of the free vertices, with their mean by mass or without.
  Eigen::Matrix3Xd free(bool with_mean) const {
    Eigen::Matrix3Xd w = uniform(Eigen::Vector3d::Zero());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < w.cols(); ++k) {
      if (!is_free_[k]) continue;
      w.col(k) = v_.col(k);
      sum += assembly_.vertexMasses()[vertices_[k]] * v_.col(k);
    }
    if (!with_mean && free_mass_ > 0) w -= uniform(sum / free_mass_);
    return w;
  }

  /// v += factor w, for a w that is zero outside the group. Returns the gain of kinetic energy [J].
  double add(double factor, const Eigen::Matrix3Xd& w, const Eigen::Matrix3Xd& Mw) {
    const double gain = factor * sumOfProducts(w, p_) + 0.5 * factor * factor * sumOfProducts(w, Mw);
    v_ += factor * w;
    p_ += factor * Mw;
    return gain;
  }

  /// M w at these vertices, for a w that is zero outside the group.
  Eigen::Matrix3Xd multiplyMass(const Eigen::Matrix3Xd& w) const {
    if (!assembly_.hasConsistentMass()) return scale(w);
    Eigen::Matrix3Xd full = Eigen::Matrix3Xd::Zero(3, assembly_.numVertices());
    full(Eigen::all, vertices_) = w;
    return multiplyFull(full);
  }

 private:
  Eigen::Matrix3Xd scale(const Eigen::Matrix3Xd& w) const {
    Eigen::Matrix3Xd result = w;
    for (Eigen::Index k = 0; k < w.cols(); ++k) result.col(k) *= assembly_.vertexMasses()[vertices_[k]];
    return result;
  }
  Eigen::Matrix3Xd multiplyFull(const Eigen::Matrix3Xd& full) const {
    Eigen::Matrix3Xd result;
    assembly_.multiplyMass(full, result);
    return result(Eigen::all, vertices_);
  }

  const std::vector<int>& vertices_;
  const Assembly& assembly_;
  Eigen::Matrix3Xd v_, p_;
  std::vector<bool> is_free_;
  double free_mass_ = 0;
};

/// Smallest e in [0, 1] with excess - slope e + curvature / 2 e^2 <= 0, or nothing. excess > 0.
std::optional<double> shrinkage(double excess, double slope, double curvature) {
  const double discriminant = slope * slope - 2 * curvature * excess;
  if (!(slope > 0) || discriminant < 0) return std::nullopt;
  const double e = 2 * excess / (slope + std::sqrt(discriminant));
  if (e > 1) return std::nullopt;
  return e;
}

}  // namespace

CutLedger::CutLedger(const SimulationState& state, const Assembly& assembly, const MeshChange& change,
                     bool is_moving)
    : elastic_energy_(assembly.elasticEnergy(cellsBefore(change), state.positions)),
      is_moving_(is_moving && !state.velocities.isZero(0)) {
  if (!is_moving_) return;
  masses_ = assembly.vertexMasses();
  if (assembly.hasConsistentMass()) assembly.multiplyMass(state.velocities, momenta_);
}

// The vertices around which something has changed, each group ascending. Vertices belong together that share
// a cell, and so does a new one with those that it was made from; mass stays within a group.
std::vector<std::vector<int>> CutLedger::findGroups(const PolyhedralMesh& mesh, const MeshChange& change,
                                                    const Assembly& assembly) const {
  std::vector<int> vertices, place(mesh.numVertices(), -1);  // place: in `vertices`
  const auto take = [&](int vertex) {
    if (place[vertex] >= 0) return;
    place[vertex] = static_cast<int>(vertices.size());
    vertices.push_back(vertex);
  };
  for (const CellId cell : cellsAfter(change)) {
    for (const VertexId vertex : mesh.cell(cell).vertices) take(vertex.index());
  }
  for (const NewVertex& vertex : change.new_vertices) {
    for (const VertexId parent : vertex.parents) take(parent.index());
  }
  // The mass floor reaches beyond the cells that have changed.
  for (int i = 0; i < static_cast<int>(masses_.size()); ++i) {
    if (assembly.vertexMasses()[i] != masses_[i]) take(i);
  }

  std::vector<int> roots(vertices.size());
  std::iota(roots.begin(), roots.end(), 0);
  const auto find = [&](int i) {
    while (roots[i] != i) i = roots[i] = roots[roots[i]];
    return i;
  };
  const auto join = [&](int vertex, int other) {
    if (place[other] < 0) return;
    const int i = find(place[vertex]), j = find(place[other]);
    roots[std::max(i, j)] = std::min(i, j);
  };
  for (const NewVertex& vertex : change.new_vertices) {
    for (const VertexId parent : vertex.parents) join(vertex.vertex.index(), parent.index());
  }
  for (const int vertex : vertices)
    assembly.forEachNeighbourAbove(vertex, [&](int other) { join(vertex, other); });
  std::map<int, std::vector<int>> groups;
  for (std::size_t i = 0; i < vertices.size(); ++i) groups[find(static_cast<int>(i))].push_back(vertices[i]);
  std::vector<std::vector<int>> result;
  for (auto& [root, group] : groups) {
    std::sort(group.begin(), group.end());
    result.push_back(std::move(group));
  }
  return result;
}

// Corrects the velocities of one group and adds to the balance; see the class.
void CutLedger::settleGroup(const std::vector<int>& vertices, const Assembly& assembly,
                            SimulationState& state, CutBalance& balance) const {
  GroupMotion motion(vertices, assembly, state);
  Eigen::Matrix3Xd before = Eigen::Matrix3Xd::Zero(3, motion.momenta().cols());  // momenta
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const int i = vertices[k];
    if (i >= masses_.size()) continue;
    before.col(k) = assembly.hasConsistentMass() ? Eigen::Vector3d(momenta_.col(i))
                                                 : Eigen::Vector3d(masses_[i] * state.velocities.col(i));
  }
  // A vertex that was there before has the velocity that it had.
  double gain = 0.5 * sumOfProducts(motion.momenta() - before, motion.velocities());
  if (motion.freeMass() > 0) {
    const Eigen::Matrix3Xd increment =
        motion.uniform((before - motion.momenta()).rowwise().sum() / motion.freeMass());
    gain += motion.add(1, increment, motion.multiplyMass(increment));
  }
  for (const bool with_mean : {false, true}) {
    if (!(gain > 0)) break;
    const Eigen::Matrix3Xd w = motion.free(with_mean), Mw = motion.multiplyMass(w);
    const double slope = sumOfProducts(w, motion.momenta()), curvature = sumOfProducts(w, Mw);
    std::optional<double> e = shrinkage(gain, slope, curvature);
    // With a consistent mass there may be none; then the least energy there is.
    if (!e && with_mean) e = curvature > 0 ? std::clamp(slope / curvature, 0.0, 1.0) : 0.0;
    if (!e) continue;
    gain += motion.add(-*e, w, Mw);
    break;
  }
  state.velocities(Eigen::all, vertices) = motion.velocities();
  balance.kinetic_energy_change_j += gain;
  if (assembly.hasConsistentMass()) return;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Eigen::Vector3d difference = motion.momenta().col(k) - before.col(k);
    balance.momentum_change += difference;
    balance.angular_momentum_change += Eigen::Vector3d(state.positions.col(vertices[k])).cross(difference);
  }
}

CutBalance CutLedger::settle(const PolyhedralMesh& mesh, const MeshChange& change, const Assembly& assembly,
                             SimulationState& state) const {
  POLYSCALPEL_ASSERT(state.positions.cols() == assembly.numVertices());
  CutBalance balance;
  balance.elastic_energy_before_j = elastic_energy_;
  balance.elastic_energy_after_j = assembly.elasticEnergy(cellsAfter(change), state.positions);
  if (!is_moving_) return balance;
  for (const std::vector<int>& vertices : findGroups(mesh, change, assembly))
    settleGroup(vertices, assembly, state, balance);
  if (!assembly.hasConsistentMass()) return balance;
  // The momenta of the vertices around the groups have changed too.
  Eigen::Matrix3Xd momenta;
  assembly.multiplyMass(state.velocities, momenta);
  momenta.leftCols(momenta_.cols()) -= momenta_;
  for (Eigen::Index i = 0; i < momenta.cols(); ++i) {
    const Eigen::Vector3d difference = momenta.col(i);
    balance.momentum_change += difference;
    balance.angular_momentum_change += Eigen::Vector3d(state.positions.col(i)).cross(difference);
  }
  return balance;
}

}  // namespace polyscalpel
