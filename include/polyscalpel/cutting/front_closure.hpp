// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <unordered_set>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/cell_tree.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"

namespace polyscalpel {

/// A blade at rest within the tissue, and how it came there.
struct BladeFront {
  Eigen::Matrix3Xd blade_world;   ///< 3 x k, k >= 2 [m]
  Eigen::Matrix3Xd travel_world;  ///< 3 x k, last travel of each point relative to the tissue [m]
  double stroke_length_m = 0;     ///< way of the blade through the tissue so far
};

/// A straight part of the line at which the surface of a blade ends within the tissue.
struct FrontSegment {
  Eigen::Vector3d start_world, end_world;  ///< [m]
  /// Leads out of the surface, in its plane, across the segment or askew [m].
  Eigen::Vector3d travel_world;
  /// Whether the surface has its side there, along the travel: at the start, at the end.
  std::array<bool, 2> is_tip = {false, false};
  double side_length_m = 0;  ///< of such sides

  /// Normal of the surface, of no particular length; zero where the segment travels along itself.
  Eigen::Vector3d sheetNormal() const;
};

/// Where the surface ends that the blade has swept.
std::vector<FrontSegment> makeFront(const BladeFront& blade);

/// The border of a polygon, all round.
std::vector<FrontSegment> makeFront(const PolygonCut& polygon);

/// Divides the cells in which a front lies by a plane through each of its segments and across its travel, and
/// the cell around a tip also by the plane along the side there, and remembers the new edges through which
/// the blade's surface goes. The parts behind the front are then passed whole, and a split of all that is
/// crossed ends at the front. The dividing faces stay closed: no tissue is separated here. A vertex nearer to
/// such a plane than the snap distance is taken to lie in it, so the slit ends within that distance of the
/// front. surface_snap: snap tolerance of the surface at these edges. positions: 3 x n [m], deformed; gets
/// columns for the new vertices. Returns the number of cells divided.
int closeFront(MeshEditor& editor, CellTree& tree, Crossings& crossings, Eigen::Matrix3Xd& positions,
               const std::vector<FrontSegment>& front, double snap_tolerance, double surface_snap);

/// Cells at a closed front that lie beyond it although the surface may cross all that holds them together: in
/// the nook of a front that bends inwards, or flat on it. To be left whole.
std::unordered_set<CellId> cellsBeyond(const PolyhedralMesh& mesh, const CellTree& tree,
                                       const Crossings& crossings,
                                       const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                       const std::vector<FrontSegment>& front, double snap_tolerance);

}  // namespace polyscalpel
