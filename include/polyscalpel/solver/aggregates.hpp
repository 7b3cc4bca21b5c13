// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/difference_matrix.hpp"
#include "polyscalpel/solver/added_vertex.hpp"
#include "polyscalpel/solver/block_jacobi.hpp"
#include "polyscalpel/solver/held_factor.hpp"
#include "polyscalpel/solver/preconditioner.hpp"

namespace polyscalpel {

/// Parts the active vertices into groups of about `size`, each joined through the pattern, by breadth-first
/// growth; what is left over between groups goes to a neighbour. Returns each vertex's group, -1 where it is
/// not active. num_groups: set.
std::vector<int> makeAggregates(const RowPattern& pattern, const std::vector<int>& active, int size,
                                int& num_groups);

/// Two levels, added up: the matrix's diagonal blocks, and the rigid motions of groups of vertices with the
/// rest shape's matrix turned with each group, P_R R (P^T A_0 P)^-1 R^T P_R^T, P_R the rigid motions of the
/// group as it lies. Made in a fraction of a factor's time, and its cost a vertex does not grow with the
/// body. Rigid motions of sets of cells as a coarse space: T. Joensthoevel, M. van Gijzen, S. MacLachlan, C.
/// Vuik, A. Scarpas, "Comparison of the deflated preconditioned conjugate gradient method and algebraic
/// multigrid for composite materials", 2011.
class AggregatePreconditioner final : public Preconditioner {
 public:
  /// Vertices of a group, of so many that move. Fewer make a larger coarse system and fewer iterations; the
  /// coarse factor grows faster than the body unless groups grow with it.
  static int groupSize(int num_active);

  /// rest_matrix: A_0; rest_positions: 3 x n [m].
  SolveStatus make(const RowPattern& pattern, const DifferenceMatrix<double>& rest_matrix,
                   const Eigen::Ref<const Eigen::Matrix3Xd>& rest_positions, const std::vector<int>& active);

  /// Follows a cut: added vertices, ascending, belong to their nearer parent's group. The cut body's matrix
  /// has all but the same P^T A_0 P: groups that a slit parts move as one, until they are made anew. Returns
  /// whether all could be followed; if not, they are to be made anew at once.
  bool follow(const std::vector<AddedVertex>& added,
              const Eigen::Ref<const Eigen::Matrix3Xd>& rest_positions);

  /// Takes the matrix as it is now and the vertices' rotations, 9 each; the list of active vertices must live
  /// on. What holds points of the body is in both levels. A status other than kSolved: not to be used with
  /// this matrix.
  template <class Scalar>
  SolveStatus update(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix,
                     const std::vector<int>& active, const std::vector<float>& rotations, int num_threads) {
    jacobi_.update(pattern, matrix, active, num_threads);
    active_ = &active;
    turnGroups(rotations);
    return holdCoarse(matrix.holds);
  }
  void apply(const float* residual, float* result) override;

  int numGroups() const { return num_groups_; }

 private:
  void turnGroups(const std::vector<float>& rotations);
  SolveStatus holdCoarse(const std::vector<Hold>& holds);

  BlockJacobi jacobi_;
  HeldFactor coarse_;
  int num_groups_ = 0;
  std::vector<int> group_;            // of each vertex
  std::vector<float> arms_;           // 3 a vertex: from its group's middle, in the group's size
  std::vector<float> turned_arms_;    // as the body lies
  std::vector<int> middle_of_group_;  // a vertex
  Eigen::Matrix3Xd group_middles_;    // in rest shape [m]
  Eigen::VectorXd group_lengths_;     // [m]
  std::vector<float> group_rotations_, coarse_values_;  // 9 and 6 a group
  std::vector<float> group_sums_;  // force and moment, then shift and turn, 4 numbers each
  const std::vector<int>* active_ = nullptr;
};

}  // namespace polyscalpel
