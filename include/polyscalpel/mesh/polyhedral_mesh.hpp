// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <boost/container/small_vector.hpp>

#include <Eigen/Core>

#include "polyscalpel/core/types.hpp"
#include "polyscalpel/mesh/block_list.hpp"

namespace polyscalpel {

/// The loop of a face. Most have three or four vertices, which lie in the face itself: a cut makes and reads
/// thousands of faces, and an allocation and a further line of memory for each would be most of its cost.
using FaceLoop = boost::container::small_vector<VertexId, 6>;

/// A polygon between two cells, or between a cell and the outside.
struct Face {
  FaceLoop loop;  ///< counter-clockwise seen from outside cells[0]; at least 3
  /// One flag a loop entry: whether the vertex is a corner of the face as it was made. Only corners carry the
  /// virtual vertex (surface.hpp); a vertex that a neighbour's cut hung into an edge later does not.
  boost::container::small_vector<char, 8> is_corner;
  std::array<CellId, 2> cells;  ///< cells[0] sees the loop as outward; cells[1] is invalid on the boundary
  int cut = 0;  ///< number (>= 1) of the cut that made this face as a cap, 0 for every other face

  bool isAlive() const { return cells[0].isValid(); }
  bool isBoundary() const { return !cells[1].isValid(); }
};

/// How many of some ascending vertices are smaller than one: its place among them, if it is there. For the
/// few of a cell, a count without branches is found sooner than by halving.
inline int countSmaller(const std::vector<VertexId>& vertices, VertexId vertex) {
  constexpr std::size_t kFew = 32;
  if (vertices.size() > kFew)
    return static_cast<int>(std::lower_bound(vertices.begin(), vertices.end(), vertex) - vertices.begin());
  int count = 0;
  for (const VertexId other : vertices) count += other < vertex;
  return count;
}

/// A convex polyhedron (up to rounding and to bent cut faces).
struct Cell {
  std::vector<FaceId> faces;       ///< at least 4; empty when the cell has been removed
  std::vector<VertexId> vertices;  ///< every vertex of the faces once, ascending
  int region = 0;                  ///< region number from the mesh file, kept by children

  bool isAlive() const { return !faces.empty(); }
};

/// The rest shape of a body as conforming polyhedra. Ids are stable for life: a removed entity's id is never
/// given again. Changed only through MeshEditor.
class PolyhedralMesh {
 public:
  /// Outward face loops of one cell, each a list of point indices, counter-clockwise seen from outside.
  using CellLoops = std::vector<std::vector<int>>;

  PolyhedralMesh() = default;

  /// Builds a mesh from points (3 x n, one column per vertex [m]) and cells. Faces with the same vertices are
  /// joined. Vertices at which cells are not joined by faces are copied, so that bodies that touch in a
  /// vertex or an edge alone are apart; unused points are dropped. regions: one number a cell, or empty for 0
  /// everywhere. Throws std::invalid_argument for an index out of range, a face of three cells or of equal
  /// orientation in both, an open cell, a cell of non-positive volume, or coordinates that are not finite.
  PolyhedralMesh(const Eigen::Ref<const Eigen::Matrix3Xd>& points, const std::vector<CellLoops>& cells,
                 const std::vector<int>& regions = {});

  /// Number of vertices, retired ones included.
  int numVertices() const { return static_cast<int>(rest_positions_.size()); }
  /// Number of cells that are alive.
  int numCells() const { return num_cells_; }
  /// One more than the largest cell id ever given; cells below it may have been removed.
  int cellCapacity() const { return static_cast<int>(cells_.size()); }
  /// One more than the largest face id ever given; faces below it may have been removed.
  int faceCapacity() const { return static_cast<int>(faces_.size()); }

  const Face& face(FaceId id) const { return faces_[id.index()]; }
  const Cell& cell(CellId id) const { return cells_[id.index()]; }

  /// 3 x n, one column per vertex [m], rest shape. Valid until the mesh is changed.
  Eigen::Map<const Eigen::Matrix3Xd> restPositions() const {
    return {rest_positions_.empty() ? nullptr : rest_positions_.front().data(), 3, numVertices()};
  }
  Eigen::Vector3d restPosition(VertexId id) const { return rest_positions_[id.index()]; }

  /// Size of the uncut mesh around the vertex [m]: length of the shortest edge there before any cut; a new
  /// vertex takes the smaller of its parents'.
  double localSize(VertexId id) const { return local_sizes_[id.index()]; }
  /// The smallest localSize of the cell's vertices [m].
  double localSize(CellId id) const;

  /// Whether every cell of the vertex has been taken out of the mesh (MeshEditor::removeCells). Its id is not
  /// given again and its position stays, but no face has it: it is without mass, is not moved and not shown.
  bool isRetired(VertexId id) const { return is_retired_[id.index()] != 0; }

  /// Faces that have the vertex in their loop, in no particular but reproducible order.
  const std::vector<FaceId>& facesAround(VertexId id) const { return vertex_faces_[id.index()]; }

  /// Ids of the cells that are alive, ascending.
  std::vector<CellId> cells() const;

  /// The cell on the other side of the face; invalid on the boundary.
  CellId neighbour(FaceId face, CellId cell) const;

  /// The edges of a cell as (smaller id, larger id), ascending, each once.
  std::vector<std::pair<VertexId, VertexId>> edges(CellId id) const;

  /// Calls visit(smaller id, larger id) for each of them once, in no particular but reproducible order.
  template <class Visit>
  void forEachEdge(CellId id, const Visit& visit) const;

 private:
  friend class MeshEditor;

  std::vector<Eigen::Vector3d> rest_positions_;
  std::vector<double> local_sizes_;
  std::vector<std::vector<FaceId>> vertex_faces_;
  std::vector<char> is_retired_;
  BlockList<Face> faces_;
  BlockList<Cell> cells_;
  int num_cells_ = 0;
};

template <class Visit>
void PolyhedralMesh::forEachEdge(CellId id, const Visit& visit) const {
  for (const FaceId face_id : cell(id).faces) {
    const Face& at = face(face_id);
    // The two faces of the cell at an edge run along it in opposite directions, seen from outside.
    const bool is_outward = at.cells[0] == id;
    VertexId from = at.loop.back();
    for (const VertexId to : at.loop) {
      if ((from < to) == is_outward) visit(std::min(from, to), std::max(from, to));
      from = to;
    }
  }
}

/// Connected components of the cells under "share a face". Returns one number in [0, count) for each cell id
/// (-1 where the cell has been removed), numbered by their smallest cell id, and the count.
struct Pieces {
  std::vector<int> piece_of_cell;
  int count = 0;
};
Pieces findPieces(const PolyhedralMesh& mesh);

}  // namespace polyscalpel
