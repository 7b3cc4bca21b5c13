// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <unordered_map>
#include <vector>

#include <boost/container/flat_set.hpp>

#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/mesh/mesh_change.hpp"

namespace polyscalpel {

/// On which side of the border of a cap, that is still to be made, the vertices of a cell lie, while the cell
/// is divided for another reason.
class BorderSides {
 public:
  /// border: a loop of the cell's vertices. component: the cell's vertices on one side of it, ascending.
  /// is_on_cut: of vertices of the cell, whether they lie on neither side.
  BorderSides(const std::vector<VertexId>& border, std::vector<VertexId> component,
              std::function<bool(VertexId)> is_on_cut);

  /// Tells of vertices made within the cell's edges since then, in the order in which they were made; those
  /// told already are passed over.
  void follow(const std::vector<NewVertex>& new_vertices);

  /// Whether a vertex lies on the border: a corner of it, or made on an edge of it.
  bool isOnBorder(VertexId vertex) const { return on_border_.count(vertex) > 0; }

  /// +1 on the component's side, -1 on the other, 0 on the cut.
  int at(VertexId vertex) const;

 private:
  std::vector<VertexId> component_;
  std::function<bool(VertexId)> is_on_cut_;
  boost::container::flat_set<VertexId> on_border_;
  boost::container::flat_set<Edge> edges_;    // of the border
  std::unordered_map<VertexId, int> of_new_;  // sides of vertices made since
};

}  // namespace polyscalpel
