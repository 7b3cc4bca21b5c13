// SPDX-License-Identifier: BSD-3-Clause
//
// Boxes of every kind of cell, for studies of accuracy.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "support/voronoi_mesh.hpp"

namespace polyscalpel {

/// Kinds of cells that a body is made of.
enum class BodyKind {
  kHexahedra,
  kTetrahedra,  ///< five a cube
  kVoronoi,
  kSlicedHexahedra,  ///< cut by planes, and glued again
  kSlicedTetrahedra,
};

inline std::string toString(BodyKind kind) {
  switch (kind) {
    case BodyKind::kHexahedra:
      return "hexahedra";
    case BodyKind::kTetrahedra:
      return "tetrahedra";
    case BodyKind::kVoronoi:
      return "Voronoi cells";
    case BodyKind::kSlicedHexahedra:
      return "sliced hexahedra";
    case BodyKind::kSlicedTetrahedra:
      return "sliced tetrahedra";
  }
  throw std::invalid_argument("kind of body");
}

inline bool isSliced(BodyKind kind) {
  return kind == BodyKind::kSlicedHexahedra || kind == BodyKind::kSlicedTetrahedra;
}

/// The cells of a cut mesh as one body again: vertices that coincide in the rest shape become one, so cuts
/// are closed, and what remains of them is the shape of the cells.
inline PolyhedralMesh glued(const PolyhedralMesh& mesh) {
  double smallest = kInfinity;
  for (int i = 0; i < mesh.numVertices(); ++i) smallest = std::min(smallest, mesh.localSize(VertexId(i)));
  // Both sides of a cut split an edge of theirs for themselves, so copies agree but for rounding.
  PointMerger merger(1e-9 * smallest);
  std::vector<int> index(mesh.numVertices());
  for (int i = 0; i < mesh.numVertices(); ++i) index[i] = merger.add(mesh.restPosition(VertexId(i)));
  std::vector<PolyhedralMesh::CellLoops> cells;
  std::vector<int> regions;
  for (const CellId id : mesh.cells()) {
    regions.push_back(mesh.cell(id).region);
    PolyhedralMesh::CellLoops& loops = cells.emplace_back();
    for (const FaceId face_id : mesh.cell(id).faces) {
      const Face& face = mesh.face(face_id);
      std::vector<int>& loop = loops.emplace_back();
      for (const VertexId vertex : face.loop) loop.push_back(index[vertex.index()]);
      if (face.cells[0] != id) std::reverse(loop.begin(), loop.end());
    }
  }
  return PolyhedralMesh(merger.points(), cells, regions);
}

/// Whether every face of the boundary lies in a side of the box: no crack is left inside.
inline bool fillsBox(const PolyhedralMesh& mesh, const Eigen::Vector3d& lowest, const Eigen::Vector3d& size) {
  const double tolerance = 1e-9 * size.maxCoeff();
  for (int f = 0; f < mesh.faceCapacity(); ++f) {
    const Face& face = mesh.face(FaceId(f));
    if (!face.isAlive() || !face.isBoundary()) continue;
    bool is_in_side = false;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double level : {lowest[axis], lowest[axis] + size[axis]}) {
        is_in_side |= std::all_of(face.loop.begin(), face.loop.end(), [&](VertexId vertex) {
          return std::abs(mesh.restPosition(vertex)[axis] - level) < tolerance;
        });
      }
    }
    if (!is_in_side) return false;
  }
  return findPieces(mesh).count == 1;
}

/// Planes at random, each through the inner half of a box. Same input, same planes.
inline std::vector<PlaneCut> makeRandomPlanes(const Eigen::Vector3d& lowest, const Eigen::Vector3d& size,
                                              int num_planes, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> part(0.25, 0.75);
  std::vector<PlaneCut> planes(num_planes);
  for (PlaneCut& plane : planes) {
    for (int axis = 0; axis < 3; ++axis) {
      plane.point_world[axis] = lowest[axis] + part(random) * size[axis];
      plane.normal_world[axis] = normal(random);
    }
  }
  return planes;
}

/// Cuts the rest shape with a plane through its inside.
inline void slice(PolyhedralMesh& mesh, const PlaneCut& plane, int cut) {
  const Eigen::Matrix3Xd positions = mesh.restPositions();
  if (cutMesh(mesh, positions, plane, CuttingConfig(), cut).status != CutStatus::kCut)
    throw std::runtime_error("a plane through the inside of a body did not cut it");
}

/// The body cut by planes, left open.
inline PolyhedralMesh slicedOpen(PolyhedralMesh mesh, const std::vector<PlaneCut>& planes) {
  for (std::size_t i = 0; i < planes.size(); ++i) slice(mesh, planes[i], static_cast<int>(i) + 1);
  return mesh;
}

/// The body cut by planes, closed again after each: the sides of an open cut would each snap crossings to
/// vertices of their own, and not fit any more after the next plane.
inline PolyhedralMesh sliced(PolyhedralMesh mesh, const std::vector<PlaneCut>& planes) {
  for (const PlaneCut& plane : planes) {
    slice(mesh, plane, 1);
    mesh = glued(mesh);
  }
  return mesh;
}

/// Box from lowest to lowest + size [m] of counts.prod() cubes, each one hexahedron or five tetrahedra, or of
/// as many Voronoi cells. num_planes: number of cuts in a sliced body.
inline PolyhedralMesh makeStudyMesh(BodyKind kind, const Eigen::Vector3d& lowest, const Eigen::Vector3d& size,
                                    const Eigen::Vector3i& counts, int num_planes) {
  switch (kind) {
    case BodyKind::kHexahedra:
      return makeHexBox(lowest, size, counts);
    case BodyKind::kTetrahedra:
      return makeTetBox(lowest, size, counts);
    case BodyKind::kVoronoi:
      return makeVoronoiBox(lowest, size, counts);
    case BodyKind::kSlicedHexahedra:
      return sliced(makeHexBox(lowest, size, counts), makeRandomPlanes(lowest, size, num_planes));
    case BodyKind::kSlicedTetrahedra:
      return sliced(makeTetBox(lowest, size, counts), makeRandomPlanes(lowest, size, num_planes));
  }
  throw std::invalid_argument("kind of body");
}

}  // namespace polyscalpel
