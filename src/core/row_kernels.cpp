// SPDX-License-Identifier: BSD-3-Clause
#include "row_kernels.hpp"

namespace polyscalpel {

const RowKernels& rowKernels() {
  static const RowKernels kernels = avx2RowKernels() ? *avx2RowKernels() : makeRowKernels();
  return kernels;
}

}  // namespace polyscalpel
