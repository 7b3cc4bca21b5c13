// SPDX-License-Identifier: BSD-3-Clause
//
// The one surface model. A face whose loop has three vertices is that triangle. Any other face is a fan of
// triangles around a virtual vertex, the mean of the face's corners (Face::is_corner), whose value is the
// mean of their values. It depends on the face alone, so both cells agree on it, and it bears faces that are
// not planar and vertices that hang in an edge. Volume, mean value coordinates, quadrature, contact and
// markers all use this surface.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include <boost/container/small_vector.hpp>

#include <Eigen/Core>

#include "polyscalpel/core/types.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Number of triangles of a face: 1 for three vertices, else one for each loop entry.
int numTriangles(const Face& face);

/// The virtual vertex of a face: mean of its corners [m]. positions: 3 x n, one column per vertex.
Eigen::Vector3d virtualVertex(const Face& face, const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

/// Corners of the i-th triangle of a face, one column each [m], counter-clockwise as the loop is. For a fan:
/// the virtual vertex, loop[i], loop[i + 1].
Eigen::Matrix3d triangleCorners(const Face& face, int i, const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

/// Calls visit(corners) with triangleCorners() of each triangle in turn, until it returns false. Returns
/// whether it went through all. Computes the virtual vertex once.
template <class Visit>
bool visitTriangles(const Face& face, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                    const Visit& visit);

/// A point and the area vector [m, m^2] of a face: its mean plane. Outward for face.cells[0].
std::pair<Eigen::Vector3d, Eigen::Vector3d> planeOf(const Face& face,
                                                    const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

/// A point on the surface as a weighted mean of mesh vertices.
struct WeightedVertex {
  VertexId vertex;
  double weight = 0;
};

/// Weights on the face's vertices of a point with the given barycentric coordinates in the i-th triangle. The
/// virtual vertex hands its share in equal parts to the corners. Each vertex occurs once; the weights sum to
/// the coordinates' sum.
std::vector<WeightedVertex> vertexWeights(const Face& face, int i, const Eigen::Vector3d& barycentric);

/// The closed triangle surface of one cell, in local indices.
struct CellSurface {
  Eigen::Matrix3Xd points;  ///< 3 x (n + m) [m]: the cell's n vertices in the order of Cell::vertices,
                            ///< then one virtual vertex for each of its m faces that are fans
  int num_vertices = 0;     ///< n
  std::vector<std::array<int, 3>> triangles;  ///< outward, indices into points
  /// For each virtual vertex the local vertices whose mean it is.
  std::vector<boost::container::small_vector<int, 6>> parents;

  bool isTetrahedron() const { return num_vertices == 4 && triangles.size() == 4; }
};

/// The surface of a cell in the given positions (3 x number of mesh vertices, one column per vertex [m]).
CellSurface makeCellSurface(const PolyhedralMesh& mesh, CellId cell,
                            const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

/// Volume [m^3], positive for outward triangles.
double volume(const CellSurface& surface);

/// Apex of the cell's sub-tets [m]: a point that sees the whole surface from within. The mean of the n
/// vertices wherever it lies well inside, as in every convex cell that is not crowded with vertices on one
/// side; else the point found furthest inside all triangles' planes (relaxation method, Agmon 1954, Motzkin
/// and Schoenberg 1954), which for a cell that is not star-shaped sees only part of the surface.
Eigen::Vector3d starCentre(const CellSurface& surface);

/// The same of any closed surface of outward triangles, one a matrix, corners in columns [m]; start: where to
/// look first, and the result where it lies well inside.
Eigen::Vector3d starCentre(const std::vector<Eigen::Matrix3d>& triangles, const Eigen::Vector3d& start);

/// Smallest volume of the tetrahedra (starCentre, surface triangle) [m^3]; positive for a star-shaped cell.
double smallestSubTetVolume(const CellSurface& surface);

/// Volume of the whole mesh in the given positions [m^3].
double volume(const PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

template <class Visit>
bool visitTriangles(const Face& face, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                    const Visit& visit) {
  if (numTriangles(face) == 1) return visit(triangleCorners(face, 0, positions));
  Eigen::Matrix3d corners;
  corners.col(0) = virtualVertex(face, positions);
  for (std::size_t i = 0; i < face.loop.size(); ++i) {
    corners.col(1) = positions.col(face.loop[i].index());
    corners.col(2) = positions.col(face.loop[(i + 1) % face.loop.size()].index());
    if (!visit(corners)) return false;
  }
  return true;
}

}  // namespace polyscalpel
