// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/cut_distance.hpp"

#include <algorithm>
#include <utility>

namespace polyscalpel {

bool isKnownFar(const PolyhedralMesh& mesh, const Crossings& crossings, CellId cell,
                const std::vector<VertexId>& vertices, double distance) {
  bool is_far = std::any_of(vertices.begin(), vertices.end(),
                            [&](VertexId v) { return crossings.leastDistance(v) >= distance; });
  mesh.forEachEdge(cell, [&](VertexId a, VertexId b) {
    const CrossedEdge* crossed = crossings.find(cell, {a, b});
    if (!crossed) return;
    const double across = crossed->alignment * (mesh.restPosition(b) - mesh.restPosition(a)).norm();
    for (const auto& [v, part] :
         {std::pair(a, crossed->weightAt(true)), std::pair(b, 1 - crossed->weightAt(false))}) {
      is_far |= across * part >= distance * mesh.localSize(v) &&
                std::binary_search(vertices.begin(), vertices.end(), v);
    }
  });
  return is_far;
}

std::optional<int> sideIfNear(const PolyhedralMesh& mesh, const Crossings& crossings, CellId cell,
                              VertexId vertex, double distance) {
  const double reach = distance * mesh.localSize(vertex);
  std::optional<int> side;
  for (const auto& [a, b] : mesh.edges(cell)) {
    if (a != vertex && b != vertex) continue;
    const VertexId other = a == vertex ? b : a;
    const double length = (mesh.restPosition(b) - mesh.restPosition(a)).norm();
    if (const auto* crossed = crossings.find(cell, {a, b})) {
      const double weight = crossed->weightAt(a == vertex);
      if (length * (a == vertex ? weight : 1 - weight) < reach) side = crossed->sideAt(a == vertex);
    } else if (!side && crossings.isSnapped(cell, other) && length < reach) {
      side = crossings.sideOfNeighbour(other, vertex);
    }
  }
  return side;
}

}  // namespace polyscalpel
