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
/// Four of the eight components of two quads. Indexing would take the way through memory.
template <int i, int j, int k, int l, class Vector>
static inline Vector pick(const Vector& a, const Vector& b) {
#if defined(__clang__) || __GNUC__ >= 12
  return __builtin_shufflevector(a, b, i, j, k, l);
#else
  using Places = decltype(a < b);  // integers as wide as the components
  return __builtin_shuffle(a, b, Places{i, j, k, l});
#endif
}
/// Component k in all four places.
template <int k, class Vector>
static inline Vector spread(const Vector& quad) {
  return pick<k, k, k, k>(quad, quad);
}

/// The first three alone.
template <class Scalar>
static inline void storeThree(Scalar* to, const Quad<Scalar>& quad) {
  std::memcpy(to, &quad, 2 * sizeof(Scalar));
  to[2] = spread<2>(quad)[0];
}

}  // namespace polyscalpel
