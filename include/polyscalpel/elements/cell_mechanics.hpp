// SPDX-License-Identifier: BSD-3-Clause
//
// Energy, force and stiffness of one cell in any deformation. The energy is
//
//   E(x) = V psi(F) + 1/2 d^T S^ d,  F = sum_i x_i (outer) Gm_i,  d = R^T x H - X H,  R = rotation(F):
//
// a strain measure acts on the mean part, and the stabilising part, in its modes H, stays corotated.
#pragma once

#include <Eigen/Core>

#include "polyscalpel/elements/element_formulation.hpp"
#include "polyscalpel/elements/strain_measure.hpp"

namespace polyscalpel {

/// A cell as the functions below see it. Positions are 3 x n, one column per vertex [m], relative to a point
/// near the cell: far from the origin forces would lose digits.
struct CellView {
  double volume = 0;
  LameModuli moduli;
  Eigen::Ref<const Eigen::Matrix3Xd> mean_gradient;  ///< Gm
  const Stabilisation* stabilisation = nullptr;      ///< nullptr: none
};

/// A cell's force near a deformation.
struct CellLinearisation {
  MeanLinearisation mean;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  /// c of the stabilising part's rotation derivative: vertex i feels R (c x Gm_i) beside R S^ d H_i [N m].
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
};

/// Room for a cell's intermediate results, so that a step allocates nothing.
struct CellWorkspace {
  explicit CellWorkspace(int num_vertices) : modes(3, num_vertices), warped(modes), stabilising(modes) {}
  Eigen::Matrix3Xd modes;        ///< x H; at most as many columns as the cell has vertices
  Eigen::Matrix3Xd warped;       ///< d = R^T x H - X H
  Eigen::Matrix3Xd stabilising;  ///< S^ d
};

/// exact_force: with the rotation's derivative.
CellLinearisation linearise(const StrainMeasure& measure, const CellView& cell,
                            const Eigen::Ref<const Eigen::Matrix3Xd>& positions, bool exact_force,
                            CellWorkspace& work);

/// dE/dx of the linearisation, 3 x n [N]: minus the elastic force. At the positions of the linearisation, and
/// with exact_force, it is that of E itself.
void addForces(const CellLinearisation& linearisation, const CellView& cell,
               const Eigen::Ref<const Eigen::Matrix3Xd>& positions, CellWorkspace& work,
               Eigen::Ref<Eigen::Matrix3Xd> forces);

/// E [J].
double elasticEnergy(const StrainMeasure& measure, const CellView& cell,
                     const Eigen::Ref<const Eigen::Matrix3Xd>& positions, CellWorkspace& work);

/// d^2 E / dx^2, 3n x 3n [N/m], symmetric, indefinite in general; the rotation's second derivative is in it.
Eigen::MatrixXd exactTangent(const StrainMeasure& measure, const CellView& cell,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

}  // namespace polyscalpel
