// SPDX-License-Identifier: BSD-3-Clause
//
// Compiled with -mavx2 where the compiler knows it, and called where the processor does. Without fused
// products: they round once instead of twice, and the machines would give different bits.
#include "mean_value_kernel.hpp"

namespace polyscalpel {

MeanValueEvaluation<double> avx2MeanValueEvaluation() {
#if defined(__AVX2__)
  if (__builtin_cpu_supports("avx2")) return &MeanValueKernel<Pack<4>, double>::evaluate;
#endif
  return nullptr;
}

}  // namespace polyscalpel
