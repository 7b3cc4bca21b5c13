// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/border_sides.hpp"

#include <algorithm>
#include <utility>

namespace polyscalpel {

BorderSides::BorderSides(const std::vector<VertexId>& border, std::vector<VertexId> component,
                         std::function<bool(VertexId)> is_on_cut)
    : component_(std::move(component)),
      is_on_cut_(std::move(is_on_cut)),
      on_border_(border.begin(), border.end()) {
  for (std::size_t i = 0; i < border.size(); ++i)
    edges_.insert(makeEdge(border[i], border[(i + 1) % border.size()]));
}

void BorderSides::follow(const std::vector<NewVertex>& new_vertices) {
  for (const NewVertex& made : new_vertices) {
    const auto [a, b] = made.parents;
    if (of_new_.count(made.vertex)) continue;
    const int side_a = at(a);
    of_new_[made.vertex] = side_a != 0 ? side_a : at(b);
    if (edges_.count(makeEdge(a, b)) == 0) continue;
    on_border_.insert(made.vertex);
    for (const VertexId end : {a, b}) edges_.insert(makeEdge(end, made.vertex));
  }
}

int BorderSides::at(VertexId vertex) const {
  if (isOnBorder(vertex)) return 0;
  const auto made = of_new_.find(vertex);
  if (made != of_new_.end()) return made->second;
  if (std::binary_search(component_.begin(), component_.end(), vertex)) return 1;
  return is_on_cut_(vertex) ? 0 : -1;
}

}  // namespace polyscalpel
