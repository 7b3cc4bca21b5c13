// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/collision/triangle_contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "polyscalpel/core/types.hpp"
#include "polyscalpel/geometry/triangle.hpp"

namespace polyscalpel {
namespace {

constexpr double kLargestOutwardCosine = 0.5;  // (b): a way out that points outward by more is not taken
constexpr double kLargestSunkenPart = 0.9;     // (b): of the tool's extent, beyond which it pokes from within
constexpr double kSmallestInwardCosine = 0.02;  // (c): a surface seen this flat stands for no area
constexpr double kReach = 0.05;                 // overlap in which the area is taken, as a part of the margin
constexpr int kSectionCorners = 16;
constexpr int kRimDirections = 16;
constexpr int kRimHalvings = 10;

/// The point of segment (a, b) with the smallest signed distance: bisection on the monotone derivative.
Eigen::Vector3d closestOnSegment(const ConvexShape& shape, const Eigen::Vector3d& a,
                                 const Eigen::Vector3d& b) {
  const Eigen::Vector3d direction = b - a;
  Eigen::Vector3d gradient;
  shape.signedDistance(a, &gradient);
  if (gradient.dot(direction) >= 0) return a;
  shape.signedDistance(b, &gradient);
  if (gradient.dot(direction) <= 0) return b;
  double low = 0;
  double high = 1;
  for (int i = 0; i < 48; ++i) {
    const double middle = 0.5 * (low + high);
    shape.signedDistance(a + middle * direction, &gradient);
    (gradient.dot(direction) < 0 ? low : high) = middle;
  }
  return a + 0.5 * (low + high) * direction;
}

bool isInTriangle(const Eigen::Vector3d& point, const Eigen::Matrix3d& corners) {
  return barycentricCoordinates(point, corners).minCoeff() >= 0;
}

/// Where the plane through `origin` with unit `normal` meets the chord of the shape between its farthest
/// points on both sides; nothing if the shape is on one side.
std::optional<Eigen::Vector3d> pointOfSection(const ConvexShape& shape, const Eigen::Vector3d& origin,
                                              const Eigen::Vector3d& normal) {
  const Eigen::Vector3d highest = shape.support(normal);
  const double height = normal.dot(highest);  // the lowest point is the opposite one
  const double plane = normal.dot(origin);
  if (std::abs(plane) >= height) return std::nullopt;
  return Eigen::Vector3d(plane / height * highest);
}

/// Minimum over the triangle of the signed distance, exact where positive; a value <= 0 says "overlap" and no
/// more. The signed distance is convex: its minimum lies in the triangle's inside, where the gradient is
/// normal, or on an edge.
TriangleGap separation(const ConvexShape& shape, const Eigen::Matrix3d& corners,
                       const Eigen::Vector3d& outward) {
  const double plane = outward.dot(corners.col(0));
  const Eigen::Vector3d highest = shape.support(outward);
  const double height = outward.dot(highest);
  if (const std::optional<Eigen::Vector3d> point = pointOfSection(shape, corners.col(0), outward)) {
    if (isInTriangle(*point, corners)) return {-1, -outward};
  } else {
    const double side = plane > 0 ? 1 : -1;
    if (isInTriangle(side * highest, corners)) return {std::abs(plane) - height, side * outward};
  }
  TriangleGap best{kInfinity, -outward};
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d point = closestOnSegment(shape, corners.col(i), corners.col((i + 1) % 3));
    Eigen::Vector3d gradient;
    const double distance = shape.signedDistance(point, &gradient);
    if (distance < best.gap) best = {distance, gradient};
    if (best.gap <= 0) break;
  }
  return best;
}

/// Length of the way that frees the triangle from the shape along a unit direction.
double wayOut(const ConvexShape& shape, const Eigen::Matrix3d& corners, const Eigen::Vector3d& direction) {
  return direction.dot(shape.support(direction)) - (direction.transpose() * corners).minCoeff();
}

/// The shortest way out of the shape for an overlapping triangle.
TriangleGap shortestWayOut(const ConvexShape& shape, const Eigen::Matrix3d& corners,
                           const Eigen::Vector3d& outward) {
  TriangleGap best{-kInfinity, -outward};
  // Both senses of a direction; returns the gap along the better one.
  const auto consider = [&](const Eigen::Vector3d& direction) {
    const double length = direction.norm();
    double gap = -kInfinity;
    if (!(length > 0)) return gap;
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d unit = sign / length * direction;
      const double way = wayOut(shape, corners, unit);
      gap = std::max(gap, -way);
      if (-way > best.gap) best = {-way, unit};
    }
    return gap;
  };
  // A cross product that is mere rounding would give a random direction: allowed, but no use.
  const auto considerCross = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    const Eigen::Vector3d direction = a.cross(b);
    const bool is_rounding = direction.squaredNorm() <= 1e-12 * a.squaredNorm() * b.squaredNorm();
    return is_rounding ? -kInfinity : consider(direction);
  };

  // The rim of a cylinder against an edge: one normal for each place on the rim. The best of some, then a
  // pattern search.
  const auto considerRim = [&](const Eigen::Vector3d& edge) {
    double step = 2 * M_PI / kRimDirections;
    double best_angle = 0;
    double best_gap = -kInfinity;
    const auto tryAngle = [&](double angle) {
      const double gap = considerCross(edge, {-std::sin(angle), std::cos(angle), 0});
      if (gap <= best_gap) return false;
      best_gap = gap;
      best_angle = angle;
      return true;
    };
    for (int k = 0; k < kRimDirections / 2; ++k) tryAngle(k * step);
    for (int halving = 0; halving < kRimHalvings; ++halving) {
      step /= 2;
      if (!tryAngle(best_angle + step)) tryAngle(best_angle - step);
    }
  };

  if (shape.kind == ShapeKind::kSphere || shape.kind == ShapeKind::kCapsule) {
    const Eigen::Vector3d end(0, 0, shape.half_length);
    ClosestPoints closest;
    if (shape.kind == ShapeKind::kSphere) {
      const TrianglePoint point = closestPointOnTriangle(Eigen::Vector3d::Zero(), corners);
      closest = {Eigen::Vector3d::Zero(), point.point, point.squared_distance};
    } else {
      closest = closestPointsOfSegmentAndTriangle(-end, end, corners);
    }
    const double distance = std::sqrt(closest.squared_distance);
    if (distance > 1e-9 * shape.radius) {
      return {distance - shape.radius, (closest.second - closest.first) / distance};
    }
  }
  consider(-outward);  // first, so that it wins a tie
  std::array<Eigen::Vector3d, 3> edges;
  for (int i = 0; i < 3; ++i) edges[i] = corners.col((i + 1) % 3) - corners.col(i);
  switch (shape.kind) {
    case ShapeKind::kSphere:
      break;
    case ShapeKind::kCapsule:
      for (const Eigen::Vector3d& edge : edges) considerCross(edge, Eigen::Vector3d::UnitZ());
      break;
    case ShapeKind::kBox:
      for (int axis = 0; axis < 3; ++axis) {
        consider(Eigen::Vector3d::Unit(axis));
        for (const Eigen::Vector3d& edge : edges) considerCross(edge, Eigen::Vector3d::Unit(axis));
      }
      break;
    case ShapeKind::kCylinder:
      consider(Eigen::Vector3d::UnitZ());
      for (int i = 0; i < 3; ++i) {
        considerCross(edges[i], Eigen::Vector3d::UnitZ());
        consider(Eigen::Vector3d(corners(0, i), corners(1, i), 0));
        considerRim(edges[i]);
      }
      break;
    case ShapeKind::kMesh:
      break;
  }
  return best;
}

/// The triangle's unit normal, or nothing for a triangle without area.
std::optional<Eigen::Vector3d> outwardNormal(const Eigen::Matrix3d& corners) {
  const Eigen::Vector3d area = triangleAreaVector(corners);
  const double longest_squared = std::max({(corners.col(1) - corners.col(0)).squaredNorm(),
                                           (corners.col(2) - corners.col(1)).squaredNorm(),
                                           (corners.col(0) - corners.col(2)).squaredNorm()});
  const double length = area.norm();
  if (!(length > 1e-12 * longest_squared)) return std::nullopt;
  return Eigen::Vector3d(area / length);
}

using Polygon = std::vector<Eigen::Vector3d>;

/// Keeps the part of a convex polygon with normal . x <= offset.
void clip(Polygon& polygon, const Eigen::Vector3d& normal, double offset, Polygon& scratch) {
  scratch.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& a = polygon[i];
    const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
    const double beyond_a = normal.dot(a) - offset;
    const double beyond_b = normal.dot(b) - offset;
    if (beyond_a <= 0) scratch.push_back(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0)) {
      scratch.push_back(a + beyond_a / (beyond_a - beyond_b) * (b - a));
    }
  }
  polygon.swap(scratch);
}

/// The section of a round shape by the triangle's plane as a polygon of equal area; empty if there is none.
void makeSection(const ConvexShape& shape, const Eigen::Matrix3d& corners, const Eigen::Vector3d& outward,
                 Polygon& polygon) {
  polygon.clear();
  std::optional<Eigen::Vector3d> found = pointOfSection(shape, corners.col(0), outward);
  if (!found) return;
  // Along the axis as it lies in the plane, or anywhere for a plane across it.
  Eigen::Vector3d u = Eigen::Vector3d::UnitZ() - outward.z() * outward;
  if (u.norm() < 1e-3) u = outward.unitOrthogonal();
  u.normalize();
  const Eigen::Vector3d v = outward.cross(u);
  Eigen::Vector3d centre = *found;
  Eigen::Vector2d half(0, 0);
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector3d& axis = i == 0 ? u : v;
      const std::optional<double> forward = shape.exitParameter(centre, axis);
      const std::optional<double> backward = shape.exitParameter(centre, -axis);
      if (!forward || !backward) return;
      centre += 0.5 * (*forward - *backward) * axis;
      half(i) = 0.5 * (*forward + *backward);
    }
  }
  if (!(half.minCoeff() > 0)) return;
  const double step = 2 * M_PI / kSectionCorners;
  const double equal_area = std::sqrt(step / std::sin(step));
  for (int k = 0; k < kSectionCorners; ++k) {
    const Eigen::Vector3d direction =
        (std::cos(k * step) * half(0) * u + std::sin(k * step) * half(1) * v).normalized();
    const std::optional<double> exit = shape.exitParameter(centre, direction);
    if (!exit) {
      polygon.clear();
      return;
    }
    polygon.push_back(centre + equal_area * *exit * direction);
  }
}

/// The part of the triangle inside the shape.
void makePart(const ConvexShape& shape, const Eigen::Matrix3d& corners, const Eigen::Vector3d& outward,
              Polygon& polygon, Polygon& scratch) {
  bool is_inside = true;
  for (int i = 0; i < 3; ++i) is_inside = is_inside && shape.signedDistance(corners.col(i)) <= 0;
  if (is_inside || shape.kind == ShapeKind::kBox) {
    polygon.assign({corners.col(0), corners.col(1), corners.col(2)});
    if (is_inside) return;
    for (int axis = 0; axis < 3 && !polygon.empty(); ++axis) {
      clip(polygon, Eigen::Vector3d::Unit(axis), shape.half_size(axis), scratch);
      clip(polygon, -Eigen::Vector3d::Unit(axis), shape.half_size(axis), scratch);
    }
    return;
  }
  makeSection(shape, corners, outward, polygon);
  for (int i = 0; i < 3 && !polygon.empty(); ++i) {
    const Eigen::Vector3d beyond = (corners.col((i + 1) % 3) - corners.col(i)).cross(outward);
    clip(polygon, beyond, beyond.dot(corners.col(i)), scratch);
  }
}

}  // namespace

std::optional<TriangleGap> triangleGap(const ConvexShape& shape, const Eigen::Matrix3d& corners,
                                       double margin) {
  const std::optional<Eigen::Vector3d> outward = outwardNormal(corners);
  if (!outward) return std::nullopt;
  // The distance changes by no more than the way: a ball around the triangle decides most cases.
  const Eigen::Vector3d middle = corners.rowwise().mean();
  const double radius = std::sqrt((corners.colwise() - middle).colwise().squaredNorm().maxCoeff());
  if (shape.signedDistance(middle) - radius >= margin) return std::nullopt;
  const TriangleGap apart = separation(shape, corners, *outward);
  if (apart.gap >= margin) return std::nullopt;
  return apart.gap > 0 ? apart : shortestWayOut(shape, corners, *outward);
}

std::optional<TriangleGap> pushOnTriangle(const ConvexShape& shape, const Eigen::Matrix3d& corners,
                                          double margin) {
  std::optional<TriangleGap> result = triangleGap(shape, corners, margin);
  if (!result) return result;
  const Eigen::Vector3d inward = -*outwardNormal(corners);
  if (result->gap <= 0 && -inward.dot(result->normal) > kLargestOutwardCosine) {
    const double way = wayOut(shape, corners, inward);
    if (way > kLargestSunkenPart * 2 * inward.dot(shape.support(inward))) return std::nullopt;
    return TriangleGap{-way, inward};
  }
  if (inward.dot(result->normal) < kSmallestInwardCosine) return std::nullopt;
  return result;
}

void appendContacts(const ConvexShape& shape, const Eigen::Matrix3d& corners, double margin,
                    std::vector<TriangleContact>& contacts) {
  const std::optional<TriangleGap> push = pushOnTriangle(shape, corners, margin);
  if (!push) return;
  const Eigen::Vector3d outward = *outwardNormal(corners);
  const Eigen::Vector3d& n = push->normal;

  // Move the tool until it overlaps a little, or rather the triangle the other way.
  const double shift = std::max(0.0, push->gap + kReach * margin);
  const Eigen::Matrix3d moved = corners.colwise() - shift * n;
  Polygon polygon, scratch;
  makePart(shape, moved, outward, polygon, scratch);
  if (polygon.size() < 3) return;

  // A line through the very border could miss the tool by rounding.
  const auto gapAt = [&](const Eigen::Vector3d& point, const Eigen::Vector3d& centre) {
    const std::optional<double> exit = shape.exitParameter(point + 1e-6 * (centre - point), n);
    return exit ? shift - *exit : shift;
  };
  // A fan around the mean; on each of its triangles the mid-edge rule, exact for quadratic gaps.
  const int count = static_cast<int>(polygon.size());
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& corner : polygon) centre += corner / count;
  std::vector<double> area(count), spoke_gap(count);
  double total_area = 0;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d& a = polygon[i];
    area[i] = 0.5 * (a - centre).cross(polygon[(i + 1) % count] - centre).norm();
    total_area += area[i];
    spoke_gap[i] = gapAt(0.5 * (centre + a), centre);
  }
  if (!(total_area > 0)) return;

  const double inward_cosine = -outward.dot(n);
  double group_area = 0, group_gap = 0, passed_area = 0;
  Eigen::Vector3d group_point = Eigen::Vector3d::Zero();
  int groups = 0;
  for (int i = 0; i < count; ++i) {
    const int j = (i + 1) % count;
    const double mean_gap =
        (spoke_gap[i] + spoke_gap[j] + gapAt(0.5 * (polygon[i] + polygon[j]), centre)) / 3;
    group_area += area[i];
    group_gap += area[i] * mean_gap;
    group_point += area[i] / 3 * (centre + polygon[i] + polygon[j]);
    passed_area += area[i];
    const bool is_last = i + 1 == count;
    if (!is_last && passed_area < (groups + 1) * total_area / 3 * (1 - 1e-9)) continue;
    ++groups;
    if (group_area > 1e-9 * total_area && group_gap < margin * group_area) {
      TriangleContact contact;
      contact.barycentric = barycentricCoordinates(group_point / group_area, moved);
      contact.barycentric = contact.barycentric.cwiseMax(0.0);
      contact.barycentric /= contact.barycentric.sum();
      contact.normal = n;
      contact.gap = group_gap / group_area;
      contact.area = group_area * inward_cosine;
      contacts.push_back(contact);
    }
    group_area = group_gap = 0;
    group_point.setZero();
  }
}

}  // namespace polyscalpel
