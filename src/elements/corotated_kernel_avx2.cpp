// SPDX-License-Identifier: BSD-3-Clause
//
// Compiled with -mavx2 where the compiler knows it, and called where the processor does. Without fused
// products: they round once instead of twice, and the machines would give different bits.
#include "corotated_kernel.hpp"

namespace polyscalpel {

const CorotatedKernels* avx2CorotatedKernels() {
#if defined(__AVX2__)
  static const CorotatedKernels kernels = CorotatedKernel<Pack<4>>::kernels();
  if (__builtin_cpu_supports("avx2")) return &kernels;
#endif
  return nullptr;
}

}  // namespace polyscalpel
