// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/blade_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "polyscalpel/geometry/predicates.hpp"

namespace polyscalpel {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Positions = Eigen::Ref<const Matrix3Xd>;

constexpr int kMostHalvings = 8;

/// Vertices that a cut under way has just put on the cell's edges have no column yet and lie between others.
AlignedBox3d boxOf(const Cell& cell, const Positions& positions) {
  AlignedBox3d box;
  for (const VertexId v : cell.vertices) {
    if (v.index() < positions.cols()) box.extend(positions.col(v.index()));
  }
  return box;
}

AlignedBox3d boxOf(const Positions& points) {
  return {Vector3d(points.rowwise().minCoeff()), Vector3d(points.rowwise().maxCoeff())};
}

void sortUnique(std::vector<Edge>& edges) {
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
}

/// Whether the segment p-q meets the box (slab test of A. Williams et al., "An Efficient and Robust Ray-Box
/// Intersection Algorithm", 2005, with division only by components that are not 0).
bool meets(const AlignedBox3d& box, const Vector3d& p, const Vector3d& q) {
  double enter = 0, leave = 1;
  for (int i = 0; i < 3; ++i) {
    const double way = q[i] - p[i];
    if (way == 0) {
      if (p[i] < box.min()[i] || p[i] > box.max()[i]) return false;
      continue;
    }
    double first = (box.min()[i] - p[i]) / way, second = (box.max()[i] - p[i]) / way;
    if (first > second) std::swap(first, second);
    enter = std::max(enter, first);
    leave = std::min(leave, second);
  }
  return enter <= leave;
}

/// Whether any segment of the blade comes nearer to the box than `distance` along some axis.
bool meets(AlignedBox3d box, const Positions& blade, double distance) {
  box.min().array() -= distance;
  box.max().array() += distance;
  for (int i = 0; i + 1 < blade.cols(); ++i) {
    if (meets(box, blade.col(i), blade.col(i + 1))) return true;
  }
  return false;
}

/// Edges for whose box, over the motion of the tissue, is_near holds, as it does for the box of a cell that
/// has them.
template <class IsNear>
std::vector<Edge> edgesNear(const PolyhedralMesh& mesh, const Positions& positions_start,
                            const Positions& positions_end, const IsNear& is_near) {
  std::vector<Edge> edges;
  const bool moves = positions_start.data() != positions_end.data();
  const auto extend = [&](AlignedBox3d& box, VertexId v) {
    box.extend(positions_start.col(v.index()));
    if (moves) box.extend(positions_end.col(v.index()));
  };
  for (int i = 0; i < mesh.cellCapacity(); ++i) {
    const Cell& cell = mesh.cell(CellId(i));
    if (!cell.isAlive()) continue;
    AlignedBox3d cell_box;
    for (const VertexId v : cell.vertices) extend(cell_box, v);
    if (!is_near(cell_box)) continue;
    for (const Edge& edge : mesh.edges(CellId(i))) {
      AlignedBox3d edge_box;
      extend(edge_box, edge.first);
      extend(edge_box, edge.second);
      if (is_near(edge_box)) edges.push_back(edge);
    }
  }
  sortUnique(edges);
  return edges;
}

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
    last_[sign > 0] = {weight, absoluteCosine(edge, normal)};
  }
  bool isEven() const { return count_ > 0 && count_ % 2 == 0; }
  bool isHit() const { return sum_ != 0; }
  Hit hit(Edge edge) const {
    const auto& [weight, alignment] = last_[sum_ > 0];
    return {edge, weight, sum_ > 0 ? 1 : -1, alignment};
  }

 private:
  int sum_ = 0, count_ = 0;
  std::pair<double, double> last_[2];
};

/// One sub-step of a blade's motion, cut out of the whole step by fractions.
class Sweep {
 public:
  Sweep(const PolyhedralMesh& mesh, const BladeMotion& motion) : mesh_(mesh), motion_(motion) {
    moves_ = motion.positions_start.data() != motion.positions_end.data();
    const Matrix3Xd start = bladeAt(0);
    // No point of the blade is ever further from where it starts than this, whatever turning and travel add
    // up to.
    const Matrix3Xd turned = motion.T_world_tool_end.linear() * motion.edge_tool;
    const double travel =
        (turned - motion.T_world_tool_start.linear() * motion.edge_tool).colwise().norm().maxCoeff() +
        (motion.T_world_tool_end.translation() - motion.T_world_tool_start.translation()).norm();
    edges_ = edgesNear(mesh, motion.positions_start, motion.positions_end,
                       [&](const AlignedBox3d& box) { return meets(box, start, travel); });

    double size = kInfinity, drift = 0;
    for (const auto& [a, b] : edges_) {
      for (const VertexId v : {a, b}) {
        size = std::min(size, mesh.localSize(v));
        if (moves_) {
          drift = std::max(
              drift, (motion.positions_end.col(v.index()) - motion.positions_start.col(v.index())).norm());
        }
      }
    }
    travel_in_sizes_ = edges_.empty() ? 0 : (travel + drift) / size;
  }

  /// Longest way of the blade relative to the tissue over the step, as a multiple of the smallest localSize
  /// near it.
  double travelInSizes() const { return travel_in_sizes_; }

  void findHits(double from, double to, int halvings_left, std::vector<Hit>& hits) const {
    if (edges_.empty()) return;
    const Matrix3Xd blade_start = bladeAt(from), blade_end = bladeAt(to);
    const double travel = (blade_end - blade_start).colwise().norm().maxCoeff();

    std::vector<Hit> found;
    for (const Edge& edge : edges_) {
      const auto [a, b] = edge;
      const Vector3d a_start = positionAt(a, from), b_start = positionAt(b, from);
      const Vector3d a_end = moves_ ? positionAt(a, to) : a_start,
                     b_end = moves_ ? positionAt(b, to) : b_start;
      AlignedBox3d box(a_start.cwiseMin(b_start), a_start.cwiseMax(b_start));
      if (moves_) box.extend(a_end).extend(b_end);
      if (!meets(box, blade_start, travel)) continue;

      SignedSum sum;
      addToolHalf(blade_start, blade_end, a_start, b_start, sum);
      if (moves_) addTissueHalf(blade_end, a_start, b_start, a_end, b_end, sum);
      if (sum.isEven() && halvings_left > 0) {
        const double middle = 0.5 * (from + to);
        findHits(from, middle, halvings_left - 1, hits);
        findHits(middle, to, halvings_left - 1, hits);
        return;
      }
      if (sum.isHit()) found.push_back(sum.hit(edge));
    }
    hits.insert(hits.end(), found.begin(), found.end());
  }

 private:
  Matrix3Xd bladeAt(double s) const {
    return interpolate(motion_.T_world_tool_start, motion_.T_world_tool_end, s) * motion_.edge_tool;
  }

  Vector3d positionAt(VertexId v, double s) const {
    if (!moves_ || s == 0) return motion_.positions_start.col(v.index());
    if (s == 1) return motion_.positions_end.col(v.index());
    return (1 - s) * motion_.positions_start.col(v.index()) + s * motion_.positions_end.col(v.index());
  }

  /// The edge a-b at rest against the triangles swept by the blade's segments.
  static void addToolHalf(const Matrix3Xd& start, const Matrix3Xd& end, const Vector3d& a, const Vector3d& b,
                          SignedSum& sum) {
    for (int i = 0; i + 1 < start.cols(); ++i) {
      const Vector3d p0 = start.col(i), p1 = end.col(i), q0 = start.col(i + 1), q1 = end.col(i + 1);
      for (const auto& [u, v, w] : {std::make_tuple(p0, q0, q1), std::make_tuple(p0, q1, p1)}) {
        const TriangleCrossing crossing = crossTriangle(a, b, u, v, w, MeshPart::kSegment);
        if (crossing.sign != 0)
          sum.add(crossing.sign, crossing.segment_parameter, b - a, (v - u).cross(w - u));
      }
    }
  }

  /// The blade's segments at rest against the triangles swept by the edge a-b. The sign is that of the tool
  /// half for the same relative motion: det(edge, segment, -motion of the tissue) = segment . (edge x motion
  /// of the tissue).
  static void addTissueHalf(const Matrix3Xd& blade, const Vector3d& a0, const Vector3d& b0,
                            const Vector3d& a1, const Vector3d& b1, SignedSum& sum) {
    for (int i = 0; i + 1 < blade.cols(); ++i) {
      const Vector3d p = blade.col(i), q = blade.col(i + 1);
      const Vector3d normal = (q - p).cross(0.5 * (a0 + b0) - 0.5 * (a1 + b1));
      const TriangleCrossing first = crossTriangle(p, q, a0, b0, b1, MeshPart::kTriangle);
      if (first.sign != 0) sum.add(first.sign, first.barycentric[1] + first.barycentric[2], b0 - a0, normal);
      const TriangleCrossing second = crossTriangle(p, q, a0, b1, a1, MeshPart::kTriangle);
      if (second.sign != 0) sum.add(second.sign, second.barycentric[1], b0 - a0, normal);
    }
  }

  const PolyhedralMesh& mesh_;
  const BladeMotion& motion_;
  std::vector<Edge> edges_;
  bool moves_ = false;
  double travel_in_sizes_ = 0;
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

std::vector<Hit> findHits(const PolyhedralMesh& mesh, const Positions& positions, const PlaneCut& plane) {
  std::vector<int> sides(mesh.numVertices());
  for (int i = 0; i < mesh.numVertices(); ++i) {
    sides[i] = sideOfPlane(positions.col(i), plane.point_world, plane.normal_world);
  }
  std::vector<Edge> edges;
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    const auto& loop = mesh.face(FaceId(i)).loop;
    for (std::size_t j = 0; j < loop.size(); ++j) {
      const VertexId a = loop[j], b = loop[(j + 1) % loop.size()];
      if (sides[a.index()] != sides[b.index()]) edges.push_back(makeEdge(a, b));
    }
  }
  sortUnique(edges);
  std::vector<Hit> hits;
  for (const Edge& edge : edges) {
    const auto distance = [&](VertexId v) {
      const double value = plane.normal_world.dot(positions.col(v.index()) - plane.point_world);
      return std::max(0.0, value * sides[v.index()]);
    };
    const double first = distance(edge.first), second = distance(edge.second);
    const double weight = first + second > 0 ? first / (first + second) : 0;
    const Vector3d way = positions.col(edge.second.index()) - positions.col(edge.first.index());
    hits.push_back({edge, weight, sides[edge.second.index()], absoluteCosine(way, plane.normal_world)});
  }
  return hits;
}

std::vector<Hit> findHits(const PolyhedralMesh& mesh, const Positions& positions, const PolygonCut& polygon) {
  const Matrix3Xd& corners = polygon.corners_world;
  std::vector<Hit> hits;
  const AlignedBox3d reach = boxOf(corners);
  const auto is_near = [&](const AlignedBox3d& box) { return reach.intersects(box); };
  for (const Edge& edge : edgesNear(mesh, positions, positions, is_near)) {
    const Vector3d a = positions.col(edge.first.index()), b = positions.col(edge.second.index());
    SignedSum sum;
    for (int i = 1; i + 1 < corners.cols(); ++i) {
      const Vector3d u = corners.col(0), v = corners.col(i), w = corners.col(i + 1);
      const TriangleCrossing crossing = crossTriangle(a, b, u, v, w, MeshPart::kSegment);
      if (crossing.sign != 0) sum.add(crossing.sign, crossing.segment_parameter, b - a, (v - u).cross(w - u));
    }
    if (sum.isHit()) hits.push_back(sum.hit(edge));
  }
  return hits;
}

std::optional<std::vector<Hit>> findHits(const PolyhedralMesh& mesh, const BladeMotion& motion,
                                         double max_travel) {
  const Sweep sweep(mesh, motion);
  const double sub_steps = std::ceil(sweep.travelInSizes() / max_travel);
  if (!(sub_steps <= kMostSubSteps)) return std::nullopt;
  const int count = std::max(1, static_cast<int>(sub_steps));
  std::vector<Hit> hits;
  for (int i = 0; i < count; ++i) {
    sweep.findHits(static_cast<double>(i) / count, static_cast<double>(i + 1) / count, kMostHalvings, hits);
  }
  return hits;
}

bool isBladeAt(const PolyhedralMesh& mesh, CellId id, const Positions& positions,
               const Positions& blade_world, double margin) {
  const Cell& cell = mesh.cell(id);
  return meets(boxOf(cell, positions), blade_world, margin * mesh.localSize(id));
}

bool isBladeInTissue(const PolyhedralMesh& mesh, const Positions& positions, const Positions& blade_world,
                     double margin) {
  for (int i = 0; i < mesh.cellCapacity(); ++i) {
    if (mesh.cell(CellId(i)).isAlive() && isBladeAt(mesh, CellId(i), positions, blade_world, margin))
      return true;
  }
  return false;
}

}  // namespace polyscalpel
