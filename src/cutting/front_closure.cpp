// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/front_closure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include <Eigen/Geometry>

#include "polyscalpel/cutting/blade_distance.hpp"
#include "polyscalpel/cutting/plane_hit.hpp"
#include "polyscalpel/cutting/split_cells.hpp"
#include "polyscalpel/geometry/predicates.hpp"
#include "polyscalpel/geometry/triangle.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Positions = Eigen::Ref<const Matrix3Xd>;

/// A blade that travels along itself, within this sine, sweeps no surface.
constexpr double kSmallestSine = 0.05;

/// Snap tolerance of the planes that close the front, as part of that of the cut: the front is to end within
/// the latter, whose crossings may lie as far off.
constexpr double kFrontSnap = 0.5;

/// Relative difference of the distances to two segments that meet in the corner nearest to a point: rounding.
constexpr double kSameCorner = 1e-9;
/// A section that is no further from the front than this, in localSize, lies on it: rounding.
constexpr double kOnFront = 1e-9;

struct Plane {
  Vector3d point, normal;
};

/// One segment of the blade, with the planes that close its front.
class SegmentFront {
 public:
  SegmentFront(MeshEditor& editor, Crossings& crossings, Matrix3Xd& positions, double snap_tolerance,
               double surface_snap)
      : editor_(editor),
        crossings_(crossings),
        positions_(positions),
        plane_snap_(kFrontSnap * snap_tolerance),
        surface_snap_(surface_snap) {}

  int close(const std::vector<CellId>& candidates, const std::vector<FrontSegment>& front,
            const FrontSegment& segment) {
    p_ = segment.start_world;
    way_ = segment.end_world - p_;
    const Vector3d& travel = segment.travel_world;
    sheet_normal_ = segment.sheetNormal();
    if (sheet_normal_.isZero(0)) return 0;

    const Vector3d direction = travel.normalized();
    std::array<std::unordered_set<CellId>, 2> passed;  // by each end of the segment
    for (const CellId id : candidates) {
      // Where the blade has come less than the snap distance far into a cell, the front is that cell's face,
      // and the cell behind it is to be closed.
      const Vector3d back = plane_snap_ * mesh().localSize(id) * direction;
      if (!meets(id, p_, p_ + way_) && !meets(id, p_ - back, p_ - back + way_)) continue;
      origins_[id] = id;
      for (const int end : {0, 1}) {
        if (!segment.is_tip[end]) continue;
        const Vector3d tip = p_ + end * way_;
        if (meets(id, tip - segment.side_length_m * direction, tip)) passed[end].insert(id);
      }
    }
    if (origins_.empty()) return 0;

    // The travel across the segment within the sheet points forward.
    forward_ = sheet_normal_.cross(way_).normalized();
    Crossings front_plane;
    const Plane at_blade{p_, forward_};
    int count = divide(at_blade, front_plane, [](CellId) { return true; });
    // Where the planes of two segments divide one cell, they meet in an edge by the blade's corner, off it by
    // as much as the two planes together give way to vertices.
    const Vector3d along = way_.normalized();
    remember(front_plane, at_blade, [&](const Vector3d& point, double reach) {
      const double place = along.dot(point - p_);
      if (place >= 0 && place <= way_.norm()) return true;
      return std::any_of(front.begin(), front.end(), [&](const FrontSegment& other) {
        return closestPointsOfSegments(point, point, other.start_world, other.end_world).squared_distance <
               4 * reach * reach;
      });
    });
    for (const int end : {0, 1}) {
      if (!segment.is_tip[end]) continue;
      const Vector3d tip = p_ + end * way_;
      Crossings end_plane;
      const Plane at_tip{tip, sheet_normal_.cross(direction)};
      count += divide(at_tip, end_plane,
                      [&](CellId id) { return passed[end].count(origins_.at(id)) > 0 && isBehind(id); });
      remember(end_plane, at_tip, [&](const Vector3d& point, double) {
        return direction.dot(tip - point) <= segment.side_length_m;
      });
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
      if (std::abs(height) < plane_snap_ * mesh().localSize(v) && !crossings.isOnCut(v))
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
        if (hit.sign != 0) crossings.add(mesh(), hit, plane_snap_);
      }
      snapNear(id, plane, crossings);
    }
    const int first_new = mesh().cellCapacity();
    const std::size_t savepoint = editor_.savepoint();
    const SplitCounts counts = splitCells(
        editor_, crossings, [&](CellId id) { return id.index() >= first_new || wanted.count(id) > 0; },
        plane_snap_, 0, Slit::kClosed);
    const MeshChange change = editor_.changeSince(savepoint);
    extendByNewVertices(change.new_vertices, positions_);
    crossings_.update(mesh(), change);
    for (const NewVertex& made : change.new_vertices) {
      crossings_.snapNear(mesh(), made.vertex, plane_snap_);
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
          plane_snap_ * std::min(mesh().localSize(edge.first), mesh().localSize(edge.second));
      const bool is_in_front = dividing.isOnCut(edge.first) && dividing.isOnCut(edge.second);
      const bool is_near =
          std::abs(normal.dot(point - plane.point)) < reach && forward_.dot(point - p_) < reach;
      if ((is_in_front || is_near) && has_passed(point, reach)) crossings_.add(mesh(), hit, surface_snap_);
    }
  }

  MeshEditor& editor_;
  Crossings& crossings_;
  Matrix3Xd& positions_;
  double plane_snap_;    // of the planes that close the front
  double surface_snap_;  // of the blade's own surface there
  Vector3d p_, way_, sheet_normal_, forward_;
  std::unordered_map<CellId, CellId> origins_;  // cells in which the blade stands and their parts
};

/// Cells that a segment may meet, or come within the snap distance of, ascending.
std::vector<CellId> cellsNear(const PolyhedralMesh& mesh, const CellTree& tree, const FrontSegment& segment,
                              double snap_tolerance) {
  Matrix3Xd ends(3, 2);
  ends << segment.start_world, segment.end_world;
  const double largest_coordinate = ends.cwiseAbs().maxCoeff();
  std::vector<CellId> near;
  tree.visit(
      mesh,
      [&](const CellTree::Bound& bound) {
        return meets(bound.box, ends, atLeast(snap_tolerance * bound.largest_size, largest_coordinate));
      },
      [&](CellId id) {
        near.push_back(id);
        return true;
      });
  std::sort(near.begin(), near.end());
  return near;
}

/// Mean of the points in which the surface goes through a cell's edges and vertices.
std::optional<Vector3d> middleOfSection(const PolyhedralMesh& mesh, const Crossings& crossings,
                                        const Positions& positions, CellId id) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (const VertexId v : mesh.cell(id).vertices) {
    if (!crossings.isSnapped(id, v)) continue;
    sum += positions.col(v.index());
    ++count;
  }
  for (const Edge& edge : mesh.edges(id)) {
    const CrossedEdge* crossed = crossings.find(id, edge);
    if (!crossed) continue;
    sum += (1 - crossed->weight) * positions.col(edge.first.index()) +
           crossed->weight * positions.col(edge.second.index());
    ++count;
  }
  if (count == 0) return std::nullopt;
  return Vector3d(sum / count);
}

/// How far a point lies beyond the front [m], along the travel as seen from the nearest point of the front;
/// where this is a corner, the sum for the two segments that meet there.
double heightBeyond(const std::vector<FrontSegment>& front, const Vector3d& point) {
  double nearest = kInfinity, height = 0;
  for (const FrontSegment& segment : front) {
    const ClosestPoints closest =
        closestPointsOfSegments(point, point, segment.start_world, segment.end_world);
    const double distance = std::sqrt(closest.squared_distance);
    if (distance > (1 + kSameCorner) * nearest) continue;
    if (distance < (1 - kSameCorner) * nearest) height = 0;
    nearest = std::min(nearest, distance);
    const Vector3d along = (segment.end_world - segment.start_world).normalized();
    const Vector3d outward = segment.travel_world - along.dot(segment.travel_world) * along;
    height += outward.normalized().dot(point - closest.second);
  }
  return height;
}

/// Whether a cell, whose section with the surface has this middle, lies beyond the front. A section that lies
/// on the front, as a facet of a dividing face does whose corners are all snapped, tells nothing but by
/// rounding: the cell itself is on one side of it.
bool isBeyond(const PolyhedralMesh& mesh, const Positions& positions, const std::vector<FrontSegment>& front,
              CellId id, const Vector3d& middle_of_section) {
  const double height = heightBeyond(front, middle_of_section);
  if (std::abs(height) >= kOnFront * mesh.localSize(id)) return height > 0;
  Vector3d mean = Vector3d::Zero();
  for (const VertexId v : mesh.cell(id).vertices) mean += positions.col(v.index());
  return heightBeyond(front, mean / static_cast<double>(mesh.cell(id).vertices.size())) > 0;
}

}  // namespace

Vector3d FrontSegment::sheetNormal() const {
  const Vector3d way = end_world - start_world, normal = way.cross(travel_world);
  return normal.norm() <= kSmallestSine * way.norm() * travel_world.norm() ? Vector3d(Vector3d::Zero())
                                                                           : normal;
}

std::vector<FrontSegment> makeFront(const BladeFront& blade) {
  std::vector<FrontSegment> front;
  const Eigen::Index num_segments = blade.blade_world.cols() - 1;
  for (Eigen::Index i = 0; i < num_segments; ++i) {
    front.push_back({blade.blade_world.col(i),
                     blade.blade_world.col(i + 1),
                     0.5 * (blade.travel_world.col(i) + blade.travel_world.col(i + 1)),
                     {i == 0, i + 1 == num_segments},
                     blade.stroke_length_m});
  }
  return front;
}

std::vector<FrontSegment> makeFront(const PolygonCut& polygon) {
  const Matrix3Xd& corners = polygon.corners_world;
  const Vector3d normal = polygon.areaVector().stableNormalized();
  std::vector<FrontSegment> front;
  for (Eigen::Index i = 0; i < corners.cols(); ++i) {
    // Against the order of the corners: way x travel is then the polygon's normal, as it is a sweep's.
    const Vector3d start = corners.col((i + 1) % corners.cols()), end = corners.col(i);
    front.push_back({start, end, normal.cross(end - start)});
  }
  return front;
}

int closeFront(MeshEditor& editor, CellTree& tree, Crossings& crossings, Matrix3Xd& positions,
               const std::vector<FrontSegment>& front, double snap_tolerance, double surface_snap) {
  int count = 0;
  for (const FrontSegment& segment : front) {
    const std::vector<CellId> near = cellsNear(editor.mesh(), tree, segment, snap_tolerance);
    const std::size_t savepoint = editor.savepoint();
    count +=
        SegmentFront(editor, crossings, positions, snap_tolerance, surface_snap).close(near, front, segment);
    if (editor.savepoint() > savepoint) tree.update(editor.mesh(), editor.changeSince(savepoint));
  }
  return count;
}

std::unordered_set<CellId> cellsBeyond(const PolyhedralMesh& mesh, const CellTree& tree,
                                       const Crossings& crossings, const Positions& positions,
                                       const std::vector<FrontSegment>& front, double snap_tolerance) {
  std::unordered_set<CellId> beyond;
  std::unordered_set<CellId> known;
  for (const FrontSegment& segment : front) {
    for (const CellId id : cellsNear(mesh, tree, segment, snap_tolerance)) {
      if (!known.insert(id).second) continue;
      const std::optional<Vector3d> middle = middleOfSection(mesh, crossings, positions, id);
      if (middle && isBeyond(mesh, positions, front, id, *middle)) beyond.insert(id);
    }
  }
  return beyond;
}

}  // namespace polyscalpel
