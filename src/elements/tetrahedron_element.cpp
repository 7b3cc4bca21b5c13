// SPDX-License-Identifier: BSD-3-Clause
#include "cell_integrals.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/elements/element_formulation.hpp"

namespace polyscalpel {
namespace {

class TetrahedronElement final : public ElementFormulation {
 public:
  explicit TetrahedronElement(bool consistent_mass) : consistent_mass_(consistent_mass) {}

  ElementMatrices makeMatrices(const CellSurface& surface, const IsotropicMaterial&) const override {
    POLYSCALPEL_ASSERT(surface.isTetrahedron());
    const Eigen::Matrix3Xd points = surface.points.colwise() - starCentre(surface);
    ElementMatrices element;
    setVolumeAndMeanGradient(surface, points, element);
    element.shape_integral.setConstant(4, element.volume / 4);
    if (consistent_mass_) {
      element.mass_integral.setConstant(4, 4, element.volume / 20);
      element.mass_integral.diagonal() *= 2;
    }
    return element;
  }

 private:
  bool consistent_mass_;
};

}  // namespace

std::unique_ptr<const ElementFormulation> makeTetrahedronElement(const ElementConfig& config) {
  return std::make_unique<TetrahedronElement>(config.consistent_mass);
}

}  // namespace polyscalpel
