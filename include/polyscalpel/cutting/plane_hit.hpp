// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include <Eigen/Core>

#include "polyscalpel/cutting/crossed_edge.hpp"

namespace polyscalpel {

/// Where a plane crosses an edge whose ends a and b [m] it separates. normal: of length 1; side_b: +1 where b
/// lies on the side to which the normal points, else -1. Which side that is has been decided exactly; a
/// distance that rounding has on the other side counts as 0.
inline Hit hitOnPlane(const Edge& edge, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& point, const Eigen::Vector3d& normal, int side_b) {
  const double to_a = std::max(0.0, -side_b * normal.dot(a - point)),
               to_b = std::max(0.0, side_b * normal.dot(b - point));
  const double length = (b - a).norm();
  return {edge, to_a + to_b > 0 ? to_a / (to_a + to_b) : 0.5, side_b,
          length > 0 ? std::abs(normal.dot(b - a)) / length : 1};
}

}  // namespace polyscalpel
