// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/strain_measure.hpp"

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

const StrainMeasure& strainMeasure(Strain strain) {
  switch (strain) {
    case Strain::kLinear:
      return linearStrain();
    case Strain::kCorotated:
      return corotatedStrain();
    case Strain::kGreen:
      return greenStrain();
  }
  POLYSCALPEL_ASSERT(false);
  return corotatedStrain();
}

}  // namespace polyscalpel
