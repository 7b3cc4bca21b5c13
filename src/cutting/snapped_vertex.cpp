// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/snapped_vertex.hpp"

#include <algorithm>

namespace polyscalpel {
namespace {

template <class Neighbours>
auto findIn(Neighbours& neighbours, VertexId vertex) {
  return std::find_if(neighbours.begin(), neighbours.end(),
                      [&](const SnappedVertex::Neighbour& known) { return known.vertex == vertex; });
}

}  // namespace

const SnappedVertex::Neighbour* SnappedVertex::find(VertexId neighbour) const {
  const auto place = findIn(neighbours, neighbour);
  return place == neighbours.end() ? nullptr : &*place;
}

int SnappedVertex::sideOfNeighbour(VertexId neighbour) const {
  const Neighbour* known = find(neighbour);
  return known ? known->side : side;
}

void SnappedVertex::forgetNeighbour(VertexId neighbour) {
  neighbours.erase(std::remove_if(neighbours.begin(), neighbours.end(),
                                  [&](const Neighbour& known) { return known.vertex == neighbour; }),
                   neighbours.end());
}

void SnappedVertex::addHit(VertexId neighbour, int other_side, double weight) {
  const auto known = findIn(neighbours, neighbour);
  if (known == neighbours.end()) {
    neighbours.push_back({neighbour, other_side, weight, weight});
    side = -other_side;
    return;
  }
  if (weight > known->furthest) {
    known->furthest = weight;
    known->side = other_side;
  }
  if (weight < known->nearest) {
    known->nearest = weight;
    side = -other_side;
  }
}

}  // namespace polyscalpel
