// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/materials/isotropic_material.hpp"

#include <sstream>
#include <stdexcept>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/types.hpp"

namespace polyscalpel {

void validate(const IsotropicMaterial& material) {
  requirePositive("youngs_modulus_pa", material.youngs_modulus_pa);
  if (!(material.poisson_ratio > -1 && material.poisson_ratio < 0.5)) {
    std::ostringstream message;
    message << "poisson_ratio = " << material.poisson_ratio << ": must be finite and in (-1, 0.5)";
    throw std::invalid_argument(message.str());
  }
  requirePositive("density_kg_m3", material.density_kg_m3);
  requireInRange("strength_pa", material.strength_pa, 0, kInfinity);
  requireInRange("fracture_toughness_j_m2", material.fracture_toughness_j_m2, 0, 1e5);
}

double lameLambda(const IsotropicMaterial& material) {
  const double nu = material.poisson_ratio;
  return material.youngs_modulus_pa * nu / ((1 + nu) * (1 - 2 * nu));
}

double shearModulus(const IsotropicMaterial& material) {
  return material.youngs_modulus_pa / (2 * (1 + material.poisson_ratio));
}

Eigen::Matrix<double, 6, 6> elasticityMatrix(const IsotropicMaterial& material) {
  const double lambda = lameLambda(material);
  const double mu = shearModulus(material);
  Eigen::Matrix<double, 6, 6> C = Eigen::Matrix<double, 6, 6>::Zero();
  C.topLeftCorner<3, 3>().setConstant(lambda);
  C.diagonal() << lambda + 2 * mu, lambda + 2 * mu, lambda + 2 * mu, mu, mu, mu;
  return C;
}

}  // namespace polyscalpel
