// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace polyscalpel {

/// The part of a cell's stiffness that acts on what its mean gradient does not see, in the cell's n - 4
/// non-linear modes H:
///
///   S = (H (x) I) S^ (H (x) I)^T.
///
/// S is zero on linear fields, so nothing is lost, and a cell with five vertices has a matrix of 3 x 3
/// instead of 15 x 15.
struct Stabilisation {
  Eigen::MatrixXd modes;        ///< H, n x m
  Eigen::MatrixXd stiffness;    ///< S^, 3m x 3m [N/m], symmetric, dofs (x0 y0 z0 x1 ...) of the modes
  Eigen::Matrix3Xd rest_modes;  ///< X H, 3 x m [m]; zero but for rounding where H knows no linear fields

  /// A tetrahedron has none.
  bool isEmpty() const { return stiffness.size() == 0; }
  Eigen::Index numModes() const { return modes.cols(); }

  /// S, 3n x 3n [N/m], dofs of the vertices.
  Eigen::MatrixXd matrix() const;

  /// Trace of the 3 x 3 diagonal block of S of one vertex [N/m].
  double traceAt(Eigen::Index vertex) const;
};

/// H: n - 4 orthonormal columns, at right angles to all linear fields of the vertices, by Householder
/// reflections. points: 3 x n, n >= 4, relative to a point near the cell, not all in one plane.
Eigen::MatrixXd nonLinearModes(const Eigen::Ref<const Eigen::Matrix3Xd>& points);

}  // namespace polyscalpel
