// SPDX-License-Identifier: BSD-3-Clause
//
// Small-strain statics on tetrahedra that are too many for a factorisation: each of a body's tetrahedra is
// divided into eight, and the system is solved by conjugate gradients with the coarser body's factor inside.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "benchmark/retessellation.hpp"
#include "polyscalpel/materials/isotropic_material.hpp"

namespace polyscalpel::report {

struct SagReference {
  double coarse_sag_m = 0;  ///< of the given tetrahedra
  double fine_sag_m = 0;    ///< of these divided into eight
  int fine_cells = 0;
  int iterations = 0;
  std::string message;  ///< why there is no value; empty: all is well
};

/// Mean displacement along gravity of the mass at free vertices, see meanSag(). fixed: one flag a point; an
/// edge between two fixed points is fixed.
SagReference findSagReference(const Tetrahedra& tetrahedra, const std::vector<bool>& fixed,
                              const IsotropicMaterial& material, const Eigen::Vector3d& gravity_m_s2);

/// Work of gravity over the weight at free vertices [m]. displacements: 3 x n [m]; masses: n [kg].
double meanSag(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements, const Eigen::VectorXd& masses,
               const std::vector<bool>& fixed, const Eigen::Vector3d& gravity_m_s2);

}  // namespace polyscalpel::report
