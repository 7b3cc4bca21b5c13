// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include <Eigen/Core>

#include "polyscalpel/elements/element_config.hpp"
#include "polyscalpel/elements/stabilisation.hpp"
#include "polyscalpel/materials/isotropic_material.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {

/// What the solver needs of one cell, in its rest shape. Local vertex order is that of CellSurface
/// (Cell::vertices). The small-strain stiffness is
///
///   K = V Gm^T C Gm + S,
///
/// Gm the exact mean gradient, S the stabilising part, which sees what the mean gradient does not. Every
/// formulation has these two parts, so nothing else needs to know which one made them.
struct ElementMatrices {
  double volume = 0;               ///< V [m^3]
  Eigen::Matrix3Xd mean_gradient;  ///< Gm, 3 x n [1/m]: mean over the cell of each shape function's gradient
  Stabilisation stabilisation;  ///< S, positive semidefinite, zero on linear fields; empty for a tetrahedron
  Eigen::VectorXd shape_integral;  ///< n [m^3]: integral of each shape function, >= 0, sums to V
  Eigen::MatrixXd
      mass_integral;  ///< n x n [m^3]: integral of N_i N_j; empty unless ElementConfig::consistent_mass
};

/// A way to make a cell's matrices. Stateless: any thread may use it at any time.
class ElementFormulation {
 public:
  virtual ~ElementFormulation() = default;

  /// Throws std::invalid_argument for a surface that is not star-shaped from its vertex mean.
  virtual ElementMatrices makeMatrices(const CellSurface& surface,
                                       const IsotropicMaterial& material) const = 0;
};

/// Linear tetrahedron in closed form; for cells that are tetrahedra. S is empty.
std::unique_ptr<const ElementFormulation> makeTetrahedronElement(const ElementConfig& config);

/// Mean value coordinates (M. Wicke, M. Botsch, M. Gross, "A Finite Element Method on Convex Polyhedra",
/// 2007) with the gradient correction of C. Talischi, A. Pereira, I. F. M. Menezes, G. H. Paulino, "Gradient
/// correction for polygonal and polyhedral finite elements", 2015:
///   S = alpha sum_q w_q (G_q - Gq)^T C_s (G_q - Gq),  Gq = sum_q w_q G_q / V.
std::unique_ptr<const ElementFormulation> makeMeanValueElement(const ElementConfig& config);

/// First-order virtual element (L. Beirao da Veiga, F. Brezzi, L. D. Marini, "Virtual elements for linear
/// elasticity problems", 2013): S = (I - P)^T s (I - P), P the projection on linear fields by Gm, s one
/// number a cell.
std::unique_ptr<const ElementFormulation> makeVirtualElement(const ElementConfig& config);

/// The formulation for each cell: tetrahedra in closed form, all others as configured.
class CellFormulation final : public ElementFormulation {
 public:
  /// Throws std::invalid_argument for a bad config.
  explicit CellFormulation(const ElementConfig& config);
  ElementMatrices makeMatrices(const CellSurface& surface, const IsotropicMaterial& material) const override;

 private:
  std::shared_ptr<const ElementFormulation> tetrahedron_, polyhedron_;
};

/// The same for one cell.
ElementMatrices makeElementMatrices(const CellSurface& surface, const IsotropicMaterial& material,
                                    const ElementConfig& config);

/// K, 3n x 3n [N/m].
Eigen::MatrixXd stiffness(const ElementMatrices& element, const IsotropicMaterial& material);

/// First Lame parameter and shear modulus [Pa] that the stabilising term sees.
struct LameModuli {
  double lambda_pa = 0, mu_pa = 0;
};
LameModuli stabilisationModuli(const IsotropicMaterial& material, const ElementConfig& config);

}  // namespace polyscalpel
