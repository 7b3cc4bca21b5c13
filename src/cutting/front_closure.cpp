// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/front_closure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include <Eigen/Geometry>

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
    const Vector3d forward = sheet_normal_.cross(way_);
    Crossings front_plane;
    int count = divide({p_, forward}, front_plane, [](CellId) { return true; });
    remember(front_plane, [&](const Vector3d& point) {
      const double along = way_.dot(point - p_);
      return along >= 0 && along <= way_.squaredNorm();
    });
    for (const int end : {0, 1}) {
      if (!(end == 0 ? is_first : is_last)) continue;
      const Vector3d tip = p_ + end * way_;
      Crossings end_plane;
      count += divide({tip, sheet_normal_.cross(direction)}, end_plane, [&](CellId id) {
        return passed[end].count(origins_.at(id)) > 0 && isBehind(id, forward);
      });
      remember(end_plane, [&](const Vector3d& point) {
        return direction.dot(tip - point) <= front.stroke_length_m;  // all of it lies behind the segment
      });
    }
    return count;
  }

 private:
  const PolyhedralMesh& mesh() const { return editor_.mesh(); }

  /// Whether the segment a-b meets the inside of a cell, whose faces are taken as planes (Cyrus and Beck
  /// 1978).
  bool meets(CellId id, const Vector3d& a, const Vector3d& b) const {
    double enter = 0, leave = 1;
    for (const FaceId face_id : mesh().cell(id).faces) {
      const Face& face = mesh().face(face_id);
      const auto [origin, area] = planeOf(face, positions_);
      const double sense = face.cells[0] == id ? 1 : -1;
      const double height = sense * area.dot(a - origin), rise = sense * area.dot(b - a);
      if (rise == 0) {
        if (height > 0) return false;
      } else if (rise > 0) {
        leave = std::min(leave, -height / rise);
      } else {
        enter = std::max(enter, -height / rise);
      }
    }
    return enter < leave;
  }

  bool isBehind(CellId id, const Vector3d& forward) const {
    double sum = 0;
    for (const VertexId v : mesh().cell(id).vertices) sum += forward.dot(positions_.col(v.index()) - p_);
    return sum < 0;
  }

  Hit hitOf(const Edge& edge, const Plane& plane) const {
    const Vector3d a = positions_.col(edge.first.index()), b = positions_.col(edge.second.index());
    const int side_a = sideOfPlane(a, plane.point, plane.normal),
              side_b = sideOfPlane(b, plane.point, plane.normal);
    Hit hit{edge, 0, 0, 1};
    if (side_a == side_b) return hit;
    const double to_a = std::max(0.0, side_a * plane.normal.dot(a - plane.point)),
                 to_b = std::max(0.0, side_b * plane.normal.dot(b - plane.point));
    hit.sign = side_b;
    hit.weight = to_a + to_b > 0 ? to_a / (to_a + to_b) : 0.5;
    hit.alignment = std::abs((b - a).normalized().dot(plane.normal.normalized()));
    return hit;
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

  /// Remembers the edges in the dividing faces where the blade's sheet meets them and has_passed holds.
  template <class HasPassed>
  void remember(const Crossings& dividing, const HasPassed& has_passed) {
    std::vector<Edge> edges;
    for (const auto& [id, origin] : origins_) {
      if (!mesh().cell(id).isAlive()) continue;
      for (const Edge& edge : mesh().edges(id)) {
        if (dividing.isOnCut(edge.first) && dividing.isOnCut(edge.second)) edges.push_back(edge);
      }
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (const Edge& edge : edges) {
      const Hit hit = hitOf(edge, {p_, sheet_normal_});
      const Vector3d point = (1 - hit.weight) * positions_.col(edge.first.index()) +
                             hit.weight * positions_.col(edge.second.index());
      if (hit.sign != 0 && has_passed(point)) crossings_.add(mesh(), hit, snap_tolerance_);
    }
  }

  MeshEditor& editor_;
  Crossings& crossings_;
  Matrix3Xd& positions_;
  double snap_tolerance_;
  Vector3d p_, way_, sheet_normal_;
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
