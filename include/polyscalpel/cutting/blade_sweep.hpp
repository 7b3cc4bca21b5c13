// SPDX-License-Identifier: BSD-3-Clause
//
// Which edges of the mesh a blade's surface crosses, in deformed space. A mesh edge is straight in both
// shapes, so a crossing is the pair (edge, weight) and neighbours agree on it without any search.
//
// Each search takes a tree of the mesh's cells that is fitted to the positions. It decides nothing: the
// answers are the same with an empty tree, by which every cell is looked at.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/cutting/crossed_edge.hpp"
#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/cell_tree.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Edges that the plane separates, ascending. positions: 3 x n [m].
std::vector<Hit> findHits(const PolyhedralMesh& mesh, const CellTree& tree,
                          const Eigen::Ref<const Eigen::Matrix3Xd>& positions, const PlaneCut& plane);

/// Edges through the inside of a simple polygon, ascending: those that the fan of triangles around its first
/// corner winds around once, which also serves outlines that are not convex.
std::vector<Hit> findHits(const PolyhedralMesh& mesh, const CellTree& tree,
                          const Eigen::Ref<const Eigen::Matrix3Xd>& positions, const PolygonCut& polygon);

/// Motion of a blade and of the tissue around it over one step.
struct BladeMotion {
  const Eigen::Matrix3Xd& edge_tool;  ///< 3 x k [m]
  const Eigen::Isometry3d& T_world_tool_start;
  const Eigen::Isometry3d& T_world_tool_end;
  Eigen::Ref<const Eigen::Matrix3Xd> positions_start;  ///< 3 x n [m]
  Eigen::Ref<const Eigen::Matrix3Xd> positions_end;    ///< 3 x n [m]
};

/// Pose at fraction s of the way: positions linear, rotation by slerp.
Eigen::Isometry3d interpolate(const Eigen::Isometry3d& T_start, const Eigen::Isometry3d& T_end, double s);

/// Edges that the blade passes, in the order of passing. Each sub-step has two halves, the blade moving
/// through frozen tissue, then the tissue moving past the frozen blade; the signed hits of an edge over both
/// are summed, so that a blade carried along by the tissue cuts nothing. Sub-steps are no longer than
/// max_travel * localSize, nor turn the blade by so much that its triangles lie 0.01 localSize off the ruled
/// surface, and are halved, at most 8 times, while an edge is hit an even number of times. Nothing where the
/// travel takes more than kMostSubSteps, which also bounds those of a turn.
std::optional<std::vector<Hit>> findHits(const PolyhedralMesh& mesh, const CellTree& tree,
                                         const BladeMotion& motion, double max_travel);

/// Box around all that the blade may reach in the motion.
Eigen::AlignedBox3d reachOf(const Eigen::Matrix3Xd& edge_tool, const Eigen::Isometry3d& T_world_tool_start,
                            const Eigen::Isometry3d& T_world_tool_end);

}  // namespace polyscalpel
