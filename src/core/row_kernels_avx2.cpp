// SPDX-License-Identifier: BSD-3-Clause
//
// Compiled with -mavx2 where the compiler knows it, and called where the processor does; without fused
// products.
#include "row_kernels.hpp"

namespace polyscalpel {

const RowKernels* avx2RowKernels() {
#if defined(__AVX2__)
  static const RowKernels kernels = makeRowKernels();
  if (__builtin_cpu_supports("avx2")) return &kernels;
#endif
  return nullptr;
}

}  // namespace polyscalpel
