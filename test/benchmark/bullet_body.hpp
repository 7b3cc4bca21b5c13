// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "benchmark/retessellation.hpp"
#include "polyscalpel/materials/isotropic_material.hpp"

namespace polyscalpel::report {

/// How Bullet's deformable solver is set. Its implicit step is on in all cases, damping, drag, sleeping,
/// stress limit and collisions are off.
struct BulletSettings {
  int newton_iterations = 1;
  int cg_iterations = 300;     ///< at most, each Newton iteration; 300 is Bullet's own default
  double cg_tolerance = 1e-6;  ///< its own measure: r^T M^-1 r of the residual over that of the start (or 1)
};

/// A deformable body of Bullet alone in its world: btDeformableLinearElasticityForce, which is corotated
/// linear elasticity on linear tetrahedra, and lumped mass.
class BulletBody {
 public:
  /// masses: of each vertex [kg]; fixed vertices stay where they are.
  BulletBody(const Tetrahedra& body, const Eigen::VectorXd& masses, const std::vector<bool>& fixed,
             const IsotropicMaterial& material, const Eigen::Vector3d& gravity_m_s2,
             const BulletSettings& settings);
  ~BulletBody();
  BulletBody(BulletBody&&) noexcept;
  BulletBody& operator=(BulletBody&&) noexcept;

  void step(double time_step_s);
  /// 3 x n, one column per vertex [m].
  Eigen::Matrix3Xd positions() const;

  /// "Bullet 3.24, single precision"
  static std::string version();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace polyscalpel::report
