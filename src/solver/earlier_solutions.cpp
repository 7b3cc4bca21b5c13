// SPDX-License-Identifier: BSD-3-Clause
#include "earlier_solutions.hpp"

#include <Eigen/Cholesky>

namespace polyscalpel {

template <class Scalar>
void EarlierSolutions::guess(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix,
                             const std::vector<int>& active, const ActiveRuns& runs, const Vector<Scalar>& b,
                             int num_threads, Room<Scalar>& room, Vector<Scalar>& x) {
  runs.forEach([](auto run) { run.setZero(); }, x);
  if (active_ != active) clear();
  const int count = static_cast<int>(solutions_.size());
  if (count == 0) return;
  Eigen::MatrixXd gram(count, count);
  Eigen::VectorXd right(count);
  if (static_cast<int>(room.columns.size()) < count) room.columns.resize(count);
  if (room.product.size() != b.size()) room.product.setZero(b.size());
  for (int k = 0; k < count; ++k) {
    Vector<Scalar>& column = room.columns[k];
    if (column.size() != b.size()) column.setZero(b.size());
    Eigen::Index place = 0;
    for (const ActiveRuns::Run& run : runs.runs()) {
      column.segment(run.first, run.count) = solutions_[k].segment(place, run.count).template cast<Scalar>();
      place += run.count;
    }
    multiply(pattern, matrix, active, column.data(), room.product.data(), num_threads);
    for (int l = 0; l <= k; ++l) gram(k, l) = gram(l, k) = runs.dot(room.columns[l], room.product);
    right[k] = runs.dot(column, b);
  }
  gram.diagonal() *= 1 + 1e-7;  // solutions may be all but parallel
  const Eigen::VectorXd y = gram.ldlt().solve(right);
  if (!y.allFinite()) return;
  for (int k = 0; k < count; ++k) {
    const Scalar part = static_cast<Scalar>(y[k]);
    runs.forEach([&](auto run, const auto& column) { run += part * column; }, x, room.columns[k]);
  }
}

template <class Scalar>
void EarlierSolutions::keep(const std::vector<int>& active, const ActiveRuns& runs, const Vector<Scalar>& x,
                            int most) {
  if (most == 0) return;
  if (active_ != active) clear();
  active_ = active;
  if (static_cast<int>(solutions_.size()) >= most) solutions_.pop_back();
  Eigen::VectorXd& kept = solutions_.emplace_front(3 * static_cast<Eigen::Index>(active.size()));
  Eigen::Index place = 0;
  for (const ActiveRuns::Run& run : runs.runs()) {
    kept.segment(place, run.count) = x.segment(run.first, run.count).template cast<double>();
    place += run.count;
  }
}

template void EarlierSolutions::guess<float>(const RowPattern&, const DifferenceMatrix<float>&,
                                             const std::vector<int>&, const ActiveRuns&, const Vector<float>&,
                                             int, Room<float>&, Vector<float>&);
template void EarlierSolutions::guess<double>(const RowPattern&, const DifferenceMatrix<double>&,
                                              const std::vector<int>&, const ActiveRuns&,
                                              const Vector<double>&, int, Room<double>&, Vector<double>&);
template void EarlierSolutions::keep<float>(const std::vector<int>&, const ActiveRuns&, const Vector<float>&,
                                            int);
template void EarlierSolutions::keep<double>(const std::vector<int>&, const ActiveRuns&,
                                             const Vector<double>&, int);

}  // namespace polyscalpel
