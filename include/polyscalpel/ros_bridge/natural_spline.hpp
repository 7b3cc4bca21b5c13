// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

namespace polyscalpel {

/// The natural cubic spline through points at given times: twice continuously differentiable, its second
/// derivative zero at both ends (de Boor, "A Practical Guide to Splines", 1978, chapter 4). Two points give a
/// straight line.
class NaturalSpline {
 public:
  /// times_s: at least 2, rising; points: 3 x n, one column a time. Throws std::invalid_argument.
  NaturalSpline(std::vector<double> times_s, const Eigen::Ref<const Eigen::Matrix3Xd>& points);

  /// Point at a time; before the first and after the last time the end points.
  Eigen::Vector3d at(double time_s) const;

 private:
  std::vector<double> times_s_;
  Eigen::Matrix3Xd points_;
  Eigen::Matrix3Xd second_derivatives_;  // 3 x n, one column a time [m/s^2]
};

}  // namespace polyscalpel
