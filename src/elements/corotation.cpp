// SPDX-License-Identifier: BSD-3-Clause
//
// N. J. Higham, "Computing the polar decomposition - with applications", 1986 (Newton's iteration), and M.
// Mueller, M. Gross, "Interactive virtual materials", 2004 (stiffness warping).
#include "polyscalpel/elements/corotation.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {
namespace {

/// Newton's iteration is used where det F exceeds this part of |F|^3: there F is far from singular (a
/// rotation has 0.19), so that few steps reach full precision.
constexpr double kOrdinaryDeterminant = 0.01;
constexpr int kMaxNewtonSteps = 12;

/// R = U diag(1, 1, det(U V^T)) V^T with F = U S V^T, singular values descending: where a reflection is in
/// the way, the least stretched direction takes it.
Eigen::Matrix3d rotationBySvd(const Eigen::Matrix3d& F) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  const Eigen::Matrix3d& V = svd.matrixV();
  if (U.determinant() * V.determinant() < 0) U.col(2) = -U.col(2);
  return U * V.transpose();
}

/// Transposed inverse times the determinant.
Eigen::Matrix3d cofactors(const Eigen::Matrix3d& A) {
  Eigen::Matrix3d C;
  C.col(0) = A.col(1).cross(A.col(2));
  C.col(1) = A.col(2).cross(A.col(0));
  C.col(2) = A.col(0).cross(A.col(1));
  return C;
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

Eigen::Matrix3d polarRotation(const Eigen::Matrix3d& deformation_gradient) {
  // A factor > 0 does not change R; taking it out keeps determinants from over- and underflow. Division,
  // since the inverse of a subnormal number is infinite.
  const double scale = deformation_gradient.cwiseAbs().maxCoeff();
  if (!deformation_gradient.allFinite())
    return Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  if (scale == 0) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d F = deformation_gradient / scale;

  const double norm = F.norm();
  Eigen::Matrix3d R = F;
  Eigen::Matrix3d C = cofactors(R);
  double det = R.col(0).dot(C.col(0));
  if (!(det > kOrdinaryDeterminant * norm * norm * norm)) return rotationBySvd(F);
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    // R <- (g R + R^-T / g) / 2; g^2 = |R^-1| / |R| makes the first steps short cuts and tends to 1.
    const double g = std::sqrt(C.norm() / (det * R.norm()));
    const Eigen::Matrix3d next = 0.5 * g * R + (0.5 / (g * det)) * C;
    const double change = (next - R).cwiseAbs().maxCoeff();
    R = next;
    // Quadratic convergence: what is left is of the order of the square of this change.
    if (change < 1e-8) return R;
    C = cofactors(R);
    det = R.col(0).dot(C.col(0));
  }
  return rotationBySvd(F);
}

}  // namespace polyscalpel
