// SPDX-License-Identifier: BSD-3-Clause
//
// Extreme eigenvalues by the method of C. Lanczos, "An Iteration Method for the Solution of the Eigenvalue
// Problem of Linear Differential and Integral Operators", 1950. Without reorthogonalisation: that only
// repeats values, and the largest one stays what it is.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/block_matrix.hpp"

namespace polyscalpel::report {

/// Largest eigenvalue of a symmetric operator on fields (3 x n) that are zero at the fixed vertices, from
/// below, after at most `iterations` products or once it changes by less than 1e-6 of itself.
double largestEigenvalue(const std::function<Eigen::Matrix3Xd(const Eigen::Matrix3Xd&)>& product,
                         const std::vector<bool>& fixed, int iterations);

/// The spectrum of a stiffness without its fixed rows and columns.
struct Spectrum {
  double condition = 0;      ///< largest over smallest eigenvalue of K
  double stable_step_s = 0;  ///< 2 / sqrt(largest eigenvalue of M^-1 K): the longest explicit step
  std::string message;       ///< why there is no value; empty: all is well
};

/// masses: of each vertex, > 0 [kg].
Spectrum findSpectrum(const BlockPattern& pattern, const Blocks& stiffness, const Eigen::VectorXd& masses,
                      const std::vector<bool>& fixed);

}  // namespace polyscalpel::report
