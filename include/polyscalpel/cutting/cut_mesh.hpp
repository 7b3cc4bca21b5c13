// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/mesh_index.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Sliver policy and progress of cuts. h is the size of the uncut mesh around a vertex
/// (PolyhedralMesh::localSize).
struct CuttingConfig {
  /// tau in [1e-6, 0.2]: a blade that passes a vertex nearer than tau h, where it crosses an edge of the
  /// vertex, goes through the vertex.
  double snap_tolerance = 0.05;
  double hold_back = 0.5;    ///< in [0, 2]: a cell splits once the blade is further from it than this times h
  double max_travel = 0.25;  ///< in [1e-3, 1]: the blade's travel in one sub-step, times h;
                             ///< a long blade that turns has shorter ones (blade_sweep.hpp)
  double close_front_after_s = 0.05;  ///< in [0, 1e6] [s]: a blade within the tissue that has not moved for
                                      ///< so long has the slit reach it
  /// In [0, inf): a cut's pieces of a smaller rest volume are taken away, but never the largest piece of the
  /// body; 0: none is. Followed by Simulation, not by cutMesh.
  double debris_volume_m3 = 0;
};

/// Throws std::invalid_argument with name, value and range.
void validate(const CuttingConfig& config);

/// Whole plane, in deformed space.
struct PlaneCut {
  Eigen::Vector3d point_world = Eigen::Vector3d::Zero();    ///< [m]
  Eigen::Vector3d normal_world = Eigen::Vector3d::UnitX();  ///< any length > 0
};

/// A finite flat blade: the inside of a simple planar polygon, in deformed space. Where its border lies
/// within the tissue, the slit reaches up to it.
struct PolygonCut {
  Eigen::Matrix3Xd corners_world;  ///< 3 x k, k >= 3 [m], in order, either sense

  /// Its area along its normal [m^2], to that side from which the corners run counter-clockwise.
  Eigen::Vector3d areaVector() const;
};

/// The ruled surface swept by a polyline blade edge through the given positions, in deformed space, tissue
/// held still. Where it ends within the tissue, the slit reaches up to the blade.
struct SweepCut {
  Eigen::Matrix3Xd edge_tool;                   ///< 3 x k, k >= 2 [m]
  std::vector<Eigen::Isometry3d> T_world_tool;  ///< at least 2
};

using CutOperation = std::variant<PlaneCut, PolygonCut, SweepCut>;

enum class CutStatus {
  kCut,               ///< the mesh has changed
  kMissed,            ///< the blade does not meet the tissue
  kNothingSeparated,  ///< the blade meets the tissue but passes no cell whole; the mesh is as it was
  kRefused,           ///< the blade's way in one motion is too long (kMostSubSteps); the mesh is as it was
};

/// Most sub-steps (CuttingConfig::max_travel) of one motion of a blade near tissue: from one pose of a sweep
/// to the next, or in one step of a tool. A longer motion is refused as a whole.
constexpr int kMostSubSteps = 1 << 14;

/// Largest coordinate of a plane's point, a corner, a blade or a pose [m]: beyond it lengths lose the digits
/// that tell one vertex from another.
constexpr double kLargestCoordinate_m = 1e9;

/// Most corners of a polygon and points of a blade: whether they cross or repeat is looked for in pairs.
constexpr int kMostCorners = 10000;

/// What a cut did. The mesh is as it was unless status is kCut.
struct CutResult {
  CutStatus status = CutStatus::kMissed;
  std::string message;  ///< one sentence for a user
  int cut = 0;          ///< the number that new faces carry in Face::cut; of a list, that of its first cut
  int num_cuts = 1;     ///< cuts made: a list's faces are numbered from `cut` on, in its order
  MeshChange change;
  int cells_split = 0;       ///< number of splits
  int cells_left_whole = 0;  ///< cells that the blade passed but no fallback could split soundly
  int pieces_before = 0;
  int pieces_after = 0;
  double cut_area_m2 = 0;  ///< area of the new caps in rest shape, each counted once
};

/// Cuts at once, through the body as it lies in `positions` (3 x n, one column per vertex [m]). cut: number
/// for the new faces, >= 1. All or nothing. Throws std::invalid_argument for input that is no cut: not
/// finite or above kLargestCoordinate_m, zero normal, fewer than 3 corners or more than kMostCorners, corners
/// not in one plane (1e-3 of their extent), a repeated or self-crossing outline, a blade without length or
/// with a repeated point, fewer than two poses, a pose that is no rigid motion.
///
/// index: of the mesh, its tree fitted to the positions or empty; it follows the cut. Without one the cut
/// looks at every cell.
CutResult cutMesh(PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                  const CutOperation& operation, const CuttingConfig& config, int cut,
                  MeshIndex* index = nullptr);

/// Several cuts as one transaction, each through what the ones before it left: all of them are made, numbered
/// cut, cut + 1 ..., or the mesh is as it was. All are looked at before the first is made; one that is no cut
/// throws, as does an empty list, and one that changes nothing ends the transaction with its status and says
/// which it was.
CutResult cutMesh(PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                  const std::vector<CutOperation>& operations, const CuttingConfig& config, int cut,
                  MeshIndex* index = nullptr);

/// One blade moving through moving tissue: remembers crossed edges and splits each cell once the blade has
/// left it.
///
/// A crossed edge is pending until it is split, with a cell around it: once the blade is further from that
/// cell than hold_back, where the blade comes to rest (closeFront()), or as the stroke ends. What is
/// still pending then is released, its tissue whole: the blade has not passed those cells from side to side.
/// A stroke ends when the blade is out of the tissue, further than hold_back from every cell, when it
/// is taken away (finish(), forget()), or when its motion is refused. If another cut divides a pending edge,
/// the crossing stays with the part in which it lies; if that edge goes with its cells, so does the crossing.
/// A stroke that starts at the end of a slit goes on from there.
///
/// A blade that comes back (by more than a right angle) is in its own slit as long as it is no further off
/// its way than snap_tolerance * localSize. Where it leaves the slit by another way, the stroke ends: the
/// front is closed where the blade has turned, and a new stroke goes on from there, so that a V parts what
/// lies in it.
class BladeCut {
 public:
  /// edge_tool: 3 x k, k >= 2 [m], the cutting edge as a polyline in the tool's frame. Throws
  /// std::invalid_argument.
  BladeCut(const Eigen::Ref<const Eigen::Matrix3Xd>& edge_tool, const CuttingConfig& config);
  ~BladeCut();
  BladeCut(BladeCut&&) noexcept;
  BladeCut& operator=(BladeCut&&) noexcept;

  /// Moves tissue and blade from their start to their end and splits what the blade has passed and left.
  /// Positions are 3 x numVertices(); the mesh may have got new vertices between two calls (see update()). A
  /// motion that is too long is refused and ends the stroke.
  /// index: as in cutMesh(), its tree fitted to both positions.
  /// Throws std::invalid_argument for positions or poses that are not finite; mesh and stroke are as they
  /// were.
  CutResult advance(PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions_start,
                    const Eigen::Ref<const Eigen::Matrix3Xd>& positions_end,
                    const Eigen::Isometry3d& T_world_tool_start, const Eigen::Isometry3d& T_world_tool_end,
                    int cut, MeshIndex* index = nullptr);

  /// Splits up to where the blade stands: what it has passed, whether or not it has left it, and the cells in
  /// which it stands, divided there (front_closure.hpp). The stroke goes on. Cells divided without being
  /// opened are not counted in CutResult::cells_split.
  CutResult closeFront(PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions, int cut,
                       MeshIndex* index = nullptr);

  /// Ends the stroke: closeFront(), then forgets what is still crossed.
  CutResult finish(PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions, int cut,
                   MeshIndex* index = nullptr);

  /// Forgets everything remembered, without cutting.
  void forget();

  /// To be called when another blade or a service has changed the mesh.
  void update(const PolyhedralMesh& mesh, const MeshChange& change);

  struct Impl;

  /// How far the last advance() has moved the blade relative to the tissue, in localSize near it; 0 while it
  /// has crossed nothing.
  double travelInSizes() const;
  /// Edges remembered as crossed and not yet split.
  int numPending() const;
  /// Where they are crossed, as the body lies in positions (3 x n [m]): 3 x numPending() [m], by the edges'
  /// vertices, ascending.
  Eigen::Matrix3Xd pendingPoints(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) const;
  /// Whether a stroke is under way: the blade has crossed an edge and has not left the tissue since.
  bool isCutting() const;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace polyscalpel
