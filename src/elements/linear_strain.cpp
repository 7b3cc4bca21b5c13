// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/strain_measure.hpp"

#include "stress_tensors.hpp"

namespace polyscalpel {
namespace {

/// Cauchy's strain eps = (F + F^T) / 2 - I.
class LinearStrain final : public StrainMeasure {
 public:
  Eigen::Matrix3d rotation(const Eigen::Matrix3d&) const override { return Eigen::Matrix3d::Identity(); }
  bool rotates() const override { return false; }

  double energyDensity(const Eigen::Matrix3d& F, const Eigen::Matrix3d&,
                       const LameModuli& moduli) const override {
    return hookeEnergy(smallStrain(F), moduli);
  }
  MeanLinearisation linearise(const Eigen::Matrix3d&, const Eigen::Matrix3d&,
                              const LameModuli&) const override {
    return {};
  }
  StressTangent exactTangent(const Eigen::Matrix3d&, const Eigen::Matrix3d&,
                             const LameModuli& moduli) const override {
    return tangentOf([&](const Eigen::Matrix3d& dF) { return hookeStress(symmetricPart(dF), moduli); });
  }
  Eigen::Matrix3d cauchyStress(const Eigen::Matrix3d& F, const Eigen::Matrix3d&,
                               const LameModuli& moduli) const override {
    return hookeStress(smallStrain(F), moduli);
  }
  Eigen::Matrix3d strain(const Eigen::Matrix3d& F, const Eigen::Matrix3d&) const override {
    return smallStrain(F);
  }
};

}  // namespace

const StrainMeasure& linearStrain() {
  static const LinearStrain measure;
  return measure;
}

}  // namespace polyscalpel
