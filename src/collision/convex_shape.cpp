// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/collision/convex_shape.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/types.hpp"

namespace polyscalpel {
namespace {

struct Interval {
  double lowest = -kInfinity;
  double highest = kInfinity;

  void cut(const Interval& other) {
    lowest = std::max(lowest, other.lowest);
    highest = std::min(highest, other.highest);
  }
  bool isEmpty() const { return !(lowest <= highest); }
};

constexpr Interval kNowhere{1, -1};

/// Parameters t with |position + t * velocity| <= half.
Interval insideSlab(double position, double velocity, double half) {
  if (velocity == 0) return std::abs(position) <= half ? Interval{} : kNowhere;
  const double a = (-half - position) / velocity;
  const double b = (half - position) / velocity;
  return {std::min(a, b), std::max(a, b)};
}

/// Parameters t with |position + t * velocity| <= radius, in two or three dimensions.
template <class Vector>
Interval insideBall(const Vector& position, const Vector& velocity, double radius) {
  const double a = velocity.squaredNorm();
  if (a < 1e-24) return position.squaredNorm() <= radius * radius ? Interval{} : kNowhere;
  const double middle = -position.dot(velocity) / a;
  const double rest = radius * radius - (position + middle * velocity).squaredNorm();
  if (rest < 0) return kNowhere;
  const double half = std::sqrt(rest / a);
  return {middle - half, middle + half};
}

}  // namespace

ConvexShape::ConvexShape(const ShapeConfig& config) : kind(config.kind) {
  POLYSCALPEL_ASSERT(kind != ShapeKind::kMesh);
  if (kind == ShapeKind::kBox) {
    half_size = config.size_m / 2;
    return;
  }
  radius = config.radius_m;
  half_length = kind == ShapeKind::kSphere ? 0 : config.length_m / 2;
  half_size = {radius, radius, kind == ShapeKind::kCylinder ? half_length : half_length + radius};
}

double ConvexShape::signedDistance(const Eigen::Vector3d& point, Eigen::Vector3d* gradient) const {
  const auto set = [gradient](const Eigen::Vector3d& value) {
    if (gradient != nullptr) *gradient = value;
  };
  if (kind == ShapeKind::kSphere || kind == ShapeKind::kCapsule) {
    const Eigen::Vector3d arm(point.x(), point.y(),
                              point.z() - std::clamp(point.z(), -half_length, half_length));
    const double length = arm.norm();
    set(length > 0 ? Eigen::Vector3d(arm / length) : Eigen::Vector3d(Eigen::Vector3d::UnitX()));
    return length - radius;
  }
  if (kind == ShapeKind::kBox) {
    const Eigen::Vector3d beyond = point.cwiseAbs() - half_size;
    const Eigen::Vector3d outside = beyond.cwiseMax(0.0);
    const double length = outside.norm();
    if (length > 0) {
      const Eigen::Vector3d direction = outside / length;
      set(Eigen::Vector3d(std::copysign(direction.x(), point.x()), std::copysign(direction.y(), point.y()),
                          std::copysign(direction.z(), point.z())));
      return length;
    }
    int axis = 0;
    const double depth = beyond.maxCoeff(&axis);
    set(std::copysign(1.0, point(axis)) * Eigen::Vector3d::Unit(axis));
    return depth;
  }
  const double distance_to_axis = std::hypot(point.x(), point.y());
  const Eigen::Vector3d radial =
      distance_to_axis > 0 ? Eigen::Vector3d(point.x() / distance_to_axis, point.y() / distance_to_axis, 0)
                           : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  const Eigen::Vector3d axial(0, 0, std::copysign(1.0, point.z()));
  const double beyond_side = distance_to_axis - radius;
  const double beyond_end = std::abs(point.z()) - half_length;
  if (beyond_side > 0 && beyond_end > 0) {
    const double length = std::hypot(beyond_side, beyond_end);
    set((beyond_side * radial + beyond_end * axial) / length);
    return length;
  }
  set(beyond_side > beyond_end ? radial : axial);
  return std::max(beyond_side, beyond_end);
}

Eigen::Vector3d ConvexShape::support(const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d along_axis(0, 0, std::copysign(half_length, direction.z()));
  switch (kind) {
    case ShapeKind::kSphere:
    case ShapeKind::kCapsule:
      return along_axis + radius * direction.normalized();
    case ShapeKind::kBox:
      return {std::copysign(half_size.x(), direction.x()), std::copysign(half_size.y(), direction.y()),
              std::copysign(half_size.z(), direction.z())};
    case ShapeKind::kCylinder: {
      const double across = std::hypot(direction.x(), direction.y());
      if (across == 0) return along_axis;
      return along_axis + radius / across * Eigen::Vector3d(direction.x(), direction.y(), 0);
    }
    case ShapeKind::kMesh:
      break;
  }
  POLYSCALPEL_ASSERT(false);
  return Eigen::Vector3d::Zero();
}

std::optional<double> ConvexShape::exitParameter(const Eigen::Vector3d& point,
                                                 const Eigen::Vector3d& direction) const {
  Interval inside;
  switch (kind) {
    case ShapeKind::kSphere:
      inside = insideBall(point, direction, radius);
      break;
    case ShapeKind::kBox:
      for (int i = 0; i < 3; ++i) inside.cut(insideSlab(point(i), direction(i), half_size(i)));
      break;
    case ShapeKind::kCylinder:
      inside = insideBall<Eigen::Vector2d>(point.head<2>(), direction.head<2>(), radius);
      inside.cut(insideSlab(point.z(), direction.z(), half_length));
      break;
    case ShapeKind::kCapsule: {
      // The union of a cylinder and two balls is convex, so the line leaves it where it leaves the last of
      // the three.
      Interval side = insideBall<Eigen::Vector2d>(point.head<2>(), direction.head<2>(), radius);
      side.cut(insideSlab(point.z(), direction.z(), half_length));
      std::optional<double> last;
      for (const Interval& part :
           {side, insideBall<Eigen::Vector3d>(point - Eigen::Vector3d(0, 0, half_length), direction, radius),
            insideBall<Eigen::Vector3d>(point + Eigen::Vector3d(0, 0, half_length), direction, radius)}) {
        if (!part.isEmpty() && (!last || part.highest > *last)) last = part.highest;
      }
      return last;
    }
    case ShapeKind::kMesh:
      POLYSCALPEL_ASSERT(false);
  }
  if (inside.isEmpty()) return std::nullopt;
  return inside.highest;
}

}  // namespace polyscalpel
