// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace polyscalpel {

/// A vertex that came after others: a quantity at it is (1 - weight) value(parents[0]) + weight
/// value(parents[1]).
struct AddedVertex {
  int vertex = 0;
  std::array<int, 2> parents = {0, 0};
  double weight = 0;

  int nearerParent() const { return parents[weight > 0.5 ? 1 : 0]; }
  int fartherParent() const { return parents[weight > 0.5 ? 0 : 1]; }
};

}  // namespace polyscalpel
