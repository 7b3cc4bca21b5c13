// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "polyscalpel/collision/convex_shape.hpp"
#include "polyscalpel/collision/tool_shape.hpp"
#include "tool_mesh.hpp"

namespace polyscalpel {

/// What a ToolShape is made of: a convex primitive or a mesh, exactly one of the two.
struct ToolShape::Impl {
  ShapeConfig config;
  std::optional<ConvexShape> convex;
  std::unique_ptr<const ToolMesh> mesh;
  Eigen::AlignedBox3d box_shape;    ///< bounds in the shape's frame [m]
  Eigen::Matrix3Xd triangles_tool;  ///< 3 x 3k [m], for display
};

}  // namespace polyscalpel
