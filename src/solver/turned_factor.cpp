// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/turned_factor.hpp"

#include "vertex_turns.hpp"

namespace polyscalpel {

void TurnedFactor::apply(const float* residual, float* result) {
  for (const int i : *active_) turnBack(rotations_ + 9 * i, residual + 3 * i, result + 3 * i);
  factor_.solve(result);
  for (const int i : *active_) turn(rotations_ + 9 * i, result + 3 * i, result + 3 * i);
}

}  // namespace polyscalpel
