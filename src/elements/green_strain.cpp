// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "polyscalpel/elements/corotation.hpp"
#include "polyscalpel/elements/strain_measure.hpp"
#include "stress_tensors.hpp"

namespace polyscalpel {
namespace {

/// Green's strain E = (F^T F - I) / 2 with Hooke's law: the St. Venant-Kirchhoff material. It sees no
/// difference between F and its mirror image, so an inverted cell is as content as an upright one.
class GreenStrain final : public StrainMeasure {
 public:
  Eigen::Matrix3d rotation(const Eigen::Matrix3d& F) const override { return polarRotation(F); }

  double energyDensity(const Eigen::Matrix3d& F, const Eigen::Matrix3d&,
                       const LameModuli& moduli) const override {
    return hookeEnergy(green(F), moduli);
  }
  // d(F S) = F dS + dF S: the first part is semidefinite, the second as much as S is. What of S pushes is
  // left out of the tangent: a strut that buckles has no positive stiffness.
  MeanLinearisation linearise(const Eigen::Matrix3d& F, const Eigen::Matrix3d&,
                              const LameModuli& moduli) const override {
    MeanLinearisation linearisation;
    const Eigen::Matrix3d stress = hookeStress(green(F), moduli);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(stress);
    linearisation.A = F;
    linearisation.S = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
                      eigen.eigenvectors().transpose();
    linearisation.reference_gradient = F;
    linearisation.reference_stress = F * stress;
    return linearisation;
  }
  StressTangent exactTangent(const Eigen::Matrix3d& F, const Eigen::Matrix3d&,
                             const LameModuli& moduli) const override {
    const Eigen::Matrix3d stress = hookeStress(green(F), moduli);
    return tangentOf([&](const Eigen::Matrix3d& dF) -> Eigen::Matrix3d {
      return dF * stress + F * hookeStress(symmetricPart(F.transpose() * dF), moduli);
    });
  }
  Eigen::Matrix3d cauchyStress(const Eigen::Matrix3d& F, const Eigen::Matrix3d&,
                               const LameModuli& moduli) const override {
    const double volume_ratio = F.determinant();
    if (volume_ratio == 0) return Eigen::Matrix3d::Zero();  // flat: no area to relate a force to
    return F * hookeStress(green(F), moduli) * F.transpose() / volume_ratio;
  }
  Eigen::Matrix3d strain(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R) const override {
    return R * green(F) * R.transpose();
  }

 private:
  static Eigen::Matrix3d green(const Eigen::Matrix3d& F) {
    return 0.5 * (F.transpose() * F - Eigen::Matrix3d::Identity());
  }
};

}  // namespace

const StrainMeasure& greenStrain() {
  static const GreenStrain measure;
  return measure;
}

}  // namespace polyscalpel
