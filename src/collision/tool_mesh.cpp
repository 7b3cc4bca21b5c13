// SPDX-License-Identifier: BSD-3-Clause
#include "tool_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <stdexcept>

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/geometry/triangle.hpp"

namespace polyscalpel {
namespace {

using Tree = fcl::BVHModel<fcl::AABBd>;

struct Soup {
  std::vector<Eigen::Vector3d> points;  // each once
  std::vector<std::array<int, 3>> triangles;
};

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw std::invalid_argument("tool mesh \"" + path + "\": " + reason);
}

Soup readSoup(const std::string& path, double scale) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) refuse(path, "no such file");
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (extension != ".obj" && extension != ".off" && extension != ".ply" && extension != ".stl") {
    refuse(path, "unknown type \"" + extension + "\", must be .obj, .off, .ply or .stl");
  }
  using Point = CGAL::Simple_cartesian<double>::Point_3;
  std::vector<Point> points;
  std::vector<std::vector<std::size_t>> polygons;
  bool is_read = false;
  std::string reason = "cannot be read as " + extension;
  try {
    is_read = CGAL::IO::read_polygon_soup(path, points, polygons);
  } catch (const std::exception& exception) {
    reason += std::string(": ") + exception.what();
  }
  if (!is_read) refuse(path, reason);
  if (polygons.empty()) refuse(path, "has no triangles");

  // Formats like STL repeat a point for every triangle: equal coordinates are one point.
  Soup soup;
  std::map<std::array<double, 3>, int> known;
  std::vector<int> index_of(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d point = scale * Eigen::Vector3d(points[i].x(), points[i].y(), points[i].z());
    if (!point.allFinite()) refuse(path, "point " + std::to_string(i) + " is not finite");
    const auto [entry, is_new] =
        known.insert({{point.x(), point.y(), point.z()}, static_cast<int>(soup.points.size())});
    if (is_new) soup.points.push_back(point);
    index_of[i] = entry->second;
  }
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (polygons[i].size() != 3) refuse(path, "face " + std::to_string(i) + " is no triangle");
    std::array<int, 3> triangle;
    for (int k = 0; k < 3; ++k) {
      if (polygons[i][k] >= points.size())
        refuse(path, "face " + std::to_string(i) + " uses a point out of range");
      triangle[k] = index_of[polygons[i][k]];
    }
    soup.triangles.push_back(triangle);
  }
  return soup;
}

Eigen::Matrix3d cornersOf(const Soup& soup, int triangle) {
  Eigen::Matrix3d corners;
  for (int k = 0; k < 3; ++k) corners.col(k) = soup.points[soup.triangles[triangle][k]];
  return corners;
}

using EdgeTriangles = std::map<std::pair<int, int>, int>;

/// The triangle of each directed edge; checks that the surface is closed and outward.
EdgeTriangles checkClosed(const Soup& soup, const std::string& path) {
  EdgeTriangles triangle_of_edge;
  double volume = 0;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const std::array<int, 3>& triangle = soup.triangles[i];
    const Eigen::Matrix3d corners = cornersOf(soup, static_cast<int>(i));
    // About the first point, to keep digits far from the origin.
    volume += (corners.colwise() - soup.points.front()).determinant() / 6;
    if (!(triangleAreaVector(corners).norm() > 0))
      refuse(path, "triangle " + std::to_string(i) + " has no area");
    for (int k = 0; k < 3; ++k) {
      const std::pair<int, int> edge(triangle[k], triangle[(k + 1) % 3]);
      if (!triangle_of_edge.insert({edge, static_cast<int>(i)}).second) {
        refuse(path,
               "an edge of triangle " + std::to_string(i) +
                   " is used by another triangle in the same direction: no consistently oriented surface");
      }
    }
  }
  for (const auto& [edge, triangle] : triangle_of_edge) {
    if (triangle_of_edge.count({edge.second, edge.first}) == 0) {
      refuse(path, "is not closed: triangle " + std::to_string(triangle) + " has a free edge");
    }
  }
  if (!(volume > 0)) refuse(path, "is inside out: its triangles must go counter-clockwise seen from outside");
  return triangle_of_edge;
}

}  // namespace

struct ToolMesh::Impl {
  Soup soup;
  Eigen::Matrix3Xd triangles;
  Eigen::Matrix3Xd face_normals;                             // unit
  std::vector<std::array<Eigen::Vector3d, 3>> edge_normals;  // of (k, k + 1), any length
  std::vector<Eigen::Vector3d> point_normals;                // angle-weighted, any length
  Tree tree;
  double smallest_extent = 0;

  struct Nearest {
    int triangle = -1;
    TrianglePoint point;
  };

  static double squaredDistanceToBox(const fcl::AABBd& box, const Eigen::Vector3d& point) {
    return (box.min_ - point).cwiseMax(point - box.max_).cwiseMax(0.0).squaredNorm();
  }

  /// Branch and bound, the nearer child first.
  void findNearest(int node_id, const Eigen::Vector3d& point, Nearest& nearest) const {
    const fcl::BVNode<fcl::AABBd>& node = tree.getBV(node_id);
    if (node.isLeaf()) {
      const TrianglePoint candidate =
          closestPointOnTriangle(point, triangles.middleCols<3>(3 * node.primitiveId()));
      if (nearest.triangle < 0 || candidate.squared_distance < nearest.point.squared_distance) {
        nearest = {node.primitiveId(), candidate};
      }
      return;
    }
    const double left = squaredDistanceToBox(tree.getBV(node.leftChild()).bv, point);
    const double right = squaredDistanceToBox(tree.getBV(node.rightChild()).bv, point);
    const auto visit = [&](int child, double squared_distance) {
      if (nearest.triangle < 0 || squared_distance < nearest.point.squared_distance) {
        findNearest(child, point, nearest);
      }
    };
    if (left <= right) {
      visit(node.leftChild(), left);
      visit(node.rightChild(), right);
    } else {
      visit(node.rightChild(), right);
      visit(node.leftChild(), left);
    }
  }

  /// The pseudo-normal of the face, edge or point that the nearest point lies on.
  Eigen::Vector3d pseudoNormal(const Nearest& nearest) const {
    const Eigen::Vector3d& weights = nearest.point.barycentric;
    for (int k = 0; k < 3; ++k) {
      if (weights((k + 1) % 3) == 0 && weights((k + 2) % 3) == 0) {
        return point_normals[soup.triangles[nearest.triangle][k]];
      }
    }
    for (int k = 0; k < 3; ++k) {
      if (weights((k + 2) % 3) == 0) return edge_normals[nearest.triangle][k];
    }
    return face_normals.col(nearest.triangle);
  }

  void appendParts(const Eigen::Matrix3d& whole, const Eigen::Matrix3d& barycentric, int halvings,
                   double margin, const Eigen::Vector3d& outward, const ToolMesh& mesh,
                   std::vector<TriangleContact>& contacts) const {
    const Eigen::Matrix3d corners = whole * barycentric;
    const Eigen::Vector3d middle = corners.rowwise().mean();
    const double radius = std::sqrt((corners.colwise() - middle).colwise().squaredNorm().maxCoeff());
    Eigen::Vector3d gradient;
    const double distance = mesh.signedDistance(middle, gradient);
    if (distance - radius >= margin) return;
    if (halvings > 0 && radius > 0.25 * smallest_extent) {
      const Eigen::Vector3d a = barycentric.col(0), b = barycentric.col(1), c = barycentric.col(2);
      const Eigen::Vector3d ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
      for (const std::array<Eigen::Vector3d, 3>& part :
           {std::array<Eigen::Vector3d, 3>{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {bc, ca, ab}}) {
        Eigen::Matrix3d weights;
        for (int k = 0; k < 3; ++k) weights.col(k) = part[k];
        appendParts(whole, weights, halvings - 1, margin, outward, mesh, contacts);
      }
      return;
    }
    const double inward_cosine = -outward.dot(gradient);
    if (distance >= margin || inward_cosine <= 0) return;
    contacts.push_back({barycentric.rowwise().mean(), gradient, distance,
                        inward_cosine * triangleAreaVector(corners).norm()});
  }
};

ToolMesh::ToolMesh(const std::string& path, double scale) : impl_(std::make_unique<Impl>()) {
  Impl& impl = *impl_;
  impl.soup = readSoup(path, scale);
  const EdgeTriangles triangle_of_edge = checkClosed(impl.soup, path);

  const int count = static_cast<int>(impl.soup.triangles.size());
  impl.triangles.resize(3, 3 * count);
  impl.face_normals.resize(3, count);
  impl.point_normals.assign(impl.soup.points.size(), Eigen::Vector3d::Zero());
  std::vector<fcl::Vector3d> corners_of_all;
  std::vector<fcl::Triangle> indices;
  for (int i = 0; i < count; ++i) {
    const Eigen::Matrix3d corners = cornersOf(impl.soup, i);
    impl.triangles.middleCols<3>(3 * i) = corners;
    impl.face_normals.col(i) = triangleAreaVector(corners).normalized();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d a = corners.col((k + 1) % 3) - corners.col(k);
      const Eigen::Vector3d b = corners.col((k + 2) % 3) - corners.col(k);
      impl.point_normals[impl.soup.triangles[i][k]] +=
          std::atan2(a.cross(b).norm(), a.dot(b)) * impl.face_normals.col(i);
      corners_of_all.push_back(corners.col(k));
    }
    indices.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  impl.edge_normals.resize(count);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) {
      const std::array<int, 3>& triangle = impl.soup.triangles[i];
      const int neighbour = triangle_of_edge.at({triangle[(k + 1) % 3], triangle[k]});
      impl.edge_normals[i][k] = impl.face_normals.col(i) + impl.face_normals.col(neighbour);
    }
  }
  const Eigen::Vector3d extent = impl.triangles.rowwise().maxCoeff() - impl.triangles.rowwise().minCoeff();
  impl.smallest_extent = extent.minCoeff();
  bool is_built = impl.tree.beginModel(count, 3 * count) == fcl::BVH_OK;
  is_built = is_built && impl.tree.addSubModel(corners_of_all, indices) == fcl::BVH_OK;
  is_built = is_built && impl.tree.endModel() == fcl::BVH_OK;
  POLYSCALPEL_ASSERT(is_built);
}

ToolMesh::~ToolMesh() = default;

const Eigen::Matrix3Xd& ToolMesh::triangles() const {
  return impl_->triangles;
}

double ToolMesh::signedDistance(const Eigen::Vector3d& point, Eigen::Vector3d& gradient) const {
  Impl::Nearest nearest;
  impl_->findNearest(0, point, nearest);
  const double distance = std::sqrt(nearest.point.squared_distance);
  const Eigen::Vector3d arm = point - nearest.point.point;
  // On the surface the arm is rounding: there the face tells the direction.
  if (distance < 1e-10 * impl_->smallest_extent || !(distance > 0)) {
    gradient = impl_->face_normals.col(nearest.triangle);
    return 0;
  }
  const double sign = arm.dot(impl_->pseudoNormal(nearest)) < 0 ? -1 : 1;
  gradient = sign / distance * arm;
  return sign * distance;
}

void ToolMesh::appendContacts(const Eigen::Matrix3d& corners, double margin,
                              std::vector<TriangleContact>& contacts) const {
  const Eigen::Vector3d area = triangleAreaVector(corners);
  if (!(area.norm() > 0)) return;
  impl_->appendParts(corners, Eigen::Matrix3d::Identity(), 3, margin, area.normalized(), *this, contacts);
}

}  // namespace polyscalpel
