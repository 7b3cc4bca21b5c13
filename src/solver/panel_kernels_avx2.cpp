// SPDX-License-Identifier: BSD-3-Clause
//
// Compiled with -mavx2 where the compiler knows it, and called where the processor does; without fused
// products.
#include "panel_kernels.hpp"

namespace polyscalpel {

const PanelKernels* avx2PanelKernels() {
#if defined(__AVX2__)
  static const PanelKernels kernels = makePanelKernels();
  if (__builtin_cpu_supports("avx2")) return &kernels;
#endif
  return nullptr;
}

}  // namespace polyscalpel
