// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/difference_matrix.hpp"
#include "polyscalpel/solver/active_runs.hpp"

namespace polyscalpel {

/// The solutions of the last systems, from which the next one's is guessed: Galerkin's projection on them,
/// x = X y, X^T A X y = X^T b (P. Fischer, "Projection Techniques for Iterative Solution of Ax = b with
/// Successive Right-Hand Sides", 1998). They are forgotten where other vertices are active.
class EarlierSolutions {
 public:
  template <class Scalar>
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  /// Vectors of paddedSize(), zero where no vertex is active.
  template <class Scalar>
  struct Room {
    std::vector<Vector<Scalar>> columns;
    Vector<Scalar> product;
  };

  void clear() { solutions_.clear(); }

  /// x: the guess, zero without any; b, x: of paddedSize(), zero where no vertex is active.
  template <class Scalar>
  void guess(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix,
             const std::vector<int>& active, const ActiveRuns& runs, const Vector<Scalar>& b, int num_threads,
             Room<Scalar>& room, Eigen::VectorXd& x);

  /// Keeps x as the last one, of at most so many.
  void keep(const std::vector<int>& active, const ActiveRuns& runs, const Eigen::VectorXd& x, int most);

 private:
  std::deque<Eigen::VectorXd> solutions_;  // the last first, 3 numbers an active vertex
  std::vector<int> active_;
};

}  // namespace polyscalpel
