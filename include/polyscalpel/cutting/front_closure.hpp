// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/mesh/cell_tree.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"

namespace polyscalpel {

/// A blade at rest within the tissue, and how it came there.
struct BladeFront {
  Eigen::Matrix3Xd blade_world;   ///< 3 x k, k >= 2 [m]
  Eigen::Matrix3Xd travel_world;  ///< 3 x k, last travel of each point relative to the tissue [m]
  double stroke_length_m = 0;     ///< way of the blade through the tissue so far
};

/// Divides the cells in which the blade stands by a plane through each of its segments and across its travel,
/// and the cell around an end of the blade also by the plane along that end's way, and remembers the new
/// edges that the blade has passed. The parts behind the blade are then passed whole, and a split of all that
/// is crossed ends at the blade. The dividing faces stay closed: no tissue is separated here. A vertex nearer
/// to such a plane than the snap distance is taken to lie in it, so the front ends within that distance of
/// the blade. positions: 3 x n [m], deformed; gets columns for the new vertices. Returns the number of cells
/// divided.
int closeFront(MeshEditor& editor, CellTree& tree, Crossings& crossings, Eigen::Matrix3Xd& positions,
               const BladeFront& front, double snap_tolerance);

}  // namespace polyscalpel
