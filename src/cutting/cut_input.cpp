// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/cut_input.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// How far the corners of a flat polygon may lie off their plane, as a part of its extent.
constexpr double kFlatness = 1e-3;

double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool overlap(double a, double b, double c, double d) {
  return std::max(std::min(a, b), std::min(c, d)) <= std::min(std::max(a, b), std::max(c, d));
}

/// Whether the sides a-b and c-d cross or touch.
bool meet(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  // Sides in one line that lie apart would pass the test below.
  if (!overlap(a.x(), b.x(), c.x(), d.x()) || !overlap(a.y(), b.y(), c.y(), d.y())) return false;
  return turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0;
}

void requireAtMost(const std::string& name, const std::string& what, int count) {
  if (count <= kMostCorners) return;
  throw std::invalid_argument(name + ": has " + std::to_string(count) + " " + what + ", must have at most " +
                              std::to_string(kMostCorners));
}

void requireInReach(const std::string& name, const Eigen::Ref<const Eigen::MatrixXd>& value) {
  requireFinite(name, value);
  if (value.size() > 0 && value.cwiseAbs().maxCoeff() > kLargestCoordinate_m) {
    throw std::invalid_argument(name + ": a coordinate lies beyond 1e9 m");
  }
}

void requireRigid(const std::string& name, const Eigen::Isometry3d& pose) {
  requireFinite(name, pose.matrix());
  requireInReach(name, pose.translation());
  constexpr double kOrthonormal = 1e-6;
  const Eigen::Matrix3d R = pose.linear();
  if (!((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() <= kOrthonormal) || R.determinant() < 0) {
    throw std::invalid_argument(name + ": its linear part must be a rotation to within 1e-6");
  }
}

}  // namespace

void validate(const PlaneCut& plane) {
  requireInReach("plane point", plane.point_world);
  requireFinite("plane normal", plane.normal_world);
  if (plane.normal_world.norm() == 0 || !std::isfinite(plane.normal_world.norm())) {
    throw std::invalid_argument("plane normal: its length must be finite and in (0, inf)");
  }
}

void validate(const PolygonCut& polygon) {
  const auto& corners = polygon.corners_world;
  const int n = static_cast<int>(corners.cols());
  if (n < 3) {
    throw std::invalid_argument("polygon: has " + std::to_string(n) + " corners, must have at least 3");
  }
  requireAtMost("polygon", "corners", n);
  requireInReach("polygon corners", corners);
  const Vector3d centre = corners.rowwise().mean();
  const double extent = (corners.colwise() - centre).colwise().norm().maxCoeff();
  for (int i = 0; i < n; ++i) {
    const Vector3d a = corners.col(i) - centre, b = corners.col((i + 1) % n) - centre;
    if ((b - a).norm() <= 1e-12 * extent || extent == 0) {
      throw std::invalid_argument("polygon: corners " + std::to_string(i) + " and " +
                                  std::to_string((i + 1) % n) + " coincide");
    }
  }
  Vector3d normal = 2 * polygon.areaVector();
  if (!(normal.norm() > 1e-9 * extent * extent)) {
    throw std::invalid_argument("polygon: its corners lie on a line or its outline crosses itself");
  }
  normal.normalize();
  const double off_plane = (normal.transpose() * (corners.colwise() - centre)).cwiseAbs().maxCoeff();
  if (off_plane > kFlatness * extent) {
    throw std::invalid_argument("polygon: a corner lies " + std::to_string(off_plane) +
                                " m off the plane of the others, must be at most 1e-3 of the extent");
  }
  const Vector3d x_axis = normal.unitOrthogonal(), y_axis = normal.cross(x_axis);
  const auto flat = [&](int i) {
    const Vector3d p = corners.col(i % n) - centre;
    return Vector2d(x_axis.dot(p), y_axis.dot(p));
  };
  for (int i = 0; i < n; ++i) {
    for (int j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      if (meet(flat(i), flat(i + 1), flat(j), flat(j + 1))) {
        throw std::invalid_argument("polygon: its sides " + std::to_string(i) + " and " + std::to_string(j) +
                                    " cross");
      }
    }
  }
}

void validateBladeEdge(const Eigen::Ref<const Eigen::Matrix3Xd>& edge_tool) {
  if (edge_tool.cols() < 2) {
    throw std::invalid_argument("blade edge: has " + std::to_string(edge_tool.cols()) +
                                " points, must have at least 2");
  }
  const int n = static_cast<int>(edge_tool.cols());
  requireAtMost("blade edge", "points", n);
  requireInReach("blade edge", edge_tool);
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      if (edge_tool.col(i) != edge_tool.col(j)) continue;
      if (i == 0 && j == n - 1 && n > 3) continue;  // a ring
      throw std::invalid_argument("blade edge: points " + std::to_string(i) + " and " + std::to_string(j) +
                                  " coincide");
    }
  }
}

void validate(const SweepCut& sweep) {
  validateBladeEdge(sweep.edge_tool);
  if (sweep.T_world_tool.size() < 2) {
    throw std::invalid_argument("sweep: has " + std::to_string(sweep.T_world_tool.size()) +
                                " poses, must have at least 2");
  }
  for (std::size_t i = 0; i < sweep.T_world_tool.size(); ++i)
    requireRigid("sweep pose " + std::to_string(i), sweep.T_world_tool[i]);
}

void validate(const std::vector<CutOperation>& operations) {
  if (operations.empty()) throw std::invalid_argument("cuts: the list is empty, must have at least 1");
  for (std::size_t i = 0; i < operations.size(); ++i) {
    try {
      std::visit([](const auto& value) { validate(value); }, operations[i]);
    } catch (const std::invalid_argument& exception) {
      if (operations.size() == 1) throw;
      throw std::invalid_argument("cut " + std::to_string(i + 1) + " of " +
                                  std::to_string(operations.size()) + ": " + exception.what());
    }
  }
}

void validate(const CuttingConfig& config) {
  requireInRange("cutting.snap_tolerance", config.snap_tolerance, 1e-6, 0.2);
  requireInRange("cutting.hold_back", config.hold_back, 0, 2);
  requireInRange("cutting.close_front_after_s", config.close_front_after_s, 0, 1e6);
  requireInRange("cutting.max_travel", config.max_travel, 1e-3, 1);
  requireInRange("cutting.debris_volume_m3", config.debris_volume_m3, 0, kInfinity);
}

}  // namespace polyscalpel
