// SPDX-License-Identifier: BSD-3-Clause
//
// Stress in each cell, smoothed to the vertices, and from the difference the error estimate of O. C.
// Zienkiewicz, J. Z. Zhu, "A simple error estimator and adaptive procedure for practical engineering
// analysis", 1987.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Symmetric tensors as columns (xx, yy, zz, yz, zx, xy).
using SymmetricTensors = Eigen::Matrix<double, 6, Eigen::Dynamic>;

struct StressField {
  std::vector<CellId> cells;       ///< alive, ascending
  SymmetricTensors cell_stresses;  ///< 6 x cells: Cauchy stress of the mean strain, world frame [Pa]
  SymmetricTensors
      cell_strains;  ///< 6 x cells: small or Green strain, world frame (yz: eps_yz, not 2 eps_yz)
  /// 6 x numVertices() [Pa]: means over the cells around, weighted by what each gives to the vertex's volume.
  /// At a vertex between materials the mean over all of them, for colours; the error estimate smooths each
  /// material for itself.
  SymmetricTensors vertex_stresses;
  Eigen::VectorXd cell_errors;  ///< by cell [sqrt(J)]: energy norm of smoothed minus cell stress
  /// sqrt(sum of squared cell errors / (that + twice the strain energy)), in [0, 1]; 0 for a stress-free
  /// body.
  double relative_error = 0;
};

/// Stress, strain and error estimate at these positions (3 x numVertices(), one column per vertex [m]).
StressField recoverStress(const PolyhedralMesh& mesh, const Assembly& assembly,
                          const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

/// Means at the vertices of the stresses of these cells alone (6 x cells), 6 x numVertices() [Pa], weighted
/// as StressField::vertex_stresses; 0 at a vertex of none of them.
SymmetricTensors smoothStresses(const PolyhedralMesh& mesh, const Assembly& assembly,
                                const std::vector<CellId>& cells, const SymmetricTensors& cell_stresses);

/// Von Mises' equivalent stress of each column [Pa].
Eigen::VectorXd vonMises(const SymmetricTensors& stresses);
/// Principal values of each column, 3 x k, descending [Pa].
Eigen::Matrix3Xd principalValues(const SymmetricTensors& stresses);

}  // namespace polyscalpel
