// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/types.hpp"

namespace polyscalpel {

/// A vertex made by a cut: every quantity at it is (1 - weight) * value(parents[0]) + weight *
/// value(parents[1]). A copy of a vertex has both parents equal. Parents have smaller ids.
struct NewVertex {
  VertexId vertex;
  std::array<VertexId, 2> parents;
  double weight = 0;  ///< in [0, 1]
};

/// Appends to a quantity at the vertices (3 x n, one column per vertex) its values at new ones.
void extendByNewVertices(const std::vector<NewVertex>& new_vertices, Eigen::Matrix3Xd& values);

/// A cell made by a cut, and the cell of the mesh before the cut that it is a part of.
struct NewCell {
  CellId cell;
  CellId parent;
};

/// What one committed edit did: the hinge from which everything downstream of the mesh refreshes itself.
struct MeshChange {
  std::vector<NewVertex> new_vertices;  ///< ascending ids, following on the mesh's former number of vertices
  /// Vertices that no cell has any more, ascending (see PolyhedralMesh::isRetired).
  std::vector<VertexId> retired_vertices;
  std::vector<CellId> removed_cells;  ///< alive before the edit, gone after it, ascending
  std::vector<NewCell> new_cells;     ///< alive after the edit, not before, ascending
  /// Cells that kept their id while vertices or faces of theirs changed, ascending; their matrices are to be
  /// made anew.
  std::vector<CellId> changed_cells;
  std::vector<FaceId> changed_faces;  ///< every face that was made, removed or altered, ascending

  bool isEmpty() const {
    return new_vertices.empty() && removed_cells.empty() && new_cells.empty() && changed_cells.empty();
  }
};

}  // namespace polyscalpel
