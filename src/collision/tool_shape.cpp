// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/collision/tool_shape.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include "polyscalpel/core/checks.hpp"
#include "tool_shape_impl.hpp"

namespace polyscalpel {
namespace {

constexpr int kSegments = 32;  // round the axis; a quarter of them from equator to pole

using Triangles = std::vector<Eigen::Vector3d>;

/// Surface of revolution about z: profile points (distance to the axis, z) from the lowest to the highest;
/// the first and the last lie on the axis.
Triangles revolve(const std::vector<Eigen::Vector2d>& profile) {
  Triangles triangles;
  const auto point = [&](std::size_t i, int k) {
    const double angle = 2 * M_PI * (k % kSegments) / kSegments;
    return Eigen::Vector3d(profile[i].x() * std::cos(angle), profile[i].x() * std::sin(angle),
                           profile[i].y());
  };
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    for (int k = 0; k < kSegments; ++k) {
      if (profile[i].x() > 0) {
        triangles.insert(triangles.end(), {point(i, k), point(i, k + 1), point(i + 1, k)});
      }
      if (profile[i + 1].x() > 0) {
        triangles.insert(triangles.end(), {point(i, k + 1), point(i + 1, k + 1), point(i + 1, k)});
      }
    }
  }
  return triangles;
}

Triangles boxTriangles(const Eigen::Vector3d& half_size) {
  Triangles triangles;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const Eigen::Vector3d middle = side * half_size(axis) * Eigen::Vector3d::Unit(axis);
      const int next = (axis + 1) % 3;
      const int last = (axis + 2) % 3;
      const Eigen::Vector3d u = side * half_size(next) * Eigen::Vector3d::Unit(next);
      const Eigen::Vector3d v = half_size(last) * Eigen::Vector3d::Unit(last);
      triangles.insert(triangles.end(), {middle - u - v, middle + u - v, middle + u + v});
      triangles.insert(triangles.end(), {middle - u - v, middle + u + v, middle - u + v});
    }
  }
  return triangles;
}

Triangles primitiveTriangles(const ConvexShape& shape) {
  if (shape.kind == ShapeKind::kBox) return boxTriangles(shape.half_size);
  std::vector<Eigen::Vector2d> profile;
  if (shape.kind == ShapeKind::kCylinder) {
    profile = {{0, -shape.half_length},
               {shape.radius, -shape.half_length},
               {shape.radius, shape.half_length},
               {0, shape.half_length}};
    return revolve(profile);
  }
  const int quarter = kSegments / 4;
  for (const double side : {-1.0, 1.0}) {
    for (int k = 0; k <= quarter; ++k) {
      if (k == 0 && side > 0 && shape.half_length == 0) continue;  // a sphere has one equator
      const int from_pole = side < 0 ? k : quarter - k;
      const double angle = M_PI / 2 * from_pole / quarter;
      profile.emplace_back(from_pole == 0 ? 0 : shape.radius * std::sin(angle),
                           side * (shape.half_length + shape.radius * std::cos(angle)));
    }
  }
  return revolve(profile);
}

}  // namespace

void validate(const ShapeConfig& config) {
  switch (config.kind) {
    case ShapeKind::kSphere:
      requirePositive("radius_m", config.radius_m);
      break;
    case ShapeKind::kCapsule:
    case ShapeKind::kCylinder:
      requirePositive("radius_m", config.radius_m);
      requirePositive("length_m", config.length_m);
      break;
    case ShapeKind::kBox:
      for (int i = 0; i < 3; ++i) requirePositive("size_m[" + std::to_string(i) + "]", config.size_m(i));
      break;
    case ShapeKind::kMesh:
      if (config.path.empty()) throw std::invalid_argument("path = \"\": must name a mesh file");
      requirePositive("scale", config.scale);
      break;
    default:
      throw std::invalid_argument("kind = " + std::to_string(static_cast<int>(config.kind)) +
                                  ": must be sphere, capsule, box, cylinder or mesh");
  }
  requireFinite("T_tool_shape", config.T_tool_shape.matrix());
  const Eigen::Matrix3d rotation = config.T_tool_shape.linear();
  if (!(rotation.transpose() * rotation).isIdentity(1e-6) || rotation.determinant() < 0) {
    throw std::invalid_argument("T_tool_shape: must be a rotation and a translation");
  }
}

ToolShape::ToolShape(const ShapeConfig& config) : impl_(std::make_unique<Impl>()) {
  validate(config);
  impl_->config = config;
  if (config.kind == ShapeKind::kMesh) {
    impl_->mesh = std::make_unique<const ToolMesh>(config.path, config.scale);
    impl_->triangles_tool = impl_->mesh->triangles();
    impl_->box_shape = {impl_->triangles_tool.rowwise().minCoeff(),
                        impl_->triangles_tool.rowwise().maxCoeff()};
  } else {
    impl_->convex.emplace(config);
    impl_->box_shape = {-impl_->convex->half_size, impl_->convex->half_size};
    const Triangles triangles = primitiveTriangles(*impl_->convex);
    impl_->triangles_tool.resize(3, triangles.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) impl_->triangles_tool.col(i) = triangles[i];
  }
  impl_->triangles_tool = (config.T_tool_shape * impl_->triangles_tool).eval();
}

ToolShape::~ToolShape() = default;
ToolShape::ToolShape(ToolShape&&) noexcept = default;
ToolShape& ToolShape::operator=(ToolShape&&) noexcept = default;

const ShapeConfig& ToolShape::config() const {
  return impl_->config;
}

const Eigen::Matrix3Xd& ToolShape::triangles() const {
  return impl_->triangles_tool;
}

}  // namespace polyscalpel
