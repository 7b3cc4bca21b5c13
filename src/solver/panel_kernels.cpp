// SPDX-License-Identifier: BSD-3-Clause
#include "panel_kernels.hpp"

namespace polyscalpel {

const PanelKernels& panelKernels() {
  static const PanelKernels kernels = avx2PanelKernels() ? *avx2PanelKernels() : makePanelKernels();
  return kernels;
}

}  // namespace polyscalpel
