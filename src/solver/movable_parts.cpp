// SPDX-License-Identifier: BSD-3-Clause
#include "movable_parts.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Cholesky>

namespace polyscalpel {

MovableParts::MovableParts(const RowPattern& pattern, const std::vector<int>& movable) {
  std::vector<char> is_movable(pattern.numVertices(), 0);
  for (const int i : movable) is_movable[i] = 1;
  part_of_vertex_.assign(pattern.numVertices(), -1);
  for (const int start : movable) {
    if (part_of_vertex_[start] >= 0) continue;
    const int number = static_cast<int>(parts_.size());
    Part part;
    part.vertices = {start};
    part_of_vertex_[start] = number;
    for (std::size_t k = 0; k < part.vertices.size(); ++k) {
      const RowPattern::Row& row = pattern.rows[part.vertices[k]];
      for (int entry = row.first; entry < row.first + row.count; ++entry) {
        const int other = pattern.column[entry];
        part.is_held = part.is_held || !is_movable[other];
        if (!is_movable[other] || part_of_vertex_[other] >= 0) continue;
        part_of_vertex_[other] = number;
        part.vertices.push_back(other);
      }
    }
    std::sort(part.vertices.begin(), part.vertices.end());
    parts_.push_back(std::move(part));
  }
  if (parts_.size() < 2) part_of_vertex_.clear();
}

// Beside a fixed parent a movable vertex is of the other one's part: all that is movable of a cell is of one.
void MovableParts::follow(const std::vector<AddedVertex>& added, std::vector<int>& part_of_vertex) {
  if (part_of_vertex.empty()) return;
  for (const AddedVertex& vertex : added) {
    const int part = std::max(part_of_vertex[vertex.parents[0]], part_of_vertex[vertex.parents[1]]);
    if (part < 0) return part_of_vertex.clear();
    if (vertex.vertex >= static_cast<int>(part_of_vertex.size()))
      part_of_vertex.resize(vertex.vertex + 1, -1);
    part_of_vertex[vertex.vertex] = part;
  }
}

// Forces within a part add up to nothing, so sum of S_i x_i = sum of b_i, to rounding; a shift makes it so of
// what an iteration has left.
template <class Scalar>
void MovableParts::keepMomentum(const DifferenceMatrix<Scalar>& matrix, const std::vector<int>& active,
                                const Eigen::Matrix3Xd& b, Eigen::Matrix3Xd& x) const {
  if (std::all_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.is_held; })) return;
  std::vector<Eigen::Matrix3d> tied;
  std::vector<int> place(matrix.ties.empty() ? 0 : matrix.masses.size(), -1);
  for (const auto& tie : matrix.ties) {
    if (place[tie.vertex] < 0) {
      place[tie.vertex] = static_cast<int>(tied.size());
      tied.push_back(Eigen::Matrix3d::Zero());
    }
    tied[place[tie.vertex]] += tie.stiffness;
  }
  for (const Part& part : parts_) {
    if (part.is_held) continue;
    if (!std::binary_search(active.begin(), active.end(), part.vertices.front())) continue;  // asleep
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Eigen::Vector3d lacking = Eigen::Vector3d::Zero();
    for (const int i : part.vertices) {
      Eigen::Matrix3d S = matrix.masses[i] * Eigen::Matrix3d::Identity();
      if (!place.empty() && place[i] >= 0) S += tied[place[i]];
      sum += S;
      lacking += b.col(i) - S * x.col(i);
    }
    const Eigen::Vector3d shift = sum.ldlt().solve(lacking);
    if (!shift.allFinite()) continue;
    for (const int i : part.vertices) x.col(i) += shift;
  }
}

template void MovableParts::keepMomentum<float>(const DifferenceMatrix<float>&, const std::vector<int>&,
                                                const Eigen::Matrix3Xd&, Eigen::Matrix3Xd&) const;
template void MovableParts::keepMomentum<double>(const DifferenceMatrix<double>&, const std::vector<int>&,
                                                 const Eigen::Matrix3Xd&, Eigen::Matrix3Xd&) const;

}  // namespace polyscalpel
