// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

namespace polyscalpel {

/// Runs of consecutive vertices among the active ones. Where most of a body is fixed or asleep, vectors of 3
/// numbers a vertex are gone through by these alone; all else of them is zero and stays so.
class ActiveRuns {
 public:
  struct Run {
    Eigen::Index first = 0, count = 0;  ///< of numbers
  };

  /// active: ascending. Returns whether they are others than before.
  bool set(const std::vector<int>& active) {
    if (is_set_ && active == active_) return false;
    is_set_ = true;
    active_ = active;
    runs_.clear();
    for (const int i : active_) {
      if (!runs_.empty() && runs_.back().first + runs_.back().count == 3 * i) {
        runs_.back().count += 3;
      } else {
        runs_.push_back({3 * static_cast<Eigen::Index>(i), 3});
      }
    }
    return true;
  }

  const std::vector<Run>& runs() const { return runs_; }

  /// visit(segment of each vector), run by run.
  template <class Visit, class... Vectors>
  void forEach(const Visit& visit, Vectors&&... vectors) const {
    for (const Run& run : runs_) visit(vectors.segment(run.first, run.count)...);
  }

  /// a . b in double precision, in a fixed order: eight sums side by side.
  template <class Scalar>
  double dot(const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& a,
             const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& b) const {
    double sums[8] = {0, 0, 0, 0, 0, 0, 0, 0};
    for (const Run& run : runs_) {
      const Scalar* const x = a.data() + run.first;
      const Scalar* const y = b.data() + run.first;
      const Eigen::Index whole = run.count / 8 * 8;
      for (Eigen::Index i = 0; i < whole; i += 8) {
        for (int k = 0; k < 8; ++k) sums[k] += static_cast<double>(x[i + k]) * static_cast<double>(y[i + k]);
      }
      for (Eigen::Index i = whole; i < run.count; ++i)
        sums[i - whole] += static_cast<double>(x[i]) * static_cast<double>(y[i]);
    }
    return ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
  }

 private:
  bool is_set_ = false;
  std::vector<int> active_;
  std::vector<Run> runs_;
};

}  // namespace polyscalpel
