// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/blade_distance.hpp"

#include <algorithm>
#include <utility>

#include "polyscalpel/cutting/crack_front.hpp"
#include "polyscalpel/geometry/triangle.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Positions = Eigen::Ref<const Matrix3Xd>;

/// A segment that is within a cell for less than this, in localSize, only touches it: a blade's corner lies
/// in the plane that has just divided the cell for the segment before it.
constexpr double kSmallestChord = 1e-6;

/// What is left out in distances that decide, as part of the lengths and coordinates that go into them: more
/// than rounding.
constexpr double kRounding = 1e-12;

/// Rounds of looking for a plane between a segment and a cell: later ones find hardly any.
constexpr int kPartingRounds = 6;

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

/// Parameter in [0, 1] of the point of the segment p-q that is closest to a point.
double closestParameter(const Vector3d& point, const Vector3d& p, const Vector3d& q) {
  const Vector3d way = q - p;
  const double length = way.squaredNorm();
  return length > 0 ? std::clamp(way.dot(point - p) / length, 0.0, 1.0) : 0;
}

bool isWithin(double distance, const Vector3d& point, const Vector3d& p, const Vector3d& q) {
  return (p + closestParameter(point, p, q) * (q - p) - point).squaredNorm() <= distance * distance;
}

/// Whether a plane parts the segment p-q from all vertices of a cell, and with them from its surface, by more
/// than a distance. Looks for one across the shortest way found so far from the segment to the vertices' hull
/// (E. Gilbert, "An Iterative Procedure for Computing the Minimum of a Quadratic Form on a Convex Set",
/// 1966); false may mean that it has not found it.
bool isPartedFrom(const PolyhedralMesh& mesh, CellId id, const Positions& positions, const Vector3d& p,
                  const Vector3d& q, double distance) {
  const auto& vertices = mesh.cell(id).vertices;
  Vector3d in_hull = Vector3d::Zero(), largest = p.cwiseAbs().cwiseMax(q.cwiseAbs());
  for (const VertexId v : vertices) {
    in_hull += positions.col(v.index());
    largest = largest.cwiseMax(positions.col(v.index()).cwiseAbs());
  }
  in_hull /= static_cast<double>(vertices.size());
  const double clearance = atLeast(distance, largest.maxCoeff());
  for (int round = 0; round < kPartingRounds; ++round) {
    const Vector3d on_segment = p + closestParameter(in_hull, p, q) * (q - p);
    const double way = (in_hull - on_segment).norm();
    if (way <= clearance) return false;
    const Vector3d normal = (in_hull - on_segment) / way;
    VertexId nearest;
    double lowest = kInfinity;
    for (const VertexId v : vertices) {
      const double height = normal.dot(positions.col(v.index()) - on_segment);
      if (height >= lowest) continue;
      lowest = height;
      nearest = v;
    }
    if (lowest - std::max(normal.dot(p - on_segment), normal.dot(q - on_segment)) > clearance) return true;
    const Vector3d corner = positions.col(nearest.index());
    const double step = closestParameter(on_segment, in_hull, corner);
    if (step == 0) return false;
    in_hull += step * (corner - in_hull);
  }
  return false;
}

bool isSegmentAt(const PolyhedralMesh& mesh, CellId id, const Positions& positions, const Vector3d& p,
                 const Vector3d& q, double distance) {
  // The vertices first: most cells that are near have one that is, and need no more.
  for (const VertexId v : mesh.cell(id).vertices) {
    if (isWithin(distance, positions.col(v.index()), p, q)) return true;
  }
  if (meetsCell(mesh, id, positions, p, q)) return true;
  // Most of the others are clear of it, which costs far less to find than the distance of each triangle.
  if (isPartedFrom(mesh, id, positions, p, q, distance)) return false;
  for (const FaceId face_id : mesh.cell(id).faces) {
    const bool is_clear = visitTriangles(mesh.face(face_id), positions, [&](const Eigen::Matrix3d& corners) {
      return closestPointsOfSegmentAndTriangle(p, q, corners).squared_distance > distance * distance;
    });
    if (!is_clear) return true;
  }
  return false;
}

}  // namespace

bool meetsCell(const PolyhedralMesh& mesh, CellId id, const Positions& positions, const Vector3d& p,
               const Vector3d& q) {
  double enter = 0, leave = 1;
  for (const FaceId face_id : mesh.cell(id).faces) {
    const Face& face = mesh.face(face_id);
    const auto [origin, area] = planeOf(face, positions);
    const double sense = face.cells[0] == id ? 1 : -1;
    const double height = sense * area.dot(p - origin), rise = sense * area.dot(q - p);
    if (rise == 0) {
      if (height > 0) return false;
    } else if (rise > 0) {
      leave = std::min(leave, -height / rise);
    } else {
      enter = std::max(enter, -height / rise);
    }
  }
  return (leave - enter) * (q - p).norm() > kSmallestChord * mesh.localSize(id);
}

bool isBladeAt(const PolyhedralMesh& mesh, CellId id, const Positions& positions,
               const Positions& blade_world, double margin) {
  const double distance = margin * mesh.localSize(id);
  AlignedBox3d box;
  for (const VertexId v : mesh.cell(id).vertices) box.extend(positions.col(v.index()));
  const Vector3d reach = Vector3d::Constant(distance);
  box = {box.min() - reach, box.max() + reach};
  for (Eigen::Index i = 0; i + 1 < blade_world.cols(); ++i) {
    const Vector3d p = blade_world.col(i), q = blade_world.col(i + 1);
    if (meets(box, p, q) && isSegmentAt(mesh, id, positions, p, q, distance)) return true;
  }
  return false;
}

std::unordered_set<CellId> cellsAtBlade(const PolyhedralMesh& mesh, const CellTree& tree,
                                        const Positions& positions, const Positions& blade_world,
                                        double margin) {
  std::unordered_set<CellId> cells;
  tree.visit(
      mesh,
      [&](const CellTree::Bound& bound) {
        return meets(bound.box, blade_world, margin * bound.largest_size);
      },
      [&](CellId id) {
        if (isBladeAt(mesh, id, positions, blade_world, margin)) cells.insert(id);
        return true;
      });
  return cells;
}

std::vector<VertexId> slitAtBlade(const PolyhedralMesh& mesh, const CellTree& tree,
                                  const Positions& positions, const Positions& blade_world,
                                  double wall_tolerance, double front_tolerance) {
  std::vector<VertexId> vertices;
  const auto isAtBlade = [&](VertexId v, double relative_distance) {
    for (Eigen::Index i = 0; i + 1 < blade_world.cols(); ++i) {
      if (isWithin(relative_distance * mesh.localSize(v), positions.col(v.index()), blade_world.col(i),
                   blade_world.col(i + 1)))
        return true;
    }
    return false;
  };
  const auto isOnWall = [&](VertexId v) {
    const auto& faces = mesh.facesAround(v);
    return std::any_of(faces.begin(), faces.end(), [&](FaceId id) { return mesh.face(id).cut > 0; });
  };
  tree.visit(
      mesh,
      [&](const CellTree::Bound& bound) {
        return meets(bound.box, blade_world, front_tolerance * bound.largest_size);
      },
      [&](CellId id) {
        for (const VertexId v : mesh.cell(id).vertices) {
          if (!isAtBlade(v, front_tolerance) || !isOnWall(v)) continue;
          if (isAtBlade(v, wall_tolerance) || isOnCrackFront(mesh, v)) vertices.push_back(v);
        }
        return true;
      });
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

double atLeast(double distance, double largest_coordinate) {
  return distance + kRounding * (distance + largest_coordinate);
}

bool meets(AlignedBox3d box, const Positions& blade, double distance) {
  box.min().array() -= distance;
  box.max().array() += distance;
  for (Eigen::Index i = 0; i + 1 < blade.cols(); ++i) {
    if (meets(box, blade.col(i), blade.col(i + 1))) return true;
  }
  return false;
}

}  // namespace polyscalpel
