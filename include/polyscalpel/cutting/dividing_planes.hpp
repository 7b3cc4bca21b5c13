// SPDX-License-Identifier: BSD-3-Clause
//
// Planes by which a cell is divided that no cap can split soundly.
#pragma once

#include <cmath>
#include <vector>

#include "polyscalpel/cutting/crossed_edge.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// A plane across a border: the loop of a cap that is still to be made.
struct DividingPlane {
  double angle_rad;        ///< of its normal, from the border's longest principal axis to the second one
  bool is_in_star_centre;  ///< it goes through the cell's star centre, otherwise through the border's middle
  double shift;            ///< how far it lies off that point, as part of the way to the border's end
};

/// In the order in which they are tried: across the border and its diagonals first, then askew.
const std::vector<DividingPlane>& dividingPlanes();

/// For the parts of a cell that such a plane has divided.
constexpr DividingPlane kFurtherDividingPlanes[] = {
    {0, false, 0}, {M_PI_2, false, 0}, {0, true, 0}, {M_PI_2, true, 0}};

/// Hits of a cell's edges, in rest shape, on a plane across a border, a loop of the cell's vertices.
std::vector<Hit> hitsAcross(const PolyhedralMesh& mesh, CellId cell, const std::vector<VertexId>& border,
                            const DividingPlane& plane);

}  // namespace polyscalpel
