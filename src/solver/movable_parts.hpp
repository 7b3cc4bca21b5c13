// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/difference_matrix.hpp"
#include "polyscalpel/solver/added_vertex.hpp"

namespace polyscalpel {

/// Parts of what is movable of a body, each joined through the pattern: systems of equations of their own.
class MovableParts {
 public:
  /// movable: ascending.
  MovableParts(const RowPattern& pattern, const std::vector<int>& movable);

  /// Shifts each part of x, 3 x n, that nothing fixed holds, such that A x = b holds in sum over its
  /// vertices, to rounding. Parts that are not among the active vertices stay as they are.
  template <class Scalar>
  void keepMomentum(const DifferenceMatrix<Scalar>& matrix, const std::vector<int>& active,
                    const Eigen::Matrix3Xd& b, Eigen::Matrix3Xd& x) const;

  /// Number of each vertex's part; -1 for those that are not movable. Empty where there is but one part.
  const std::vector<int>& partOfVertex() const { return part_of_vertex_; }
  /// The same parts with vertices that cuts have added, though they may have divided parts. Empty where it is
  /// not known whose they are.
  static void follow(const std::vector<AddedVertex>& added, std::vector<int>& part_of_vertex);

 private:
  struct Part {
    std::vector<int> vertices;  // ascending
    bool is_held = false;       // by something fixed
  };
  std::vector<Part> parts_;
  std::vector<int> part_of_vertex_;
};

}  // namespace polyscalpel
