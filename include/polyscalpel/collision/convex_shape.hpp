// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include <Eigen/Core>

#include "polyscalpel/collision/tool_shape.hpp"

namespace polyscalpel {

/// A convex primitive in closed form: sphere, capsule, box or cylinder, centred on the origin of its own
/// frame, along z. All four are point-symmetric. Points and directions are in the shape's frame [m].
struct ConvexShape {
  ShapeKind kind = ShapeKind::kSphere;  ///< not kMesh
  double radius = 0;                    ///< sphere, capsule, cylinder
  double half_length = 0;               ///< capsule, cylinder
  Eigen::Vector3d half_size =
      Eigen::Vector3d::Zero();  ///< box; for the others half the size of the bounding box

  explicit ConvexShape(const ShapeConfig& config);

  /// Distance to the surface, negative inside: a convex function of the point. `gradient` (may be null) gets
  /// the unit outward direction, an arbitrary one of several where it is not unique (the medial axis).
  double signedDistance(const Eigen::Vector3d& point, Eigen::Vector3d* gradient = nullptr) const;

  /// A point of the shape that lies farthest in a direction (any length > 0).
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const;

  /// The largest t with point + t * direction in the shape; nothing where the line misses the shape.
  /// direction: unit.
  std::optional<double> exitParameter(const Eigen::Vector3d& point, const Eigen::Vector3d& direction) const;
};

}  // namespace polyscalpel
