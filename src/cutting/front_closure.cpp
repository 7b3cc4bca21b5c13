// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/front_closure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include <Eigen/Geometry>

#include "polyscalpel/cutting/blade_distance.hpp"
#include "polyscalpel/cutting/plane_hit.hpp"
#include "polyscalpel/cutting/split_cells.hpp"
#include "polyscalpel/geometry/predicates.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// A blade that travels along itself, within this sine, sweeps no surface.
constexpr double kSmallestSine = 0.05;

/// Snap tolerance of the planes that close the front, as part of that of the cut: the front is to end within
/// the latter, whose crossings may lie as far off.
constexpr double kFrontSnap = 0.5;

/// Part of a segment by which a point beyond its end belongs to it.
constexpr double kRounding = 1e-9;

struct Plane {
  Vector3d point, normal;
};

/// One segment of the blade, with the planes that close its front.
class SegmentFront {
 public:
  SegmentFront(MeshEditor& editor, Crossings& crossings, Matrix3Xd& positions, double snap_tolerance)
      : editor_(editor), crossings_(crossings), positions_(positions), snap_tolerance_(snap_tolerance) {}

  int close(const std::vector<CellId>& candidates, const BladeFront& front, Eigen::Index segment,
            bool is_first, bool is_last) {
    p_ = front.blade_world.col(segment);
    way_ = front.blade_world.col(segment + 1) - p_;
    const Vector3d travel = 0.5 * (front.travel_world.col(segment) + front.travel_world.col(segment + 1));
    sheet_normal_ = way_.cross(travel);
    if (sheet_normal_.norm() <= kSmallestSine * way_.norm() * travel.norm()) return 0;

    const Vector3d direction = travel.normalized();
    std::array<std::unordered_set<CellId>, 2> passed;  // by each end of the segment
    for (const CellId id : candidates) {
      // Where the blade has come less than the snap distance far into a cell, the front is that cell's face,
      // and the cell behind it is to be closed.
      const Vector3d back = snap_tolerance_ * mesh().localSize(id) * direction;
      if (!meets(id, p_, p_ + way_) && !meets(id, p_ - back, p_ - back + way_)) continue;
      origins_[id] = id;
      for (const int end : {0, 1}) {
        const Vector3d tip = p_ + end * way_;
        if (meets(id, tip - front.stroke_length_m * direction, tip)) passed[end].insert(id);
      }
    }
    if (origins_.empty()) return 0;

    // The travel across the segment within the sheet points forward.
    forward_ = sheet_normal_.cross(way_).normalized();
    Crossings front_plane;
    const Plane at_blade{p_, forward_};
    int count = divide(at_blade, front_plane, [](CellId) { return true; });
    // Where the planes of two segments divide one cell, they meet in an edge through the blade's corner.
    const double rounding = kRounding * way_.squaredNorm();
    remember(front_plane, at_blade, [&](const Vector3d& point) {
      const double along = way_.dot(point - p_);
      return along >= -rounding && along <= way_.squaredNorm() + rounding;
    });
    for (const int end : {0, 1}) {
      if (!(end == 0 ? is_first : is_last)) continue;
      const Vector3d tip = p_ + end * way_;
      Crossings end_plane;
      const Plane at_tip{tip, sheet_normal_.cross(direction)};
      count += divide(at_tip, end_plane,
                      [&](CellId id) { return passed[end].count(origins_.at(id)) > 0 && isBehind(id); });
      remember(end_plane, at_tip,
               [&](const Vector3d& point) { return direction.dot(tip - point) <= front.stroke_length_m; });
    }
    return count;
  }

 private:
  const PolyhedralMesh& mesh() const { return editor_.mesh(); }

  bool meets(CellId id, const Vector3d& a, const Vector3d& b) const {
    return meetsCell(mesh(), id, positions_, a, b);
  }

  bool isBehind(CellId id) const {
    double sum = 0;
    for (const VertexId v : mesh().cell(id).vertices) sum += forward_.dot(positions_.col(v.index()) - p_);
    return sum < 0;
  }

  /// With sign 0 where the plane does not separate the ends.
  Hit hitOf(const Edge& edge, const Plane& plane) const {
    const Vector3d a = positions_.col(edge.first.index()), b = positions_.col(edge.second.index());
    const int side_a = sideOfPlane(a, plane.point, plane.normal),
              side_b = sideOfPlane(b, plane.point, plane.normal);
    if (side_a == side_b) return {edge};
    return hitOnPlane(edge, a, b, plane.point, plane.normal.normalized(), side_b);
  }

  /// Has the plane go through the corners that are near it, also where the cell lies on one side of it: then
  /// its front is a face of the cell.
  void snapNear(CellId id, const Plane& plane, Crossings& crossings) const {
    const Vector3d normal = plane.normal.normalized();
    for (const VertexId v : mesh().cell(id).vertices) {
      const double height = normal.dot(positions_.col(v.index()) - plane.point);
      if (std::abs(height) < snap_tolerance_ * mesh().localSize(v) && !crossings.isOnCut(v))
        crossings.snap(mesh(), v, height > 0 ? 1 : -1);
    }
  }

  /// Divides the cells under way that are wanted by a closed plane.
  template <class IsWanted>
  int divide(const Plane& plane, Crossings& crossings, const IsWanted& is_wanted) {
    std::unordered_set<CellId> wanted;
    for (const auto& [id, origin] : origins_) {
      if (mesh().cell(id).isAlive() && is_wanted(id)) wanted.insert(id);
    }
    std::vector<CellId> ordered(wanted.begin(), wanted.end());
    std::sort(ordered.begin(), ordered.end());
    for (const CellId id : ordered) {
      for (const Edge& edge : mesh().edges(id)) {
        const Hit hit = hitOf(edge, plane);
        if (hit.sign != 0) crossings.add(mesh(), hit, snap_tolerance_);
      }
      snapNear(id, plane, crossings);
    }
    const int first_new = mesh().cellCapacity();
    const std::size_t savepoint = editor_.savepoint();
    const SplitCounts counts = splitCells(
        editor_, crossings, [&](CellId id) { return id.index() >= first_new || wanted.count(id) > 0; },
        snap_tolerance_, 0, Slit::kClosed);
    const MeshChange change = editor_.changeSince(savepoint);
    extendByNewVertices(change.new_vertices, positions_);
    crossings_.update(mesh(), change);
    for (const NewVertex& made : change.new_vertices) {
      crossings_.snapNear(mesh(), made.vertex, snap_tolerance_);
    }
    for (const NewCell& cell : change.new_cells) origins_[cell.cell] = origins_.at(cell.parent);
    return counts.cells_split;
  }

  /// Remembers the edges in the dividing faces where the blade's sheet meets them and has_passed holds, and
  /// those behind the blade that the plane passes near: a front that is a cell's face has no dividing one.
  template <class HasPassed>
  void remember(const Crossings& dividing, const Plane& plane, const HasPassed& has_passed) {
    std::vector<Edge> edges;
    for (const auto& [id, origin] : origins_) {
      if (!mesh().cell(id).isAlive()) continue;
      for (const Edge& edge : mesh().edges(id)) edges.push_back(edge);
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    const Vector3d normal = plane.normal.normalized();
    for (const Edge& edge : edges) {
      const Hit hit = hitOf(edge, {p_, sheet_normal_});
      if (hit.sign == 0) continue;
      const Vector3d point = (1 - hit.weight) * positions_.col(edge.first.index()) +
                             hit.weight * positions_.col(edge.second.index());
      const double reach =
          snap_tolerance_ * std::min(mesh().localSize(edge.first), mesh().localSize(edge.second));
      const bool is_in_front = dividing.isOnCut(edge.first) && dividing.isOnCut(edge.second);
      const bool is_near =
          std::abs(normal.dot(point - plane.point)) < reach && forward_.dot(point - p_) < reach;
      if ((is_in_front || is_near) && has_passed(point)) crossings_.add(mesh(), hit, snap_tolerance_);
    }
  }

  MeshEditor& editor_;
  Crossings& crossings_;
  Matrix3Xd& positions_;
  double snap_tolerance_;
  Vector3d p_, way_, sheet_normal_, forward_;
  std::unordered_map<CellId, CellId> origins_;  // cells in which the blade stands and their parts
};

}  // namespace

int closeFront(MeshEditor& editor, CellTree& tree, Crossings& crossings, Matrix3Xd& positions,
               const BladeFront& front, double snap_tolerance) {
  int count = 0;
  const Eigen::Index num_segments = front.blade_world.cols() - 1;
  for (Eigen::Index i = 0; i < num_segments; ++i) {
    const Eigen::AlignedBox3d reach(front.blade_world.col(i).cwiseMin(front.blade_world.col(i + 1)),
                                    front.blade_world.col(i).cwiseMax(front.blade_world.col(i + 1)));
    std::vector<CellId> near;
    tree.visit(
        editor.mesh(),
        [&](CellTree::Bound bound) {
          bound.box.min().array() -= snap_tolerance * bound.largest_size;
          bound.box.max().array() += snap_tolerance * bound.largest_size;
          return bound.box.intersects(reach);
        },
        [&](CellId id) {
          near.push_back(id);
          return true;
        });
    std::sort(near.begin(), near.end());
    const std::size_t savepoint = editor.savepoint();
    SegmentFront segment(editor, crossings, positions, kFrontSnap * snap_tolerance);
    count += segment.close(near, front, i, i == 0, i + 1 == num_segments);
    if (editor.savepoint() > savepoint) tree.update(editor.mesh(), editor.changeSince(savepoint));
  }
  return count;
}

}  // namespace polyscalpel
