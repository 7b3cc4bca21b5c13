// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "polyscalpel/elements/element_config.hpp"
#include "polyscalpel/elements/element_formulation.hpp"

namespace polyscalpel {

/// Derivative of the first Piola stress by the deformation gradient [Pa], both column by column.
using StressTangent = Eigen::Matrix<double, 9, 9>;

/// The mean stress near a deformation, with a positive semidefinite tangent:
///
///   P(F) = reference_stress + A (lambda tr(D) I + mu (D + D^T)) + (F - reference_gradient) S,
///   D = A^T (F - reference_gradient),
///
/// so that the stiffness of two vertices with mean gradients g_a, g_b is V times
///
///   lambda h_a h_b^T + mu h_b h_a^T + mu (g_a . g_b) A A^T + (g_a . S g_b) I,  h = A g.
///
/// Every strain measure below is of this form.
struct MeanLinearisation {
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d S = Eigen::Matrix3d::Zero();  ///< [Pa], symmetric, positive semidefinite
  Eigen::Matrix3d reference_gradient = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d reference_stress = Eigen::Matrix3d::Zero();  ///< [Pa]
};

/// Energy and stress of the mean part of a cell for a deformation gradient F, isotropic. R: rotation(F), to
/// be taken once for all. Stateless: any thread may use it at any time.
class StrainMeasure {
 public:
  virtual ~StrainMeasure() = default;

  /// The frame in which the stabilising part is linear: polarRotation(F), or identity where the measure knows
  /// no rotation.
  virtual Eigen::Matrix3d rotation(const Eigen::Matrix3d& F) const = 0;
  /// Whether rotation(F) depends on F.
  virtual bool rotates() const { return true; }

  /// [J/m^3] of the rest volume.
  virtual double energyDensity(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R,
                               const LameModuli& moduli) const = 0;
  /// P(F) is exact at F; the tangent is made positive semidefinite.
  virtual MeanLinearisation linearise(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R,
                                      const LameModuli& moduli) const = 0;
  /// The derivative of the stress itself, indefinite where the energy is not convex.
  virtual StressTangent exactTangent(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R,
                                     const LameModuli& moduli) const = 0;
  /// Cauchy stress in the world frame [Pa].
  virtual Eigen::Matrix3d cauchyStress(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R,
                                       const LameModuli& moduli) const = 0;
  /// The measure's strain, turned into the world frame.
  virtual Eigen::Matrix3d strain(const Eigen::Matrix3d& F, const Eigen::Matrix3d& R) const = 0;
};

/// Each lives for ever.
const StrainMeasure& linearStrain();
const StrainMeasure& corotatedStrain();
const StrainMeasure& greenStrain();
const StrainMeasure& strainMeasure(Strain strain);

}  // namespace polyscalpel
