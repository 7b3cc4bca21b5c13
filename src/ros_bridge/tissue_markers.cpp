// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/tissue_markers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/ros_bridge/geometry_conversions.hpp"

namespace polyscalpel {
namespace {

/// Edges sharper than this stay sharp.
const double kCreaseCosine = std::cos(50 * M_PI / 180);
/// A triangle is drawn when its doubled area is above this times its longest edge squared.
constexpr double kSmallestHeight = 1e-7;

struct Triangle {
  TriangleOrigin origin;  // its face is invalid for a loose triangle
  Eigen::Matrix3d corners;
  Eigen::Vector3d area_normal;  // length: twice the area
  std::array<int, 3> points;    // numbers of points shared with other triangles; -1: shared with none
};

Eigen::Vector3d areaNormal(const Eigen::Matrix3d& corners) {
  return (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
}

bool hasArea(const Triangle& triangle) {
  const Eigen::Matrix3d& p = triangle.corners;
  const double longest = std::max({(p.col(1) - p.col(0)).squaredNorm(), (p.col(2) - p.col(1)).squaredNorm(),
                                   (p.col(0) - p.col(2)).squaredNorm()});
  return triangle.area_normal.norm() > kSmallestHeight * longest;
}

/// Triangles of the boundary faces for which keep(face) holds.
template <class Keep>
std::vector<Triangle> boundaryTriangles(const PolyhedralMesh& mesh,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                        const Keep& keep) {
  std::vector<Triangle> triangles;
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    const FaceId id(i);
    const Face& face = mesh.face(id);
    if (!face.isAlive() || !face.isBoundary() || !keep(face)) continue;
    const std::size_t size = face.loop.size();
    for (int j = 0; j < numTriangles(face); ++j) {
      Triangle triangle;
      triangle.origin = {id, j};
      triangle.corners = triangleCorners(face, j, positions);
      triangle.area_normal = areaNormal(triangle.corners);
      const auto k = static_cast<std::size_t>(j);
      if (size == 3) {
        triangle.points = {face.loop[0].index(), face.loop[1].index(), face.loop[2].index()};
      } else {
        triangle.points = {-1, face.loop[k].index(), face.loop[(k + 1) % size].index()};
      }
      triangles.push_back(triangle);
    }
  }
  return triangles;
}

Eigen::Vector3d unit(const Eigen::Vector3d& vector, const Eigen::Vector3d& otherwise) {
  const double length = vector.norm();
  return length > 0 ? Eigen::Vector3d(vector / length) : otherwise;
}

/// Normals at the corners; drops triangles without area.
SurfaceTriangles smooth(std::vector<Triangle> triangles, int num_points) {
  triangles.erase(
      std::remove_if(triangles.begin(), triangles.end(), [](const Triangle& t) { return !hasArea(t); }),
      triangles.end());
  std::vector<std::vector<std::size_t>> around(static_cast<std::size_t>(num_points));
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (const int point : triangles[i].points)
      if (point >= 0) around[static_cast<std::size_t>(point)].push_back(i);

  SurfaceTriangles result;
  result.corners.reserve(triangles.size());
  result.normals.reserve(triangles.size());
  for (const Triangle& triangle : triangles) {
    const Eigen::Vector3d flat = triangle.area_normal.normalized();
    Eigen::Matrix3d normals;
    for (int corner = 0; corner < 3; ++corner) {
      const int point = triangle.points[static_cast<std::size_t>(corner)];
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      if (point >= 0) {
        for (const std::size_t other : around[static_cast<std::size_t>(point)]) {
          const Eigen::Vector3d& area_normal = triangles[other].area_normal;
          if (area_normal.dot(flat) >= kCreaseCosine * area_normal.norm()) sum += area_normal;
        }
      }
      normals.col(corner) = unit(sum, flat);
    }
    result.corners.push_back(triangle.corners);
    result.normals.push_back(normals);
    if (triangle.origin.face.isValid()) result.origins.push_back(triangle.origin);
  }
  return result;
}

}  // namespace

SurfaceTriangles makeSurfaceTriangles(const PolyhedralMesh& mesh,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& positions, bool cut_faces) {
  return smooth(
      boundaryTriangles(mesh, positions, [&](const Face& face) { return (face.cut > 0) == cut_faces; }),
      mesh.numVertices());
}

SurfaceTriangles makeSurfaceTriangles(const Eigen::Ref<const Eigen::Matrix3Xd>& triangles) {
  std::map<std::array<double, 3>, int> numbers;
  std::vector<Triangle> result;
  for (Eigen::Index i = 0; i + 2 < triangles.cols(); i += 3) {
    Triangle triangle;
    triangle.corners = triangles.middleCols<3>(i);
    triangle.area_normal = areaNormal(triangle.corners);
    for (int j = 0; j < 3; ++j) {
      const std::array<double, 3> key = {triangle.corners(0, j), triangle.corners(1, j),
                                         triangle.corners(2, j)};
      triangle.points[static_cast<std::size_t>(j)] =
          numbers.emplace(key, static_cast<int>(numbers.size())).first->second;
    }
    result.push_back(triangle);
  }
  return smooth(std::move(result), static_cast<int>(numbers.size()));
}

double lightOn(const Eigen::Vector3d& normal) {
  static const Eigen::Vector3d kLamp = Eigen::Vector3d(-0.45, -0.6, 0.66).normalized();
  static const Eigen::Vector3d kFill = Eigen::Vector3d(0.8, 0.35, 0.3).normalized();
  const double sky = 0.30 + 0.12 * normal.z();
  return std::clamp(sky + 0.55 * std::max(0.0, normal.dot(kLamp)) + 0.15 * std::max(0.0, normal.dot(kFill)),
                    0.0, 1.0);
}

visualization_msgs::Marker makeTriangleMarker(const SurfaceTriangles& triangles,
                                              const Eigen::Vector4d& rgba) {
  visualization_msgs::Marker marker;
  marker.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose.orientation.w = 1;
  marker.scale.x = marker.scale.y = marker.scale.z = 1;
  marker.color = toColourMsg(rgba);
  marker.points.reserve(3 * triangles.corners.size());
  marker.colors.reserve(3 * triangles.corners.size());
  for (std::size_t i = 0; i < triangles.corners.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      marker.points.push_back(toPointMsg(triangles.corners[i].col(corner)));
      Eigen::Vector4d lit = rgba;
      lit.head<3>() = (rgba.head<3>() * (1.3 * lightOn(triangles.normals[i].col(corner)))).cwiseMin(1.0);
      marker.colors.push_back(toColourMsg(lit));
    }
  }
  return marker;
}

visualization_msgs::Marker makeWireframeMarker(const PolyhedralMesh& mesh,
                                               const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  visualization_msgs::Marker marker;
  marker.type = visualization_msgs::Marker::LINE_LIST;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose.orientation.w = 1;
  std::vector<std::pair<VertexId, VertexId>> edges;
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    const Face& face = mesh.face(FaceId(i));
    if (!face.isAlive() || !face.isBoundary()) continue;
    for (std::size_t j = 0; j < face.loop.size(); ++j)
      edges.push_back(std::minmax(face.loop[j], face.loop[(j + 1) % face.loop.size()]));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (const auto& [start, end] : edges) {
    marker.points.push_back(toPointMsg(positions.col(start.index())));
    marker.points.push_back(toPointMsg(positions.col(end.index())));
  }
  return marker;
}

visualization_msgs::Marker makePointMarker(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                           double diameter_m) {
  visualization_msgs::Marker marker;
  marker.type = visualization_msgs::Marker::SPHERE_LIST;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose.orientation.w = 1;
  marker.scale.x = marker.scale.y = marker.scale.z = diameter_m;
  for (Eigen::Index i = 0; i < points.cols(); ++i) marker.points.push_back(toPointMsg(points.col(i)));
  return marker;
}

std::vector<PieceSummary> summarisePieces(const PolyhedralMesh& mesh, const Pieces& pieces,
                                          const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  struct Sums {
    Eigen::Vector3d weighted_centre = Eigen::Vector3d::Zero();
    double area = 0;
    double highest = -kInfinity;
  };
  std::vector<Sums> sums(static_cast<std::size_t>(pieces.count));
  std::vector<PieceSummary> summaries(static_cast<std::size_t>(pieces.count));
  for (const Triangle& triangle : boundaryTriangles(mesh, positions, [](const Face&) { return true; })) {
    const int cell = mesh.face(triangle.origin.face).cells[0].index();
    const auto piece = static_cast<std::size_t>(pieces.piece_of_cell[static_cast<std::size_t>(cell)]);
    const Eigen::Matrix3d& p = triangle.corners;
    summaries[piece].volume_m3 += p.col(0).dot(triangle.area_normal) / 6;  // divergence theorem
    const double area = triangle.area_normal.norm() / 2;
    sums[piece].weighted_centre += area * p.rowwise().mean();
    sums[piece].area += area;
    sums[piece].highest = std::max(sums[piece].highest, p.row(2).maxCoeff());
  }
  for (std::size_t i = 0; i < summaries.size(); ++i) {
    if (sums[i].area > 0) summaries[i].label_point = sums[i].weighted_centre / sums[i].area;
    summaries[i].label_point.z() = sums[i].highest;
  }
  return summaries;
}

}  // namespace polyscalpel
