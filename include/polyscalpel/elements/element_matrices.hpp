// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "polyscalpel/materials/isotropic_material.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {

/// How a cell becomes a finite element.
struct ElementConfig {
  int quadrature_points = 4;       ///< points in each sub-tet (centroid, surface triangle): 1, 4 or 11
  double stabilisation_scale = 1;  ///< alpha, > 0
  bool consistent_mass = false;    ///< consistent instead of lumped mass
  bool corotated = true;           ///< warp by each cell's rotation; false: small-strain linear elasticity
};

/// Throws std::invalid_argument with name, value and range.
void validate(const ElementConfig& config);

/// What the solver needs of one cell, in its rest shape. Local vertex order is that of CellSurface
/// (Cell::vertices).
struct ElementMatrices {
  double volume = 0;               ///< V [m^3]
  Eigen::Matrix3Xd mean_gradient;  ///< Gm, 3 x n [1/m]: mean over the cell of each shape function's gradient
  Eigen::MatrixXd stiffness;       ///< K, 3n x 3n [N/m], symmetric, dofs (x0 y0 z0 x1 ...)
  Eigen::VectorXd shape_integral;  ///< n [m^3]: integral of each shape function, >= 0, sums to V
  Eigen::MatrixXd
      mass_integral;  ///< n x n [m^3]: integral of N_i N_j; empty unless ElementConfig::consistent_mass
};

/// DESIGN: K = V Gm^T C Gm + alpha sum_q w_q (G_q - Gq)^T C (G_q - Gq), Gm exact from the surface, Gq = sum_q
/// w_q G_q / V (Wicke, Botsch, Gross 2007, with the gradient correction of Talischi et al. 2015). A
/// tetrahedron takes the closed form.
ElementMatrices makeElementMatrices(const CellSurface& surface, const IsotropicMaterial& material,
                                    const ElementConfig& config);

}  // namespace polyscalpel
