// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "polyscalpel/elements/strain_measure.hpp"

namespace polyscalpel {

inline Eigen::Matrix3d symmetricPart(const Eigen::Matrix3d& A) {
  return 0.5 * (A + A.transpose());
}

/// (F + F^T) / 2 - I.
inline Eigen::Matrix3d smallStrain(const Eigen::Matrix3d& F) {
  return symmetricPart(F) - Eigen::Matrix3d::Identity();
}

/// Hooke's law for a symmetric strain.
inline Eigen::Matrix3d hookeStress(const Eigen::Matrix3d& strain, const LameModuli& moduli) {
  Eigen::Matrix3d stress = 2 * moduli.mu_pa * strain;
  stress.diagonal().array() += moduli.lambda_pa * strain.trace();
  return stress;
}
inline double hookeEnergy(const Eigen::Matrix3d& strain, const LameModuli& moduli) {
  const double trace = strain.trace();
  return moduli.mu_pa * strain.squaredNorm() + 0.5 * moduli.lambda_pa * trace * trace;
}

/// Axial vector of A - A^T: of b (outer) a it is a x b.
inline Eigen::Vector3d twiceAxial(const Eigen::Matrix3d& A) {
  return {A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1)};
}

/// The matrix of a linear map on 3 x 3 matrices, both column by column.
template <class LinearMap>
StressTangent tangentOf(const LinearMap& map) {
  StressTangent tangent;
  for (int k = 0; k < 9; ++k) {
    Eigen::Matrix3d dF = Eigen::Matrix3d::Zero();
    dF(k % 3, k / 3) = 1;
    const Eigen::Matrix3d dP = map(dF);
    tangent.col(k) = dP.reshaped();
  }
  return tangent;
}

/// Inverse of tr(U) I - U for the symmetric factor U = R^T F, which takes the axial part of R^T dF to the
/// turn of R. It is singular where two signed stretches cancel: on a line, a point or a mirror image the
/// energy has a kink. There an eigenvalue below kKink times the largest counts as that, and no turn is felt
/// beyond it.
class TurnOfRotation {
 public:
  explicit TurnOfRotation(const Eigen::Matrix3d& symmetric_factor);
  Eigen::Vector3d operator()(const Eigen::Vector3d& axial) const { return inverse_ * axial; }

 private:
  static constexpr double kKink = 1e-6;
  Eigen::Matrix3d inverse_;
};

}  // namespace polyscalpel
