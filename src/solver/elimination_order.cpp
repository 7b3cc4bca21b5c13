// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/elimination_order.hpp"

#include <algorithm>
#include <limits>

namespace polyscalpel {

std::vector<int> followCuts(const std::vector<int>& order, const std::vector<AddedVertex>& added) {
  if (added.empty()) return order;
  constexpr int kNone = -1, kNowhere = std::numeric_limits<int>::max();
  // Places in the order as given; a vertex that was added has the place of the one that it follows.
  std::vector<int> place(added.back().vertex + 1, kNowhere);
  for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = static_cast<int>(k);
  std::vector<int> last_at(order.size() + 1, kNone);  // of those that follow a place, the last one is first
  std::vector<int> before(added.size(), kNone);
  for (std::size_t k = 0; k < added.size(); ++k) {
    const AddedVertex& vertex = added[k];
    int first = kNowhere;
    for (int side = 0; side < 2; ++side) {
      if ((side == 0 ? 1 - vertex.weight : vertex.weight) == 0) continue;
      first = std::min(first, place[vertex.parents[side]]);
    }
    place[vertex.vertex] = first;
    const std::size_t at = first == kNowhere ? order.size() : first;
    before[k] = last_at[at];
    last_at[at] = static_cast<int>(k);
  }
  std::vector<int> result;
  result.reserve(order.size() + added.size());
  const auto appendFollowers = [&](std::size_t at) {
    for (int k = last_at[at]; k != kNone; k = before[k]) result.push_back(added[k].vertex);
  };
  appendFollowers(order.size());
  for (std::size_t at = 0; at < order.size(); ++at) {
    result.push_back(order[at]);
    appendFollowers(at);
  }
  return result;
}

}  // namespace polyscalpel
