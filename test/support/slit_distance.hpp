// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "polyscalpel/core/types.hpp"
#include "polyscalpel/geometry/triangle.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {

/// Distance from a point to the nearest face that a cut has opened, in rest shape [m].
inline double distanceToSlit(const PolyhedralMesh& mesh, const Eigen::Vector3d& point) {
  double nearest = kInfinity;
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    const Face& face = mesh.face(FaceId(i));
    if (!face.isAlive() || !face.isBoundary() || face.cut == 0) continue;
    for (int k = 0; k < numTriangles(face); ++k) {
      const Eigen::Matrix3d corners = triangleCorners(face, k, mesh.restPositions());
      nearest = std::min(nearest, std::sqrt(closestPointOnTriangle(point, corners).squared_distance));
    }
  }
  return nearest;
}

}  // namespace polyscalpel
