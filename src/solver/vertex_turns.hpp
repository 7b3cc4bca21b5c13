// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace polyscalpel {

/// to = R from, R 9 numbers column by column; from and to may be the same.
static inline void turn(const float* R, const float* from, float* to) {
  const float x = from[0], y = from[1], z = from[2];
  for (int c = 0; c < 3; ++c) to[c] = R[c] * x + R[3 + c] * y + R[6 + c] * z;
}
/// to = R^T from.
static inline void turnBack(const float* R, const float* from, float* to) {
  const float x = from[0], y = from[1], z = from[2];
  for (int c = 0; c < 3; ++c) to[c] = R[3 * c] * x + R[3 * c + 1] * y + R[3 * c + 2] * z;
}

}  // namespace polyscalpel
