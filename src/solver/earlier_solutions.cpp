// SPDX-License-Identifier: BSD-3-Clause
#include "earlier_solutions.hpp"

#include <Eigen/Cholesky>

namespace polyscalpel {

template <class Scalar>
void EarlierSolutions::guess(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix,
                             const std::vector<int>& active, const ActiveRuns& runs, const Vector<Scalar>& b,
                             int num_threads, Room<Scalar>& room, Eigen::VectorXd& x) {
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
    runs.forEach([&](auto run, const auto& column) { run += y[k] * column.template cast<double>(); }, x,
                 room.columns[k]);
  }
}

void EarlierSolutions::keep(const std::vector<int>& active, const ActiveRuns& runs, const Eigen::VectorXd& x,
                            int most) {
  if (most == 0) return;
  if (active_ != active) clear();
  active_ = active;
  if (static_cast<int>(solutions_.size()) >= most) solutions_.pop_back();
  Eigen::VectorXd& kept = solutions_.emplace_front(3 * static_cast<Eigen::Index>(active.size()));
  Eigen::Index place = 0;
  for (const ActiveRuns::Run& run : runs.runs()) {
    kept.segment(place, run.count) = x.segment(run.first, run.count);
    place += run.count;
  }
}

template void EarlierSolutions::guess<float>(const RowPattern&, const DifferenceMatrix<float>&,
                                             const std::vector<int>&, const ActiveRuns&, const Vector<float>&,
                                             int, Room<float>&, Eigen::VectorXd&);
template void EarlierSolutions::guess<double>(const RowPattern&, const DifferenceMatrix<double>&,
                                              const std::vector<int>&, const ActiveRuns&,
                                              const Vector<double>&, int, Room<double>&, Eigen::VectorXd&);

}  // namespace polyscalpel
