// SPDX-License-Identifier: BSD-3-Clause
//
// Products with rows of 3 x 3 blocks, two blocks side by side. Compiled once for every machine and once for
// wider registers (row_kernels_avx2.cpp), with the same roundings; all functions have internal linkage, so
// that nothing compiled for wide registers ends up elsewhere in the program.
#pragma once

#include <cstddef>

#include "polyscalpel/core/quad.hpp"
#include "polyscalpel/core/row_pattern.hpp"

namespace polyscalpel {

/// Rows of a DifferenceMatrix without its ties.
template <class Scalar>
struct RowsOfBlocks {
  const RowPattern::Row* rows = nullptr;
  const int* columns = nullptr;
  const Scalar* blocks = nullptr;
  const double* masses = nullptr;
};

struct RowKernels {
  /// y_i = masses_i x_i + sum over j of A_ij (x_j - x_i) for each of `count` vertices i.
  void (*multiply_float)(const RowsOfBlocks<float>& matrix, const int* vertices, int count, const float* x,
                         float* y);
  void (*multiply_double)(const RowsOfBlocks<double>& matrix, const int* vertices, int count, const double* x,
                          double* y);
};

const RowKernels& rowKernels();
/// With 8 floats in a register, or nullptr where compiler or processor cannot.
const RowKernels* avx2RowKernels();

template <class Scalar>
struct QuadPairVector;
template <>
struct QuadPairVector<float> {
  using Type = float __attribute__((vector_size(32)));
};
template <>
struct QuadPairVector<double> {
  using Type = double __attribute__((vector_size(64)));
};
/// Two quads side by side.
template <class Scalar>
using QuadPair = typename QuadPairVector<Scalar>::Type;

template <class Scalar>
static inline QuadPair<Scalar> joinQuads(const Quad<Scalar>& first, const Quad<Scalar>& second) {
#if defined(__clang__) || __GNUC__ >= 12
  return __builtin_shufflevector(first, second, 0, 1, 2, 3, 4, 5, 6, 7);
#else
  QuadPair<Scalar> pair;
  std::memcpy(&pair, &first, sizeof first);
  std::memcpy(reinterpret_cast<char*>(&pair) + sizeof first, &second, sizeof second);
  return pair;
#endif
}

/// The sum of the two.
template <class Scalar>
static inline Quad<Scalar> sumOfPair(const QuadPair<Scalar>& pair) {
#if defined(__clang__) || __GNUC__ >= 12
  return __builtin_shufflevector(pair, pair, 0, 1, 2, 3) + __builtin_shufflevector(pair, pair, 4, 5, 6, 7);
#else
  Quad<Scalar> quads[2];
  std::memcpy(quads, &pair, sizeof pair);
  return quads[0] + quads[1];
#endif
}

/// Component k of each quad in all four places.
template <int k, class Pair>
static inline Pair spreadEach(const Pair& pair) {
#if defined(__clang__) || __GNUC__ >= 12
  return __builtin_shufflevector(pair, pair, k, k, k, k, 4 + k, 4 + k, 4 + k, 4 + k);
#else
  using Places = decltype(pair < pair);  // integers as wide as the components
  return __builtin_shuffle(pair, Places{k, k, k, k, 4 + k, 4 + k, 4 + k, 4 + k});
#endif
}

/// Of a block and the one after it; column by column, 9 numbers each.
template <class Scalar>
static inline QuadPair<Scalar> loadColumns(const Scalar* column) {
  return joinQuads<Scalar>(loadQuad(column), loadQuad(column + 9));
}

// A block's last column ends with it: what is read behind may be another row's or the padding.
template <class Scalar>
static void multiplyRows(const RowsOfBlocks<Scalar>& matrix, const int* vertices, int count, const Scalar* x,
                         Scalar* y) {
  for (int k = 0; k < count; ++k) {
    const std::ptrdiff_t i = vertices[k];
    const RowPattern::Row row = matrix.rows[i];
    const int* column = matrix.columns + row.first;
    const int* const end = column + row.count;
    const Scalar* block = matrix.blocks + 9 * static_cast<std::ptrdiff_t>(row.first);
    const Quad<Scalar> x_i = loadQuad(x + 3 * i);
    Quad<Scalar> sum = static_cast<Scalar>(matrix.masses[i]) * x_i;
    if (row.count % 2 != 0) {
      const Quad<Scalar> d = loadQuad(x + 3 * static_cast<std::ptrdiff_t>(*column++)) - x_i;
      sum += loadQuad(block) * spread<0>(d) + loadQuad(block + 3) * spread<1>(d) +
             loadQuad(block + 6) * spread<2>(d);
      block += 9;
    }
    const QuadPair<Scalar> x_ii = joinQuads<Scalar>(x_i, x_i);
    QuadPair<Scalar> even = {}, odd = {};
    for (; column != end; column += 2, block += 18) {
      const QuadPair<Scalar> d = joinQuads<Scalar>(loadQuad(x + 3 * static_cast<std::ptrdiff_t>(column[0])),
                                                   loadQuad(x + 3 * static_cast<std::ptrdiff_t>(column[1]))) -
                                 x_ii;
      even += loadColumns(block) * spreadEach<0>(d);
      odd += loadColumns(block + 3) * spreadEach<1>(d);
      even += loadColumns(block + 6) * spreadEach<2>(d);
    }
    storeThree(y + 3 * i, Quad<Scalar>(sum + sumOfPair<Scalar>(even + odd)));
  }
}

static inline RowKernels makeRowKernels() {
  return {&multiplyRows<float>, &multiplyRows<double>};
}

}  // namespace polyscalpel
