// SPDX-License-Identifier: BSD-3-Clause
//
// M. Mueller, M. Gross, "Interactive virtual materials", 2004 (stiffness warping).
#include "polyscalpel/elements/corotation.hpp"

#include <limits>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "polar_kernel.hpp"
#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {
namespace {

/// R = U diag(1, 1, det(U V^T)) V^T with F = U S V^T, singular values descending: where a reflection is in
/// the way, the least stretched direction takes it.
Eigen::Matrix3d rotationBySvd(const Eigen::Matrix3d& F) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  const Eigen::Matrix3d& V = svd.matrixV();
  if (U.determinant() * V.determinant() < 0) U.col(2) = -U.col(2);
  return U * V.transpose();
}

}  // namespace

Eigen::Matrix3d meanDeformationGradient(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& mean_gradient) {
  POLYSCALPEL_ASSERT(positions.cols() == mean_gradient.cols() && positions.cols() > 0);
  // The gradients sum to zero, so any origin will do; a near one keeps the digits of a cell far from the
  // world's.
  const Eigen::Vector3d origin = positions.col(0);
  Eigen::Matrix3d F = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 1; i < positions.cols(); ++i) {
    F += (positions.col(i) - origin) * mean_gradient.col(i).transpose();
  }
  return F;
}

void rotationBySvd(const double* F, double* R) {
  const Eigen::Map<const Eigen::Matrix3d> from(F);
  Eigen::Map<Eigen::Matrix3d> to(R);
  if (from.allFinite()) {
    to = rotationBySvd(Eigen::Matrix3d(from));
  } else {
    to.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

Eigen::Matrix3d polarRotation(const Eigen::Matrix3d& deformation_gradient) {
  Square<SinglePack<double>> F;
  for (int k = 0; k < 9; ++k) F[k] = deformation_gradient.data()[k];
  const Square<SinglePack<double>> R = polarRotation(F);
  Eigen::Matrix3d result;
  for (int k = 0; k < 9; ++k) result.data()[k] = R[k][0];
  return result;
}

}  // namespace polyscalpel
