// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>

namespace polyscalpel {

template <class Scalar>
struct QuadVector;
template <>
struct QuadVector<float> {
  using Type = float __attribute__((vector_size(16)));
};
template <>
struct QuadVector<double> {
  using Type = double __attribute__((vector_size(32)));
};

/// Four numbers in one register, the fourth mostly a bystander: a point or a column of a 3 x 3 block. GCC's
/// and Clang's vector types work on every machine.
template <class Scalar>
using Quad = typename QuadVector<Scalar>::Type;

/// From four numbers in memory, aligned or not.
template <class Scalar>
static inline Quad<Scalar> loadQuad(const Scalar* from) {
  Quad<Scalar> quad;
  std::memcpy(&quad, from, sizeof quad);
  return quad;
}
template <class Scalar>
static inline void storeQuad(Scalar* to, const Quad<Scalar>& quad) {
  std::memcpy(to, &quad, sizeof quad);
}
/// The first three alone.
template <class Scalar>
static inline void storeThree(Scalar* to, const Quad<Scalar>& quad) {
  for (int c = 0; c < 3; ++c) to[c] = quad[c];
}

}  // namespace polyscalpel
