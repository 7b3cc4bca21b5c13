// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/natural_spline.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace polyscalpel {

NaturalSpline::NaturalSpline(std::vector<double> times_s, const Eigen::Ref<const Eigen::Matrix3Xd>& points)
    : times_s_(std::move(times_s)), points_(points) {
  const auto n = static_cast<Eigen::Index>(times_s_.size());
  if (n < 2)
    throw std::invalid_argument("times_s has " + std::to_string(n) + " entries: must have at least 2");
  if (points.cols() != n)
    throw std::invalid_argument("points has " + std::to_string(points.cols()) +
                                " columns: must have one a time");
  if (!points.allFinite()) throw std::invalid_argument("points: every component must be finite");
  for (std::size_t i = 0; i < times_s_.size(); ++i)
    if (!std::isfinite(times_s_[i]) || (i > 0 && times_s_[i] <= times_s_[i - 1]))
      throw std::invalid_argument("times_s[" + std::to_string(i) + "] = " + std::to_string(times_s_[i]) +
                                  ": times must be finite and rise");

  // Continuity of the first derivative at each inner point i, with d_i = t_{i+1} - t_i and second derivatives
  // m: d_{i-1} m_{i-1} + 2 (d_{i-1} + d_i) m_i + d_i m_{i+1} = 6 (slope_i - slope_{i-1}); solved by Thomas'
  // algorithm.
  second_derivatives_ = Eigen::Matrix3Xd::Zero(3, n);
  const auto length = [&](Eigen::Index i) {
    return times_s_[static_cast<std::size_t>(i + 1)] - times_s_[static_cast<std::size_t>(i)];
  };
  const auto slope = [&](Eigen::Index i) {
    return Eigen::Vector3d((points_.col(i + 1) - points_.col(i)) / length(i));
  };
  std::vector<double> upper(static_cast<std::size_t>(n), 0);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const double pivot =
        2 * (length(i - 1) + length(i)) - length(i - 1) * upper[static_cast<std::size_t>(i - 1)];
    upper[static_cast<std::size_t>(i)] = length(i) / pivot;
    second_derivatives_.col(i) =
        (6 * (slope(i) - slope(i - 1)) - length(i - 1) * second_derivatives_.col(i - 1)) / pivot;
  }
  for (Eigen::Index i = n - 2; i >= 1; --i)
    second_derivatives_.col(i) -= upper[static_cast<std::size_t>(i)] * second_derivatives_.col(i + 1);
}

Eigen::Vector3d NaturalSpline::at(double time_s) const {
  if (time_s <= times_s_.front()) return points_.col(0);
  if (time_s >= times_s_.back()) return points_.col(points_.cols() - 1);
  const auto next = std::upper_bound(times_s_.begin(), times_s_.end(), time_s);
  const Eigen::Index i = next - times_s_.begin() - 1;
  const double length = *next - *(next - 1);
  const double b = (time_s - *(next - 1)) / length;
  const double a = 1 - b;
  return a * points_.col(i) + b * points_.col(i + 1) +
         length * length / 6 *
             ((a * a * a - a) * second_derivatives_.col(i) +
              (b * b * b - b) * second_derivatives_.col(i + 1));
}

}  // namespace polyscalpel
