// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/difference_matrix.hpp"

namespace polyscalpel {

/// Parts of a body that nothing fixed holds, each joined through the pattern.
class FreeParts {
 public:
  /// movable: ascending.
  FreeParts(const RowPattern& pattern, const std::vector<int>& movable);

  /// Shifts each part of x, 3 x n, such that A x = b holds in sum over its vertices, to rounding. Parts that
  /// are not among the active vertices stay as they are.
  template <class Scalar>
  void keepMomentum(const DifferenceMatrix<Scalar>& matrix, const std::vector<int>& active,
                    const Eigen::Matrix3Xd& b, Eigen::Matrix3Xd& x) const;

 private:
  std::vector<std::vector<int>> parts_;  // vertices, ascending
};

}  // namespace polyscalpel
