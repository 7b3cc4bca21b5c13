// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include "polyscalpel/solver/single_factor.hpp"

namespace polyscalpel {

/// A factor of A_0 that solves with A_0 + T too, T positive semidefinite at few nodes that come and go
/// (M. Woodbury, "Inverting Modified Matrices", 1950):
///
///   x = z - A_0^-1 T (I + G T)^-1 z,  z = A_0^-1 b,  G = A_0^-1 at the nodes of T.
///
/// Columns of A_0^-1 are kept, so that what stays near where it was costs no solves. A node is 3 numbers.
class HeldFactor {
 public:
  /// A point's value is the sum of J^T x at some nodes, none of which is fixed.
  struct Part {
    int node = 0;
    Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  };
  struct HeldPoint {
    std::vector<Part> parts;
    Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();  ///< symmetric positive semidefinite
  };

  HeldFactor() = default;
  HeldFactor(SingleFactor factor, int num_nodes);

  /// T from now on, the sum over the points of J stiffness J^T. Where a stiffness is not positive
  /// semidefinite, the nodes are too many or the numbers beyond this precision, nothing is held and the
  /// status is not kSolved.
  SolveStatus hold(const std::vector<HeldPoint>& points);

  /// x in place of b.
  void solve(float* values);

 private:
  const std::vector<float>& columnsOf(int node);
  void makeRoom();

  SingleFactor factor_;
  int num_nodes_ = 0;
  std::vector<int> place_of_node_;           // in columns_, -1 where there are none
  std::vector<std::vector<float>> columns_;  // of a node: three columns of A_0^-1 side by side
  std::vector<int> nodes_;                   // of T, ascending
  Eigen::MatrixXd stiffness_;                // T, at nodes_
  Eigen::PartialPivLU<Eigen::MatrixXd> inner_;
  Eigen::VectorXd inner_values_;
  std::vector<float> loads_;  // at all nodes
};

}  // namespace polyscalpel
