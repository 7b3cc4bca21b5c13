// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace polyscalpel {

template <int kWidth>
struct DoubleVector;
template <>
struct DoubleVector<2> {
  using Type = double __attribute__((vector_size(16)));
};
template <>
struct DoubleVector<4> {
  using Type = double __attribute__((vector_size(32)));
};
template <>
struct DoubleVector<8> {
  using Type = double __attribute__((vector_size(64)));
};

/// kWidth doubles that go through the same arithmetic side by side. GCC's and Clang's vector types, wrapped
/// so that they can be template arguments; Eigen 3.4 does not vectorise comparisons and selections.
template <int kWidth>
class Pack {
 public:
  static constexpr int kSize = kWidth;
  using Values = typename DoubleVector<kWidth>::Type;

  /// What a comparison yields: all bits set where it holds.
  struct Mask {
    decltype(Values{} < Values{}) lanes;
    friend Mask operator&&(Mask a, Mask b) { return {a.lanes & b.lanes}; }
    friend Mask operator!(Mask a) { return {~a.lanes}; }
    bool operator[](int lane) const { return lanes[lane] != 0; }
    bool any() const {
      bool result = false;
      for (int lane = 0; lane < kWidth; ++lane) result = result || lanes[lane] != 0;
      return result;
    }
  };

  Pack() = default;
  Pack(double value)
      : values_(value - Values{}) {}  // NOLINT: numbers mix with packs as they do with each other
  explicit Pack(Values values) : values_(values) {}

  double operator[](int lane) const { return values_[lane]; }
  void set(int lane, double value) { values_[lane] = value; }

  friend Pack operator+(Pack a, Pack b) { return Pack(a.values_ + b.values_); }
  friend Pack operator-(Pack a, Pack b) { return Pack(a.values_ - b.values_); }
  friend Pack operator*(Pack a, Pack b) { return Pack(a.values_ * b.values_); }
  friend Pack operator/(Pack a, Pack b) { return Pack(a.values_ / b.values_); }
  friend Mask operator<(Pack a, Pack b) { return {a.values_ < b.values_}; }
  friend Mask operator<=(Pack a, Pack b) { return {a.values_ <= b.values_}; }
  friend Pack select(Mask mask, Pack yes, Pack no) { return Pack(mask.lanes ? yes.values_ : no.values_); }
  friend Pack sqrt(Pack a) {
#if defined(__AVX512F__)
    if constexpr (kWidth == 8) return Pack(Values(_mm512_maskz_sqrt_pd(0xff, __m512d(a.values_))));
#endif
#if defined(__AVX2__)
    if constexpr (kWidth == 4) return Pack(Values(_mm256_sqrt_pd(__m256d(a.values_))));
#endif
#if defined(__SSE2__)
    if constexpr (kWidth == 2) return Pack(Values(_mm_sqrt_pd(__m128d(a.values_))));
#endif
    Values roots;
    for (int lane = 0; lane < kWidth; ++lane) roots[lane] = std::sqrt(a.values_[lane]);
    return Pack(roots);
  }

 private:
  Values values_;
};

/// The same words for one number of any precision.
template <class Scalar>
class SinglePack {
 public:
  static constexpr int kSize = 1;

  struct Mask {
    bool holds;
    friend Mask operator&&(Mask a, Mask b) { return {a.holds && b.holds}; }
    friend Mask operator!(Mask a) { return {!a.holds}; }
    bool operator[](int) const { return holds; }
    bool any() const { return holds; }
  };

  SinglePack() = default;
  SinglePack(Scalar value) : value_(value) {}  // NOLINT: as above

  Scalar operator[](int) const { return value_; }
  void set(int, Scalar value) { value_ = value; }

  friend SinglePack operator+(SinglePack a, SinglePack b) { return a.value_ + b.value_; }
  friend SinglePack operator-(SinglePack a, SinglePack b) { return a.value_ - b.value_; }
  friend SinglePack operator*(SinglePack a, SinglePack b) { return a.value_ * b.value_; }
  friend SinglePack operator/(SinglePack a, SinglePack b) { return a.value_ / b.value_; }
  friend Mask operator<(SinglePack a, SinglePack b) { return {a.value_ < b.value_}; }
  friend Mask operator<=(SinglePack a, SinglePack b) { return {a.value_ <= b.value_}; }
  friend SinglePack select(Mask mask, SinglePack yes, SinglePack no) { return mask.holds ? yes : no; }
  friend SinglePack sqrt(SinglePack a) { return std::sqrt(a.value_); }

 private:
  Scalar value_;
};

}  // namespace polyscalpel
