// SPDX-License-Identifier: BSD-3-Clause
#include "corotated_kernel.hpp"

namespace polyscalpel {

const CorotatedKernels& corotatedKernels() {
  static const CorotatedKernels kernels =
      avx2CorotatedKernels() ? *avx2CorotatedKernels() : CorotatedKernel<Pack<2>>::kernels();
  return kernels;
}

}  // namespace polyscalpel
