// SPDX-License-Identifier: BSD-3-Clause
//
// The unit cube as a mesh, and blades to draw through it.
#pragma once

#include <Eigen/Geometry>

#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {

/// The cube [0, 1]^3 m of 5 n^3 tetrahedra.
inline PolyhedralMesh unitTets(int n) {
  return makeTetBox(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), Eigen::Vector3i::Constant(n));
}

/// The cube [0, 1]^3 m of n^3 hexahedra.
inline PolyhedralMesh unitHexes(int n) {
  return makeHexBox(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), Eigen::Vector3i::Constant(n));
}

/// A straight blade, 3 x 2 [m], in its tool's frame.
inline Eigen::Matrix3Xd bladeFromTo(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Matrix3Xd edge(3, 2);
  edge << a, b;
  return edge;
}

/// A pose, by its origin [m] and axes.
inline Eigen::Isometry3d at(const Eigen::Vector3d& place,
                            const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity()) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = place;
  T.linear() = axes;
  return T;
}

}  // namespace polyscalpel
