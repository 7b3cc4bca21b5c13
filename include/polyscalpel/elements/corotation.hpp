// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace polyscalpel {

/// Mean deformation gradient F = sum_i x_i (outer) Gm_i. positions, mean_gradient: 3 x n, one column per
/// vertex.
Eigen::Matrix3d meanDeformationGradient(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& mean_gradient);

/// Rotation factor R (det R = +1) of the polar decomposition F = R S, safe for inverted, flat and zero F: the
/// least stretched direction is then mirrored, so an inverted cell is pushed back.
Eigen::Matrix3d polarRotation(const Eigen::Matrix3d& deformation_gradient);

}  // namespace polyscalpel
