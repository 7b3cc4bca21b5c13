// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "polyscalpel/elements/element_formulation.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {

/// Sets V and Gm = 1/V * closed integral of N_i n dS, exactly: N_i is linear on every surface triangle.
/// points: surface.points, relative to a point near the cell. Throws std::invalid_argument for a volume that
/// is not positive.
void setVolumeAndMeanGradient(const CellSurface& surface, const Eigen::Matrix3Xd& points,
                              ElementMatrices& element);

/// B_a^T C B_b summed up for isotropic C, from the gradient products H (3n x 3n, H_ab = integral of g_a
/// g_b^T; its lower triangle is read): the blocks lambda H_ab + mu H_ab^T + mu tr(H_ab) I.
Eigen::MatrixXd stiffnessFromGradientProducts(const Eigen::MatrixXd& H, const LameModuli& moduli);

}  // namespace polyscalpel
