// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {

/// A quadrature rule on a tetrahedron: positive weights, points inside.
struct TetrahedronRule {
  int degree = 0;  ///< highest degree of polynomials that are integrated exactly
  Eigen::Matrix4Xd
      barycentric;          ///< 4 x k, one column per point, each summing to 1; row 0 belongs to the apex
  Eigen::VectorXd weights;  ///< k, each > 0, summing to 1
};

/// The rule with 1 (degree 1), 4 (degree 2) or 11 (degree 4) points. All are invariant under permutations of
/// the last three vertices, so a cell's matrices do not depend on where its triangles start. Throws
/// std::invalid_argument for any other number. The result lives for ever.
const TetrahedronRule& tetrahedronRule(int num_points);

/// Points inside a cell and the volumes that they stand for.
struct CellQuadrature {
  Eigen::Matrix3Xd points;  ///< 3 x k, one column per point [m], relative to starCentre(surface)
  Eigen::VectorXd weights;  ///< k [m^3], summing to the volume
};

/// The rule on every tetrahedron (starCentre(surface), surface triangle), in the order of the triangles.
/// Throws std::invalid_argument where such a tetrahedron has no positive volume: the cell is not star-shaped.
CellQuadrature makeCellQuadrature(const CellSurface& surface, const TetrahedronRule& rule);

/// The same where star_centre, that of the surface, is known.
CellQuadrature makeCellQuadrature(const CellSurface& surface, const TetrahedronRule& rule,
                                  const Eigen::Vector3d& star_centre);

}  // namespace polyscalpel
