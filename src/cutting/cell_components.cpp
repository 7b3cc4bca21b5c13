// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/cell_components.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <boost/container/small_vector.hpp>

#include "polyscalpel/cutting/vertices_in_line.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"

namespace polyscalpel {

std::vector<std::vector<VertexId>> findComponents(const PolyhedralMesh& mesh, const Crossings& crossings,
                                                  CellId cell) {
  constexpr int kNone = -1;
  const auto& vertices = mesh.cell(cell).vertices;
  // Disjoint sets of local vertices, each named by its smallest member.
  boost::container::small_vector<int, 32> roots(vertices.size());
  const auto find = [&](int i) {
    while (roots[i] != i) i = roots[i] = roots[roots[i]];
    return i;
  };
  int num_components = 0;
  for (int i = 0; i < static_cast<int>(vertices.size()); ++i) {
    const bool is_on_cut = crossings.isSnapped(cell, vertices[i]);
    roots[i] = is_on_cut ? kNone : i;
    num_components += !is_on_cut;
  }
  mesh.forEachEdge(cell, [&](VertexId from, VertexId to) {
    int a = countSmaller(vertices, from), b = countSmaller(vertices, to);
    if (roots[a] == kNone || roots[b] == kNone || crossings.find(cell, {from, to})) return;
    a = find(a);
    b = find(b);
    if (a == b) return;
    roots[std::max(a, b)] = std::min(a, b);
    --num_components;
  });
  std::vector<std::vector<VertexId>> components;
  if (num_components < 2) return components;
  boost::container::small_vector<int, 32> component_of(vertices.size(), kNone);  // by root
  for (int i = 0; i < static_cast<int>(vertices.size()); ++i) {
    if (roots[i] == kNone) continue;
    int& component = component_of[find(i)];
    if (component == kNone) {
      component = static_cast<int>(components.size());
      components.emplace_back();
    }
    components[component].push_back(vertices[i]);
  }
  std::stable_sort(components.begin(), components.end(),
                   [](const auto& a, const auto& b) { return a.size() < b.size(); });
  return components;
}

bool lieOnOneSide(const PolyhedralMesh& mesh, const Crossings& crossings, CellId cell,
                  const std::vector<std::vector<VertexId>>& components) {
  if (components.size() < 2) return false;
  const auto edges = mesh.edges(cell);
  int side = 0;
  for (const auto& component : components) {
    bool has_side = false;
    for (const auto& [a, b] : edges) {
      for (const auto& [v, other] : {std::pair(a, b), std::pair(b, a)}) {
        if (!std::binary_search(component.begin(), component.end(), v)) continue;
        if (std::binary_search(component.begin(), component.end(), other)) continue;
        if (!crossings.isSnapped(cell, other)) return false;
        const int own = crossings.sideOfNeighbour(other, v);
        if (own == 0 || own == -side) return false;
        side = own;
        has_side = true;
      }
    }
    if (!has_side) return false;
  }
  return true;
}

bool hangInOneEdge(const PolyhedralMesh& mesh, CellId cell, const std::vector<VertexId>& component) {
  boost::container::small_vector<VertexId, 8> ends;  // beyond the component
  std::size_t degrees = 0;
  mesh.forEachEdge(cell, [&](VertexId a, VertexId b) {
    const bool has_a = std::binary_search(component.begin(), component.end(), a),
               has_b = std::binary_search(component.begin(), component.end(), b);
    degrees += has_a + has_b;
    if (has_a != has_b) ends.push_back(has_a ? b : a);
  });
  return degrees == 2 * component.size() && ends.size() == 2 && areInLine(mesh, ends[0], component, ends[1]);
}

}  // namespace polyscalpel
