// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/surface.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/geometry/triangle.hpp"

namespace polyscalpel {
namespace {

bool isFan(const Face& face) {
  return face.loop.size() > 3;
}

int numCorners(const Face& face) {
  return static_cast<int>(
      std::count_if(face.is_corner.begin(), face.is_corner.end(), [](char c) { return c != 0; }));
}

int next(const Face& face, int i) {
  return i + 1 == static_cast<int>(face.loop.size()) ? 0 : i + 1;
}

/// Six times the volume of the tetrahedron (apex, triangle).
double sixfoldVolume(const Eigen::Vector3d& apex, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                     const Eigen::Vector3d& c) {
  return (a - apex).dot((b - apex).cross(c - apex));
}

Eigen::Vector3d vertexMean(const CellSurface& surface) {
  POLYSCALPEL_ASSERT(surface.num_vertices > 0);
  const Eigen::Vector3d origin = surface.points.col(0);
  return origin + (surface.points.leftCols(surface.num_vertices).colwise() - origin).rowwise().mean();
}

/// Looks for a point that lies far inside the planes of all triangles.
class KernelSearch {
 public:
  KernelSearch(const CellSurface& surface, const Eigen::Vector3d& start) : start_(start) {
    planes_.reserve(surface.triangles.size());
    for (const auto& [a, b, c] : surface.triangles)
      add(surface.points.col(a), surface.points.col(b), surface.points.col(c));
    radius_ = area_ > 0 ? 3 * volume_ / area_ : 0;
  }
  KernelSearch(const std::vector<Eigen::Matrix3d>& triangles, const Eigen::Vector3d& start) : start_(start) {
    planes_.reserve(triangles.size());
    for (const Eigen::Matrix3d& corners : triangles) add(corners.col(0), corners.col(1), corners.col(2));
    radius_ = area_ > 0 ? 3 * volume_ / area_ : 0;
  }

  bool isStartWellInside() const {
    return radius_ <= 0 || furthestOut(start_).second <= -kWellInside * radius_;
  }

  Eigen::Vector3d run() const {
    Eigen::Vector3d best = start_;
    double best_height = furthestOut(start_).second;
    for (double depth = kDeepest; depth > kShallowest; depth *= 0.5) {
      Eigen::Vector3d point = best;
      for (int i = 0; i < kSteps; ++i) {
        const auto [plane, height] = furthestOut(point);
        if (height < best_height) {
          best_height = height;
          best = point;
        }
        if (height <= -depth * radius_) return point;
        point -= kOverProjection * (height + depth * radius_) * planes_[plane].normal;
      }
    }
    return best;
  }

 private:
  // Depths as parts of 3 volume / area: the radius of the inscribed ball where one touches every face, and
  // more than any point can be inside otherwise.
  static constexpr double kWellInside = 0.02;
  static constexpr double kDeepest = 0.5, kShallowest = 1e-4;
  static constexpr double kOverProjection = 1.5;  // in (0, 2)
  static constexpr int kSteps = 100;

  struct Plane {
    Eigen::Vector3d point, normal;
  };

  void add(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double norm = normal.norm();
    if (norm == 0) return;  // a triangle without area sees nothing
    area_ += norm / 2;
    volume_ += normal.dot(a - start_) / 6;
    planes_.push_back({a, normal / norm});
  }

  /// The plane that the point is furthest outside of, or least inside, and how far outside.
  std::pair<std::size_t, double> furthestOut(const Eigen::Vector3d& point) const {
    std::pair<std::size_t, double> furthest{0, -kInfinity};
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      const double height = planes_[i].normal.dot(point - planes_[i].point);
      if (height > furthest.second) furthest = {i, height};
    }
    return furthest;
  }

  Eigen::Vector3d start_;
  boost::container::small_vector<Plane, 32> planes_;
  double area_ = 0, volume_ = 0, radius_ = 0;
};

}  // namespace

int numTriangles(const Face& face) {
  return isFan(face) ? static_cast<int>(face.loop.size()) : 1;
}

Eigen::Vector3d virtualVertex(const Face& face, const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  // Relative to the first vertex, so that a face far from the origin keeps its digits.
  const Eigen::Vector3d origin = positions.col(face.loop.front().index());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < face.loop.size(); ++i) {
    if (face.is_corner[i]) sum += positions.col(face.loop[i].index()) - origin;
  }
  const int corners = numCorners(face);
  POLYSCALPEL_ASSERT(corners >= 3);
  return origin + sum / corners;
}

Eigen::Matrix3d triangleCorners(const Face& face, int i,
                                const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  POLYSCALPEL_ASSERT(i >= 0 && i < numTriangles(face));
  Eigen::Matrix3d corners;
  if (isFan(face)) {
    corners << virtualVertex(face, positions), positions.col(face.loop[i].index()),
        positions.col(face.loop[next(face, i)].index());
  } else {
    for (int k = 0; k < 3; ++k) corners.col(k) = positions.col(face.loop[k].index());
  }
  return corners;
}

std::pair<Eigen::Vector3d, Eigen::Vector3d> planeOf(const Face& face,
                                                    const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  visitTriangles(face, positions, [&](const Eigen::Matrix3d& corners) {
    area += triangleAreaVector(corners);
    return true;
  });
  return {virtualVertex(face, positions), area};
}

std::vector<WeightedVertex> vertexWeights(const Face& face, int i, const Eigen::Vector3d& barycentric) {
  POLYSCALPEL_ASSERT(i >= 0 && i < numTriangles(face));
  std::vector<WeightedVertex> weights;
  if (!isFan(face)) {
    for (int k = 0; k < 3; ++k) weights.push_back({face.loop[k], barycentric(k)});
    return weights;
  }
  const double share = barycentric(0) / numCorners(face);
  const int second = next(face, i);
  for (int k = 0; k < static_cast<int>(face.loop.size()); ++k) {
    double weight = face.is_corner[k] ? share : 0;
    if (k == i) weight += barycentric(1);
    if (k == second) weight += barycentric(2);
    if (face.is_corner[k] || k == i || k == second) weights.push_back({face.loop[k], weight});
  }
  return weights;
}

CellSurface makeCellSurface(const PolyhedralMesh& mesh, CellId id,
                            const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  POLYSCALPEL_ASSERT(positions.cols() == mesh.numVertices());
  const Cell& cell = mesh.cell(id);
  POLYSCALPEL_ASSERT(cell.isAlive());
  const auto local = [&cell](VertexId vertex) {
    const int place = countSmaller(cell.vertices, vertex);
    POLYSCALPEL_ASSERT(place < static_cast<int>(cell.vertices.size()) && cell.vertices[place] == vertex);
    return place;
  };

  CellSurface surface;
  surface.num_vertices = static_cast<int>(cell.vertices.size());
  std::size_t num_fans = 0;
  std::size_t num_triangles = 0;
  for (const FaceId face_id : cell.faces) {
    num_fans += isFan(mesh.face(face_id));
    num_triangles += numTriangles(mesh.face(face_id));
  }
  surface.points.resize(3, surface.num_vertices + num_fans);
  surface.triangles.reserve(num_triangles);
  surface.parents.reserve(num_fans);
  for (int i = 0; i < surface.num_vertices; ++i)
    surface.points.col(i) = positions.col(cell.vertices[i].index());

  for (const FaceId face_id : cell.faces) {
    const Face& face = mesh.face(face_id);
    const bool reversed = face.cells[0] != id;
    const auto addTriangle = [&](int a, int b, int c) {
      surface.triangles.push_back(reversed ? std::array<int, 3>{a, c, b} : std::array<int, 3>{a, b, c});
    };
    if (!isFan(face)) {
      addTriangle(local(face.loop[0]), local(face.loop[1]), local(face.loop[2]));
      continue;
    }
    const int centre = surface.num_vertices + static_cast<int>(surface.parents.size());
    surface.points.col(centre) = virtualVertex(face, positions);
    auto& parents = surface.parents.emplace_back();
    const int first = local(face.loop[0]);
    int start = first;
    for (int i = 0; i < static_cast<int>(face.loop.size()); ++i) {
      if (face.is_corner[i]) parents.push_back(start);
      const int end = next(face, i) == 0 ? first : local(face.loop[i + 1]);
      addTriangle(centre, start, end);
      start = end;
    }
  }
  return surface;
}

double volume(const CellSurface& surface) {
  const Eigen::Vector3d apex = vertexMean(surface);
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    sum += sixfoldVolume(apex, surface.points.col(a), surface.points.col(b), surface.points.col(c));
  }
  return sum / 6;
}

Eigen::Vector3d starCentre(const CellSurface& surface) {
  const Eigen::Vector3d mean = vertexMean(surface);
  if (surface.isTetrahedron()) return mean;
  const KernelSearch search(surface, mean);
  return search.isStartWellInside() ? mean : search.run();
}

Eigen::Vector3d starCentre(const std::vector<Eigen::Matrix3d>& triangles, const Eigen::Vector3d& start) {
  const KernelSearch search(triangles, start);
  return search.isStartWellInside() ? start : search.run();
}

double smallestSubTetVolume(const CellSurface& surface) {
  const Eigen::Vector3d apex = starCentre(surface);
  double smallest = kInfinity;
  for (const auto& [a, b, c] : surface.triangles) {
    smallest = std::min(
        smallest, sixfoldVolume(apex, surface.points.col(a), surface.points.col(b), surface.points.col(c)));
  }
  return smallest / 6;
}

double volume(const PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  POLYSCALPEL_ASSERT(positions.cols() == mesh.numVertices());
  double sum = 0;
  double lost = 0;  // Kahan's summation: the error does not grow with the number of cells
  for (int index = 0; index < mesh.cellCapacity(); ++index) {
    const CellId id(index);
    const Cell& cell = mesh.cell(id);
    if (!cell.isAlive()) continue;
    const Eigen::Vector3d apex = positions.col(cell.vertices.front().index());
    double cell_sum = 0;
    for (const FaceId face_id : cell.faces) {
      const Face& face = mesh.face(face_id);
      const Eigen::Vector3d centre =
          isFan(face) ? virtualVertex(face, positions) : Eigen::Vector3d(positions.col(face.loop[0].index()));
      double face_sum = 0;
      // A triangle is a fan of one around its first vertex.
      for (int i = 0; i < static_cast<int>(face.loop.size()); ++i) {
        if (!isFan(face) && i != 1) continue;
        face_sum += sixfoldVolume(apex, centre, positions.col(face.loop[i].index()),
                                  positions.col(face.loop[next(face, i)].index()));
      }
      cell_sum += face.cells[0] == id ? face_sum : -face_sum;
    }
    const double term = cell_sum - lost;
    const double next_sum = sum + term;
    lost = (next_sum - sum) - term;
    sum = next_sum;
  }
  return sum / 6;
}

}  // namespace polyscalpel
