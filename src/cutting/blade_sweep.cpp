// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/blade_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "polyscalpel/cutting/blade_distance.hpp"
#include "polyscalpel/cutting/plane_hit.hpp"
#include "polyscalpel/geometry/predicates.hpp"
#include "polyscalpel/geometry/triangle.hpp"

namespace polyscalpel {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Positions = Eigen::Ref<const Matrix3Xd>;

constexpr int kMostHalvings = 8;

/// The two triangles that stand for what a segment of the blade sweeps in a sub-step are to be no further
/// from its ruled surface than this times localSize.
constexpr double kLargestSag = 0.01;

AlignedBox3d boxOf(const Positions& points) {
  return {Vector3d(points.rowwise().minCoeff()), Vector3d(points.rowwise().maxCoeff())};
}

void sortUnique(std::vector<Edge>& edges) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

/// Edges for whose box, over the motion of the tissue, is_near holds, as it does for the box of a cell that
/// has them.
template <class IsNear>
std::vector<Edge> edgesNear(const PolyhedralMesh& mesh, const CellTree& tree,
                            const Positions& positions_start, const Positions& positions_end,
                            const IsNear& is_near) {
  std::vector<Edge> edges;
  const bool moves = positions_start.data() != positions_end.data();
  const auto extend = [&](AlignedBox3d& box, VertexId v) {
    box.extend(positions_start.col(v.index()));
    if (moves) box.extend(positions_end.col(v.index()));
  };
  tree.visit(
      mesh, [&](const CellTree::Bound& bound) { return is_near(bound.box); },
      [&](CellId id) {
        AlignedBox3d cell_box;
        for (const VertexId v : mesh.cell(id).vertices) extend(cell_box, v);
        if (!is_near(cell_box)) return true;
        mesh.forEachEdge(id, [&](VertexId a, VertexId b) {
          AlignedBox3d edge_box;
          extend(edge_box, a);
          extend(edge_box, b);
          if (is_near(edge_box)) edges.emplace_back(a, b);
        });
        return true;
      });
  sortUnique(edges);
  return edges;
}

/// The points within a distance of a plane.
class Slab {
 public:
  Slab(const Vector3d& point, const Vector3d& normal) : point_(point), normal_(normal) {}

  /// Makes it thick enough for the point.
  void extend(const Vector3d& point) {
    half_thickness_ = std::max(half_thickness_, std::abs(normal_.dot(point - point_)));
  }

  /// Whether the box meets it; also where rounding leaves that open.
  bool meets(const AlignedBox3d& box) const {
    if (box.isEmpty()) return false;
    const Vector3d centre = box.center() - point_, half = 0.5 * box.sizes();
    const Vector3d normal = normal_.cwiseAbs();
    const double rounding =
        kRounding * normal.dot(box.min().cwiseAbs() + box.max().cwiseAbs() + point_.cwiseAbs());
    return std::abs(normal_.dot(centre)) <= normal.dot(half) + half_thickness_ + rounding;
  }

 private:
  static constexpr double kRounding = 1e-14;
  Vector3d point_, normal_;
  double half_thickness_ = 0;
};

double absoluteCosine(const Vector3d& a, const Vector3d& b) {
  const double norms = a.norm() * b.norm();
  return norms > 0 ? std::abs(a.dot(b)) / norms : 1;
}

/// Sum of the signed hits of one edge, and where the last hit of either sign was.
class SignedSum {
 public:
  void add(int sign, double weight, const Vector3d& edge, const Vector3d& normal) {
    sum_ += sign;
    ++count_;
    last_[sign > 0] = {weight, absoluteCosine(edge, normal), normal};
  }
  bool isEven() const { return count_ > 0 && count_ % 2 == 0; }
  bool isHit() const { return sum_ != 0; }
  Hit hit(Edge edge, bool is_flat) const {
    const Last& last = last_[sum_ > 0];
    return {edge, last.weight, sum_ > 0 ? 1 : -1, last.alignment,
            is_flat ? Vector3d::Zero() : last.normal.stableNormalized()};
  }

 private:
  struct Last {
    double weight = 0, alignment = 1;
    Vector3d normal;
  };
  int sum_ = 0, count_ = 0;
  Last last_[2];
};

/// No point of the blade is ever further from where it starts than this, whatever turning and travel add up
/// to.
double longestWay(const Matrix3Xd& edge_tool, const Isometry3d& T_start, const Isometry3d& T_end) {
  const Matrix3Xd turned = T_end.linear() * edge_tool;
  return (turned - T_start.linear() * edge_tool).colwise().norm().maxCoeff() +
         (T_end.translation() - T_start.translation()).norm();
}

/// By how much more one end of a segment of the blade travels than its other end would, were it not for the
/// turning: a sum over the ways of sub-steps.
double longestTwist(const Matrix3Xd& edge_tool, const Isometry3d& T_start, const Isometry3d& T_end) {
  const double angle =
      Eigen::Quaterniond(T_start.linear()).angularDistance(Eigen::Quaterniond(T_end.linear()));
  const Eigen::Index last = edge_tool.cols() - 1;
  return angle * (edge_tool.rightCols(last) - edge_tool.leftCols(last)).colwise().norm().maxCoeff();
}

/// The travel of a blade, by so much larger that rounding takes nothing away that it reaches.
double reachOfMotion(const Matrix3Xd& blade, double travel) {
  return atLeast(travel, blade.cwiseAbs().maxCoeff() + travel);
}

/// One sub-step of a blade's motion, cut out of the whole step by fractions.
class Sweep {
 public:
  Sweep(const PolyhedralMesh& mesh, const CellTree& tree, const BladeMotion& motion) : motion_(motion) {
    moves_ = motion.positions_start.data() != motion.positions_end.data();
    const Matrix3Xd start = bladeAt(0);
    const double travel = longestWay(motion.edge_tool, motion.T_world_tool_start, motion.T_world_tool_end);
    edges_ = edgesNear(mesh, tree, motion.positions_start, motion.positions_end,
                       [&, reach = reachOfMotion(start, travel)](const AlignedBox3d& box) {
                         return meets(box, start, reach);
                       });
    edges_.erase(std::remove_if(edges_.begin(), edges_.end(),
                                [&](const Edge& edge) { return !isInReach(edge, start, travel); }),
                 edges_.end());

    double size = kInfinity, drift = 0;
    for (const auto& [a, b] : edges_) {
      for (const VertexId v : {a, b}) {
        size = std::min(size, mesh.localSize(v));
        drift = std::max(drift, driftOf(v));
      }
    }
    if (edges_.empty()) return;
    travel_in_sizes_ = (travel + drift) / size;
    twist_in_sizes_ =
        longestTwist(motion.edge_tool, motion.T_world_tool_start, motion.T_world_tool_end) / size;
  }

  /// Longest way of the blade relative to the tissue over the step, as a multiple of the smallest localSize
  /// near it.
  double travelInSizes() const { return travel_in_sizes_; }

  /// Likewise, longest way of one end of a segment of the blade relative to its other end.
  double twistInSizes() const { return twist_in_sizes_; }

  void findHits(double from, double to, int halvings_left, std::vector<Hit>& hits) const {
    if (edges_.empty()) return;
    const Matrix3Xd blade_start = bladeAt(from), blade_end = bladeAt(to);
    const double reach = reachOfMotion(blade_start, (blade_end - blade_start).colwise().norm().maxCoeff());

    std::vector<Hit> found;
    for (const Edge& edge : edges_) {
      const auto [a, b] = edge;
      const Vector3d a_start = positionAt(a, from), b_start = positionAt(b, from);
      const Vector3d a_end = moves_ ? positionAt(a, to) : a_start,
                     b_end = moves_ ? positionAt(b, to) : b_start;
      AlignedBox3d box(a_start.cwiseMin(b_start), a_start.cwiseMax(b_start));
      if (moves_) box.extend(a_end).extend(b_end);
      if (!meets(box, blade_start, reach)) continue;

      SignedSum sum;
      const EdgeMotion way{a_start, b_start, a_end, b_end};
      addToolHalf(blade_start, blade_end, way, sum);
      if (moves_) addTissueHalf(blade_start, blade_end, way, sum);
      if (sum.isEven() && halvings_left > 0) {
        const double middle = 0.5 * (from + to);
        findHits(from, middle, halvings_left - 1, hits);
        findHits(middle, to, halvings_left - 1, hits);
        return;
      }
      if (sum.isHit()) found.push_back(sum.hit(edge, false));
    }
    hits.insert(hits.end(), found.begin(), found.end());
  }

 private:
  /// How far the tissue moves at a vertex [m].
  double driftOf(VertexId v) const {
    return moves_ ? (motion_.positions_end.col(v.index()) - motion_.positions_start.col(v.index())).norm()
                  : 0;
  }

  /// Whether blade and edge may meet, wherever they lie along the axes: the sub-steps depend on these edges.
  /// A blade that ends its way on an edge is exactly as far from it as it goes; whether it has crossed it is
  /// for the exact predicates to say.
  bool isInReach(const Edge& edge, const Matrix3Xd& blade, double travel) const {
    const Vector3d a = motion_.positions_start.col(edge.first.index()),
                   b = motion_.positions_start.col(edge.second.index());
    const double coordinate =
        std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), blade.cwiseAbs().maxCoeff()});
    const double reach = atLeast(travel + std::max(driftOf(edge.first), driftOf(edge.second)), coordinate);
    for (Eigen::Index i = 0; i + 1 < blade.cols(); ++i) {
      if (closestPointsOfSegments(a, b, blade.col(i), blade.col(i + 1)).squared_distance <= reach * reach)
        return true;
    }
    return false;
  }

  Matrix3Xd bladeAt(double s) const {
    return interpolate(motion_.T_world_tool_start, motion_.T_world_tool_end, s) * motion_.edge_tool;
  }

  Vector3d positionAt(VertexId v, double s) const {
    if (!moves_ || s == 0) return motion_.positions_start.col(v.index());
    if (s == 1) return motion_.positions_end.col(v.index());
    return (1 - s) * motion_.positions_start.col(v.index()) + s * motion_.positions_end.col(v.index());
  }

  /// An edge over a sub-step.
  struct EdgeMotion {
    Vector3d a_start, b_start, a_end, b_end;
    Vector3d travelAt(double weight) const {
      return (1 - weight) * (a_end - a_start) + weight * (b_end - b_start);
    }
  };

  // The normal of the surface, at a hit, is that of the way of the blade relative to the tissue. The
  // triangles of either half are tilted against it, as is what a long blade that turns sweeps in one
  // sub-step.

  /// The edge where it starts against the triangles swept by the blade's segments.
  static void addToolHalf(const Matrix3Xd& start, const Matrix3Xd& end, const EdgeMotion& edge,
                          SignedSum& sum) {
    const Vector3d &a = edge.a_start, &b = edge.b_start;
    for (int i = 0; i + 1 < start.cols(); ++i) {
      const Vector3d p0 = start.col(i), p1 = end.col(i), q0 = start.col(i + 1), q1 = end.col(i + 1);
      const auto add = [&](const TriangleCrossing& crossing, double along, double time) {
        const double weight = crossing.segment_parameter;
        const Vector3d blade = (1 - time) * (q0 - p0) + time * (q1 - p1),
                       travel = (1 - along) * (p1 - p0) + along * (q1 - q0);
        sum.add(crossing.sign, weight, b - a, blade.cross(travel - edge.travelAt(weight)));
      };
      const TriangleCrossing first = crossTriangle(a, b, p0, q0, q1, MeshPart::kSegment);
      if (first.sign != 0) add(first, first.barycentric[1] + first.barycentric[2], first.barycentric[2]);
      const TriangleCrossing second = crossTriangle(a, b, p0, q1, p1, MeshPart::kSegment);
      if (second.sign != 0) add(second, second.barycentric[1], second.barycentric[1] + second.barycentric[2]);
    }
  }

  /// The blade's segments where they end against the triangles swept by the edge. The sign is that of the
  /// tool half for the same relative motion: det(edge, segment, -motion of the tissue) = segment . (edge x
  /// motion of the tissue).
  static void addTissueHalf(const Matrix3Xd& start, const Matrix3Xd& end, const EdgeMotion& edge,
                            SignedSum& sum) {
    const Vector3d &a0 = edge.a_start, &b0 = edge.b_start, &a1 = edge.a_end, &b1 = edge.b_end;
    for (int i = 0; i + 1 < end.cols(); ++i) {
      const Vector3d p = end.col(i), q = end.col(i + 1);
      const auto add = [&](const TriangleCrossing& crossing, double weight) {
        const double along = crossing.segment_parameter;
        const Vector3d travel = (1 - along) * (p - start.col(i)) + along * (q - start.col(i + 1));
        sum.add(crossing.sign, weight, b0 - a0, (q - p).cross(travel - edge.travelAt(weight)));
      };
      const TriangleCrossing first = crossTriangle(p, q, a0, b0, b1, MeshPart::kTriangle);
      if (first.sign != 0) add(first, first.barycentric[1] + first.barycentric[2]);
      const TriangleCrossing second = crossTriangle(p, q, a0, b1, a1, MeshPart::kTriangle);
      if (second.sign != 0) add(second, second.barycentric[1]);
    }
  }

  const BladeMotion& motion_;
  std::vector<Edge> edges_;
  bool moves_ = false;
  double travel_in_sizes_ = 0, twist_in_sizes_ = 0;
};

}  // namespace

Isometry3d interpolate(const Isometry3d& T_start, const Isometry3d& T_end, double s) {
  if (s == 0) return T_start;
  if (s == 1) return T_end;
  const Eigen::Quaterniond start(T_start.linear()), end(T_end.linear());
  Isometry3d T = Isometry3d::Identity();
  T.linear() = start.slerp(s, end).toRotationMatrix();
  T.translation() = (1 - s) * T_start.translation() + s * T_end.translation();
  return T;
}

AlignedBox3d reachOf(const Matrix3Xd& edge_tool, const Isometry3d& T_start, const Isometry3d& T_end) {
  AlignedBox3d box = boxOf(T_start * edge_tool);
  const Vector3d travel = Vector3d::Constant(longestWay(edge_tool, T_start, T_end));
  return {box.min() - travel, box.max() + travel};
}

std::vector<Hit> findHits(const PolyhedralMesh& mesh, const CellTree& tree, const Positions& positions,
                          const PlaneCut& plane) {
  const Vector3d normal = plane.normal_world.stableNormalized();
  const Slab slab(plane.point_world, normal);
  const auto sideOf = [&](VertexId v) {
    return sideOfPlane(positions.col(v.index()), plane.point_world, plane.normal_world);
  };
  std::vector<std::pair<Edge, int>> crossed;  // with the side of edge.second
  std::vector<int> sides;                     // of the vertices of the cell at hand
  tree.visit(
      mesh, [&](const CellTree::Bound& bound) { return slab.meets(bound.box); },
      [&](CellId id) {
        const auto& vertices = mesh.cell(id).vertices;
        sides.clear();
        for (const VertexId v : vertices) sides.push_back(sideOf(v));
        if (std::all_of(sides.begin(), sides.end(), [&](int side) { return side == sides[0]; })) return true;
        const auto knownSide = [&](VertexId v) {
          return sides[std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin()];
        };
        mesh.forEachEdge(id, [&](VertexId a, VertexId b) {
          const int side_b = knownSide(b);
          if (knownSide(a) != side_b) crossed.emplace_back(Edge(a, b), side_b);
        });
        return true;
      });
  std::sort(crossed.begin(), crossed.end());
  crossed.erase(std::unique(crossed.begin(), crossed.end()), crossed.end());
  std::vector<Hit> hits;
  hits.reserve(crossed.size());
  for (const auto& [edge, side] : crossed) {
    hits.push_back(hitOnPlane(edge, positions.col(edge.first.index()), positions.col(edge.second.index()),
                              plane.point_world, normal, side));
  }
  return hits;
}

std::vector<Hit> findHits(const PolyhedralMesh& mesh, const CellTree& tree, const Positions& positions,
                          const PolygonCut& polygon) {
  const Matrix3Xd& corners = polygon.corners_world;
  std::vector<Hit> hits;
  const AlignedBox3d reach = boxOf(corners);
  Slab slab(corners.col(0), polygon.areaVector().stableNormalized());
  for (int i = 1; i < corners.cols(); ++i) slab.extend(corners.col(i));
  const auto is_near = [&](const AlignedBox3d& box) { return reach.intersects(box) && slab.meets(box); };
  for (const Edge& edge : edgesNear(mesh, tree, positions, positions, is_near)) {
    const Vector3d a = positions.col(edge.first.index()), b = positions.col(edge.second.index());
    SignedSum sum;
    for (int i = 1; i + 1 < corners.cols(); ++i) {
      const Vector3d u = corners.col(0), v = corners.col(i), w = corners.col(i + 1);
      const TriangleCrossing crossing = crossTriangle(a, b, u, v, w, MeshPart::kSegment);
      if (crossing.sign != 0) sum.add(crossing.sign, crossing.segment_parameter, b - a, (v - u).cross(w - u));
    }
    if (sum.isHit()) hits.push_back(sum.hit(edge, true));
  }
  return hits;
}

std::optional<std::vector<Hit>> findHits(const PolyhedralMesh& mesh, const CellTree& tree,
                                         const BladeMotion& motion, double max_travel) {
  const Sweep sweep(mesh, tree, motion);
  const double for_travel = std::ceil(sweep.travelInSizes() / max_travel);
  if (!(for_travel <= kMostSubSteps)) return std::nullopt;
  // A quadrilateral whose ends differ by a twist is a quarter of that off its two triangles in its middle.
  const double for_twist = std::ceil(sweep.twistInSizes() / (4 * kLargestSag));
  const int count = static_cast<int>(std::clamp(std::max(for_travel, for_twist), 1.0, double{kMostSubSteps}));
  std::vector<Hit> hits;
  for (int i = 0; i < count; ++i) {
    sweep.findHits(static_cast<double>(i) / count, static_cast<double>(i + 1) / count, kMostHalvings, hits);
  }
  return hits;
}

}  // namespace polyscalpel
