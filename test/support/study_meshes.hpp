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

/// The box cut through by random planes, each through its inner half. The body is left open.
inline PolyhedralMesh slicedOpen(PolyhedralMesh mesh, const Eigen::Vector3d& lowest,
                                 const Eigen::Vector3d& size, int num_planes, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> part(0.25, 0.75);
  for (int i = 0; i < num_planes; ++i) {
    PlaneCut plane;
    for (int axis = 0; axis < 3; ++axis) {
      plane.point_world[axis] = lowest[axis] + part(random) * size[axis];
      plane.normal_world[axis] = normal(random);
    }
    const Eigen::Matrix3Xd positions = mesh.restPositions();
    if (cutMesh(mesh, positions, plane, CuttingConfig(), i + 1).status != CutStatus::kCut)
      throw std::runtime_error("a plane through the inside of a box did not cut it");
  }
  return mesh;
}

/// The same, glued again. Where a fallback of cutting has left a cell whole on one side of an earlier cut
/// only, the two sides do not fit, and other planes are taken. Same input, same mesh.
inline PolyhedralMesh sliced(const PolyhedralMesh& mesh, const Eigen::Vector3d& lowest,
                             const Eigen::Vector3d& size, int num_planes, unsigned seed = 1) {
  constexpr unsigned kMostTries = 20;
  for (unsigned i = 0; i < kMostTries; ++i) {
    PolyhedralMesh result = glued(slicedOpen(mesh, lowest, size, num_planes, seed + 1000 * i));
    if (fillsBox(result, lowest, size)) return result;
  }
  throw std::runtime_error("no planes found whose cut can be glued");
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
      return sliced(makeHexBox(lowest, size, counts), lowest, size, num_planes);
    case BodyKind::kSlicedTetrahedra:
      return sliced(makeTetBox(lowest, size, counts), lowest, size, num_planes);
  }
  throw std::invalid_argument("kind of body");
}

}  // namespace polyscalpel
