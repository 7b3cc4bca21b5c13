// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cell_batch.hpp"
#include "polyscalpel/elements/corotated_body.hpp"

namespace polyscalpel {

// Each number of a cell stands for four, one a cell of the batch.
struct CorotatedBody::Layout {
  int gradients, volume, lambda, mu, modes, stiffness, rest_modes, size;

  Layout(int n, int m) {
    int next = 0;
    const auto take = [&](int count) {
      const int first = next;
      next += kBatchSize * count;
      return first;
    };
    gradients = take(3 * n);
    volume = take(1);
    lambda = take(1);
    mu = take(1);
    modes = take(n * m);
    stiffness = take(3 * m * (3 * m + 1) / 2);
    rest_modes = take(3 * m);
    size = next;
  }
};

}  // namespace polyscalpel
