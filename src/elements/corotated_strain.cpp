// SPDX-License-Identifier: BSD-3-Clause
//
// M. Mueller, M. Gross, "Interactive virtual materials", 2004 (warped stiffness); I. Chao, U. Pinkall, P.
// Sanan, P. Schroeder, "A simple geometric model for elastic deformations", 2010 (its energy and
// derivatives).
#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "polar_kernel.hpp"
#include "polyscalpel/elements/corotation.hpp"
#include "polyscalpel/elements/strain_measure.hpp"
#include "stress_tensors.hpp"

namespace polyscalpel {

TurnOfRotation::TurnOfRotation(const Eigen::Matrix3d& symmetric_factor) {
  Eigen::Matrix3d A = -symmetricPart(symmetric_factor);
  A.diagonal().array() -= A.trace();
  // Far from a kink the plain inverse does.
  constexpr double kOrdinary = 1e-2;
  const double mean = A.trace() / 3;
  if (mean > 0 && A.determinant() > kOrdinary * mean * mean * mean) {
    inverse_ = A.inverse();
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(A);
  const Eigen::Vector3d values = eigen.eigenvalues();
  const double floor = kKink * values.cwiseAbs().maxCoeff();
  Eigen::Vector3d inverse;
  for (int i = 0; i < 3; ++i) inverse[i] = std::abs(values[i]) > floor ? 1 / values[i] : 0;
  inverse_ = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

void turnByEigenvalues(const double* U, const double* axial, double* turn) {
  const Eigen::Matrix3d symmetric_factor = Eigen::Map<const Eigen::Matrix3d>(U);
  const TurnOfRotation of_rotation(symmetric_factor);
  Eigen::Map<Eigen::Vector3d> result(turn);
  result = of_rotation(Eigen::Map<const Eigen::Vector3d>(axial));
}

namespace {

/// Small strain eps = sym(R^T F) - I in the frame that turns with the cell.
class CorotatedStrain final : public StrainMeasure {
 public:
  Eigen::Matrix3d rotation(const Eigen::Matrix3d& F) const override { return polarRotation(F); }

  double energyDensity(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R,
                       const LameModuli& moduli) const override {
    return hookeEnergy(smallStrain(R.transpose() * F), moduli);
  }
  MeanLinearisation linearise(const Eigen::Matrix3d&, const Eigen::Matrix3d& R,
                              const LameModuli&) const override {
    MeanLinearisation linearisation;
    linearisation.A = R;
    linearisation.reference_gradient = R;
    return linearisation;
  }
  // P = R sigma, sigma = Hooke(U - I), U = R^T F; dR = R [w]_x, and U and sigma turn back by w.
  StressTangent exactTangent(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R,
                             const LameModuli& moduli) const override {
    const Eigen::Matrix3d U = R.transpose() * F;
    const TurnOfRotation turn(U);
    const Eigen::Matrix3d sigma = hookeStress(smallStrain(U), moduli);
    return tangentOf([&](const Eigen::Matrix3d& dF) -> Eigen::Matrix3d {
      const Eigen::Matrix3d D = R.transpose() * dF;
      const Eigen::Vector3d w = turn(twiceAxial(D));
      Eigen::Matrix3d spin;
      spin << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
      return R * (spin * sigma + hookeStress(symmetricPart(D - spin * U), moduli));
    });
  }
  Eigen::Matrix3d cauchyStress(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R,
                               const LameModuli& moduli) const override {
    return R * hookeStress(smallStrain(R.transpose() * F), moduli) * R.transpose();
  }
  Eigen::Matrix3d strain(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R) const override {
    return R * smallStrain(R.transpose() * F) * R.transpose();
  }
};

}  // namespace

const StrainMeasure& corotatedStrain() {
  static const CorotatedStrain measure;
  return measure;
}

}  // namespace polyscalpel
