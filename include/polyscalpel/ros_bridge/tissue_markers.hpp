// SPDX-License-Identifier: BSD-3-Clause
//
// Triangles, edges and labels of the tissue for rviz. rviz lights a TRIANGLE_LIST only when it has no colours
// of its own, and then each triangle flat; so the light is computed here, smoothly, and put into the colours
// of the triangles' corners.
#pragma once

#include <vector>

#include <visualization_msgs/Marker.h>
#include <Eigen/Core>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Where a boundary triangle comes from.
struct TriangleOrigin {
  FaceId face;
  int index = 0;  ///< of the face's triangles (surface.hpp)
};

/// Boundary triangles of the tissue, without those that have no area (rviz garbles them).
struct SurfaceTriangles {
  std::vector<Eigen::Matrix3d> corners;  ///< one column a corner [m], counter-clockwise seen from outside
  std::vector<Eigen::Matrix3d>
      normals;                          ///< at the corners, unit, smooth across edges of less than 50 degrees
  std::vector<TriangleOrigin> origins;  ///< empty for loose triangles
};

/// Triangles of the boundary faces that a cut made, or of all others. positions: 3 x n, one column per vertex
/// [m].
SurfaceTriangles makeSurfaceTriangles(const PolyhedralMesh& mesh,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& positions, bool cut_faces);

/// The same for loose triangles: 3 x 3k [m], three columns a triangle; corners at equal points are joined.
SurfaceTriangles makeSurfaceTriangles(const Eigen::Ref<const Eigen::Matrix3Xd>& triangles);

/// Light that falls on a surface of the given unit normal, in [0, 1]: sky and ground, and a lamp above one's
/// shoulder.
double lightOn(const Eigen::Vector3d& normal);

/// A TRIANGLE_LIST with lit colours; header, namespace and id are the caller's.
visualization_msgs::Marker makeTriangleMarker(const SurfaceTriangles& triangles, const Eigen::Vector4d& rgba);

/// A LINE_LIST of the edges of all boundary faces, each once.
visualization_msgs::Marker makeWireframeMarker(const PolyhedralMesh& mesh,
                                               const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

/// A SPHERE_LIST of the given diameter [m] at the points, 3 x n [m]; header, namespace, id and colour are the
/// caller's.
visualization_msgs::Marker makePointMarker(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                           double diameter_m);

/// What a label tells of a piece.
struct PieceSummary {
  double volume_m3 = 0;                                   ///< in the given positions
  Eigen::Vector3d label_point = Eigen::Vector3d::Zero();  ///< above the middle of its top [m]
};

/// One summary a piece, in the order of their numbers.
std::vector<PieceSummary> summarisePieces(const PolyhedralMesh& mesh, const Pieces& pieces,
                                          const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

}  // namespace polyscalpel
