// SPDX-License-Identifier: BSD-3-Clause
#include "free_parts.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Cholesky>

namespace polyscalpel {

FreeParts::FreeParts(const RowPattern& pattern, const std::vector<int>& movable) {
  std::vector<char> is_movable(pattern.numVertices(), 0), is_seen(pattern.numVertices(), 0);
  for (const int i : movable) is_movable[i] = 1;
  for (const int start : movable) {
    if (is_seen[start]) continue;
    std::vector<int> part = {start};
    is_seen[start] = 1;
    bool is_held = false;
    for (std::size_t k = 0; k < part.size(); ++k) {
      const RowPattern::Row& row = pattern.rows[part[k]];
      for (int entry = row.first; entry < row.first + row.count; ++entry) {
        const int other = pattern.column[entry];
        is_held = is_held || !is_movable[other];
        if (!is_movable[other] || is_seen[other]) continue;
        is_seen[other] = 1;
        part.push_back(other);
      }
    }
    if (is_held) continue;
    std::sort(part.begin(), part.end());
    parts_.push_back(std::move(part));
  }
}

// Forces within a part add up to nothing, so sum of S_i x_i = sum of b_i, to rounding; a shift makes it so of
// what an iteration has left.
template <class Scalar>
void FreeParts::keepMomentum(const DifferenceMatrix<Scalar>& matrix, const std::vector<int>& active,
                             const Eigen::Matrix3Xd& b, Eigen::Matrix3Xd& x) const {
  if (parts_.empty()) return;
  std::vector<Eigen::Matrix3d> tied;
  std::vector<int> place(matrix.ties.empty() ? 0 : matrix.masses.size(), -1);
  for (const auto& tie : matrix.ties) {
    if (place[tie.vertex] < 0) {
      place[tie.vertex] = static_cast<int>(tied.size());
      tied.push_back(Eigen::Matrix3d::Zero());
    }
    tied[place[tie.vertex]] += tie.stiffness;
  }
  for (const std::vector<int>& part : parts_) {
    if (!std::binary_search(active.begin(), active.end(), part.front())) continue;  // asleep
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Eigen::Vector3d lacking = Eigen::Vector3d::Zero();
    for (const int i : part) {
      Eigen::Matrix3d S = matrix.masses[i] * Eigen::Matrix3d::Identity();
      if (!place.empty() && place[i] >= 0) S += tied[place[i]];
      sum += S;
      lacking += b.col(i) - S * x.col(i);
    }
    const Eigen::Vector3d shift = sum.ldlt().solve(lacking);
    if (!shift.allFinite()) continue;
    for (const int i : part) x.col(i) += shift;
  }
}

template void FreeParts::keepMomentum<float>(const DifferenceMatrix<float>&, const std::vector<int>&,
                                             const Eigen::Matrix3Xd&, Eigen::Matrix3Xd&) const;
template void FreeParts::keepMomentum<double>(const DifferenceMatrix<double>&, const std::vector<int>&,
                                              const Eigen::Matrix3Xd&, Eigen::Matrix3Xd&) const;

}  // namespace polyscalpel
