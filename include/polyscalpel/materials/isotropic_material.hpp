// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace polyscalpel {

/// Hooke's law: stress = lambda tr(eps) I + 2 mu eps, eps = (grad u + grad u^T) / 2, energy density eps : C :
/// eps / 2.
struct IsotropicMaterial {
  double youngs_modulus_pa = 1e4;  ///< E, > 0
  double poisson_ratio = 0.45;     ///< nu, in (-1, 0.5)
  double density_kg_m3 = 1000;     ///< > 0
  /// In [0, inf): tension at which the material tears by itself, where the scene asks for fracture; 0: never.
  double strength_pa = 0;
  /// In [0, 1e5]: energy of a new area of crack [J/m^2], whether a blade opens it or the stress.
  double fracture_toughness_j_m2 = 0;
};

/// Throws std::invalid_argument with name, value and range.
void validate(const IsotropicMaterial& material);

/// First Lame parameter lambda [Pa].
double lameLambda(const IsotropicMaterial& material);
/// Shear modulus mu [Pa].
double shearModulus(const IsotropicMaterial& material);

/// C, 6 x 6 [Pa], for strains (xx, yy, zz, 2 yz, 2 zx, 2 xy) and stresses (xx, yy, zz, yz, zx, xy).
Eigen::Matrix<double, 6, 6> elasticityMatrix(const IsotropicMaterial& material);

}  // namespace polyscalpel
