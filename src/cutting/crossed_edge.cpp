// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/crossed_edge.hpp"

#include <algorithm>

namespace polyscalpel {
namespace {

/// A bent surface that comes back through an edge meets it at a flat angle. One that comes back with a larger
/// |cos| of the angle between edge and normal is folded, more narrowly than the cells tell: the first
/// crossing stands for the fold.
constexpr double kLargestAlignmentOfBend = 0.5;

}  // namespace

CrossedEdge CrossedEdge::reversed() const {
  CrossedEdge other = *this;
  other.weight = 1 - weightAt(false);
  other.sign = -sideAt(false);
  if (isTwice()) other.second_weight = 1 - weight;
  return other;
}

std::optional<CrossedEdge> CrossedEdge::upTo(double end) const {
  if (weight > end) return {};
  CrossedEdge part = *this;
  part.weight /= end;
  part.second_weight = second_weight < end ? second_weight / end : std::numeric_limits<double>::infinity();
  return part;
}

void CrossedEdge::addSecond(const Hit& hit) {
  if (hit.sign != -sign || isTwice() || std::max(alignment, hit.alignment) > kLargestAlignmentOfBend) return;
  second_weight = std::max(weight, hit.weight);
  if (hit.weight > weight) return;
  weight = hit.weight;
  sign = hit.sign;
}

}  // namespace polyscalpel
