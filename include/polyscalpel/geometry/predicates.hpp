// SPDX-License-Identifier: BSD-3-Clause
//
// Exact decisions of the cutting kernel. Ties are broken by one rule: the mesh counts as shifted by (e, e^2,
// e^3), e an infinitesimal, against every blade. That is a real generic position: an edge that passes through
// the seam of two blade triangles crosses exactly one of them, and whatever is decided twice is decided
// alike. J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates",
// 1997; H. Edelsbrunner, E. P. Muecke, "Simulation of Simplicity", 1990.
#pragma once

#include <Eigen/Core>

namespace polyscalpel {

/// Side of the plane on which a mesh point lies: +1 where normal . (point - plane_point) > 0, -1 where it is
/// < 0, and by the shift of the mesh where it is 0. Exact for finite input; 0 only for a zero normal.
int sideOfPlane(const Eigen::Vector3d& mesh_point, const Eigen::Vector3d& plane_point,
                const Eigen::Vector3d& normal);

/// Which of the two belongs to the mesh, and so is shifted.
enum class MeshPart { kSegment, kTriangle };

/// How a segment p -> q crosses a triangle.
struct TriangleCrossing {
  int sign = 0;                  ///< +1 along the triangle's normal, -1 against it, 0: no crossing
  double segment_parameter = 0;  ///< in [0, 1] from p to q, rounded
  Eigen::Vector3d barycentric =
      Eigen::Vector3d::Zero();  ///< of the crossing in the triangle, >= 0, sum 1, rounded
};

/// Crossing of the segment p -> q with the triangle (a, b, c), whose normal is (b - a) x (c - a). The sign is
/// exact for finite input. A triangle of zero normal is never crossed.
TriangleCrossing crossTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& a,
                               const Eigen::Vector3d& b, const Eigen::Vector3d& c, MeshPart mesh_part);

}  // namespace polyscalpel
