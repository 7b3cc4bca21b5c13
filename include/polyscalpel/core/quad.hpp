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
/// Component k in all four places. Indexing would take the way through memory.
template <int k, class Vector>
static inline Vector spread(const Vector& quad) {
  return __builtin_shufflevector(quad, quad, k, k, k, k);
}

/// The first three alone.
template <class Scalar>
static inline void storeThree(Scalar* to, const Quad<Scalar>& quad) {
  std::memcpy(to, &quad, 2 * sizeof(Scalar));
  to[2] = spread<2>(quad)[0];
}

}  // namespace polyscalpel
