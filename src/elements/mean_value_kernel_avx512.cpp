// SPDX-License-Identifier: BSD-3-Clause
//
// As mean_value_kernel_avx2.cpp, with -mavx512f.
#include "mean_value_kernel.hpp"

namespace polyscalpel {

MeanValueEvaluation<double> avx512MeanValueEvaluation() {
#if defined(__AVX512F__)
  if (__builtin_cpu_supports("avx512f")) return &MeanValueKernel<Pack<8>, double>::evaluate;
#endif
  return nullptr;
}

}  // namespace polyscalpel
