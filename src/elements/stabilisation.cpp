// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/stabilisation.hpp"

#include <Eigen/QR>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

Eigen::MatrixXd Stabilisation::matrix() const {
  const Eigen::Index n = modes.rows(), m = modes.cols();
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(3 * n, 3 * n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b) {
      Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
      for (Eigen::Index k = 0; k < m; ++k) {
        for (Eigen::Index l = 0; l < m; ++l)
          block += modes(a, k) * modes(b, l) * stiffness.block<3, 3>(3 * k, 3 * l);
      }
      if (a == b) block = (0.5 * (block + block.transpose())).eval();
      S.block<3, 3>(3 * a, 3 * b) = block;
      S.block<3, 3>(3 * b, 3 * a) = block.transpose();
    }
  }
  return S;
}

double Stabilisation::traceAt(Eigen::Index vertex) const {
  double trace = 0;
  for (Eigen::Index k = 0; k < modes.cols(); ++k) {
    for (Eigen::Index l = 0; l < modes.cols(); ++l)
      trace += modes(vertex, k) * modes(vertex, l) * stiffness.block<3, 3>(3 * k, 3 * l).trace();
  }
  return trace;
}

Eigen::MatrixXd nonLinearModes(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  const Eigen::Index n = points.cols();
  POLYSCALPEL_ASSERT(n >= 4);
  Eigen::Matrix<double, Eigen::Dynamic, 4> linear(n, 4);
  linear.col(0).setOnes();
  linear.rightCols<3>() = (points.colwise() - points.rowwise().mean()).transpose();
  const Eigen::HouseholderQR<Eigen::Matrix<double, Eigen::Dynamic, 4>> qr(linear);
  Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(n, n - 4);
  modes.bottomRows(n - 4).setIdentity();
  modes.applyOnTheLeft(qr.householderQ());
  return modes;
}

}  // namespace polyscalpel
