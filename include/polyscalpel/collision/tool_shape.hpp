// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include <Eigen/Geometry>

namespace polyscalpel {

enum class ShapeKind { kSphere, kCapsule, kBox, kCylinder, kMesh };

/// Shape of a tool's rigid body, centred on its own frame; capsule and cylinder lie along z.
struct ShapeConfig {
  ShapeKind kind = ShapeKind::kSphere;
  double radius_m = 0.005;  ///< sphere, capsule, cylinder: > 0
  double length_m = 0.02;   ///< capsule (between the centres of its caps), cylinder: > 0
  Eigen::Vector3d size_m = Eigen::Vector3d::Constant(0.01);  ///< box: full edge lengths, each > 0
  std::string path;  ///< mesh: a closed triangle surface, .stl .obj .ply .off
  double scale = 1;  ///< mesh: file units to metres, > 0
  Eigen::Isometry3d T_tool_shape = Eigen::Isometry3d::Identity();
};

/// Throws std::invalid_argument with name, value and range.
void validate(const ShapeConfig& config);

/// A rigid shape ready for contact queries. Immutable.
class ToolShape {
 public:
  /// Throws std::invalid_argument for a bad config or mesh file.
  explicit ToolShape(const ShapeConfig& config);
  ~ToolShape();
  ToolShape(ToolShape&&) noexcept;
  ToolShape& operator=(ToolShape&&) noexcept;

  const ShapeConfig& config() const;

  /// Triangles of the shape for display, in the tool's frame: 3 x 3k [m], three columns a triangle, outward.
  const Eigen::Matrix3Xd& triangles() const;

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace polyscalpel
