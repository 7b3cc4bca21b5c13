// SPDX-License-Identifier: BSD-3-Clause
//
// Small scenes for the tests of the simulation.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel {

using ToolPoses = std::vector<std::optional<Eigen::Isometry3d>>;

inline Eigen::Isometry3d poseAt(const Eigen::Vector3d& origin) {
  return Eigen::Isometry3d(Eigen::Translation3d(origin));
}

/// A block of 0.1 x 0.1 x 0.05 m whose bottom is held, under gravity along -z. No tools.
inline SimulationConfig blockScene(bool tetrahedra = false) {
  SimulationConfig config;
  BoxMeshConfig box;
  box.size_m = {0.1, 0.1, 0.05};
  box.counts = {4, 4, 2};
  box.tetrahedra = tetrahedra;
  config.mesh = box;
  config.fixed = {FixedBox{{0, 0, 0}, {0.1, 0.1, 0}}};
  return config;
}

/// The block and a ball of 15 mm that may press it.
inline SimulationConfig pressingScene(bool tetrahedra = false) {
  SimulationConfig config = blockScene(tetrahedra);
  config.contact = ContactConfig();
  ToolConfig tool;
  tool.name = "ball";
  tool.shape = ShapeConfig();
  tool.shape->radius_m = 0.015;
  config.tools = {tool};
  return config;
}

/// The block and a blade without a body: a straight edge of 0.2 m along y, drawn through the tissue along x.
inline SimulationConfig cuttingScene(bool tetrahedra = false) {
  SimulationConfig config = blockScene(tetrahedra);
  config.cutting = CuttingConfig();
  ToolConfig tool;
  tool.name = "blade";
  tool.blade_edge_tool = (Eigen::Matrix3Xd(3, 2) << 0, 0, -0.1, 0.1, 0, 0).finished();
  config.tools = {tool};
  return config;
}

/// Pose of the ball that goes down into the top of the block at 20 mm/s, sliding along x.
inline Eigen::Isometry3d pressingPose(int step) {
  const Eigen::AngleAxisd turn(0.02 * step, Eigen::Vector3d(1, 2, 3).normalized());
  return poseAt({0.047 + 1e-4 * step, 0.053, 0.05 + 0.0155 - 2e-4 * step}) * turn;
}

/// Pose of the blade that is drawn along x at 0.3 m/s, level with z = 0.031 m, from before the block to
/// behind it.
constexpr int kCuttingSteps = 50;
inline Eigen::Isometry3d cuttingPose(int step) {
  return poseAt({-0.02 + 3e-3 * step, 0.05, 0.031});
}

}  // namespace polyscalpel
