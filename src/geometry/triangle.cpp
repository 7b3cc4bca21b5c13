// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/geometry/triangle.hpp"

#include <algorithm>

#include <Eigen/Geometry>

namespace polyscalpel {
namespace {

/// Parameter in [0, 1] of the point of the segment (a, b) that is closest to p.
double closestParameter(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = b - a;
  const double length_squared = d.squaredNorm();
  return length_squared > 0 ? std::clamp((p - a).dot(d) / length_squared, 0.0, 1.0) : 0.0;
}

}  // namespace

TrianglePoint closestPointOnTriangle(const Eigen::Vector3d& point, const Eigen::Matrix3d& corners) {
  const Eigen::Vector3d ab = corners.col(1) - corners.col(0);
  const Eigen::Vector3d ac = corners.col(2) - corners.col(0);
  const Eigen::Vector3d area = ab.cross(ac);
  const double area_squared = area.squaredNorm();
  if (area_squared > 0) {
    const Eigen::Vector3d p = point - corners.col(0);
    const double v = p.cross(ac).dot(area) / area_squared;
    const double w = ab.cross(p).dot(area) / area_squared;
    if (v >= 0 && w >= 0 && v + w <= 1) {
      TrianglePoint result;
      result.barycentric = {1 - v - w, v, w};
      result.point = corners.col(0) + v * ab + w * ac;
      result.squared_distance = (point - result.point).squaredNorm();
      return result;
    }
  }
  TrianglePoint best;
  best.squared_distance = -1;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double t = closestParameter(point, corners.col(i), corners.col(j));
    const Eigen::Vector3d candidate = (1 - t) * corners.col(i) + t * corners.col(j);
    const double squared_distance = (point - candidate).squaredNorm();
    if (best.squared_distance >= 0 && squared_distance >= best.squared_distance) continue;
    best.point = candidate;
    best.barycentric.setZero();
    best.barycentric(i) = 1 - t;
    best.barycentric(j) = t;
    best.squared_distance = squared_distance;
  }
  return best;
}

ClosestPoints closestPointsOfSegments(const Eigen::Vector3d& a_0, const Eigen::Vector3d& a_1,
                                      const Eigen::Vector3d& b_0, const Eigen::Vector3d& b_1) {
  const Eigen::Vector3d u = a_1 - a_0;
  const Eigen::Vector3d v = b_1 - b_0;
  const double determinant = u.cross(v).squaredNorm();
  ClosestPoints best;
  best.squared_distance = -1;
  const auto consider = [&](double s, double t) {
    const Eigen::Vector3d first = a_0 + s * u;
    const Eigen::Vector3d second = b_0 + t * v;
    const double squared_distance = (first - second).squaredNorm();
    if (best.squared_distance >= 0 && squared_distance >= best.squared_distance) return;
    best = {first, second, squared_distance};
  };
  // Inside both segments, unless they are parallel to rounding; then an end of one is as close as any point.
  if (determinant > 1e-24 * u.squaredNorm() * v.squaredNorm()) {
    const Eigen::Vector3d w = b_0 - a_0;
    const Eigen::Vector3d normal = u.cross(v);
    const double s = w.cross(v).dot(normal) / determinant;
    const double t = w.cross(u).dot(normal) / determinant;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) consider(s, t);
  }
  consider(0, closestParameter(a_0, b_0, b_1));
  consider(1, closestParameter(a_1, b_0, b_1));
  consider(closestParameter(b_0, a_0, a_1), 0);
  consider(closestParameter(b_1, a_0, a_1), 1);
  return best;
}

ClosestPoints closestPointsOfSegmentAndTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                                const Eigen::Matrix3d& corners) {
  const Eigen::Vector3d area = triangleAreaVector(corners);
  const double height_a = area.dot(a - corners.col(0));
  const double height_b = area.dot(b - corners.col(0));
  if (height_a != height_b && (height_a <= 0) != (height_b <= 0)) {
    const Eigen::Vector3d crossing = a + height_a / (height_a - height_b) * (b - a);
    const Eigen::Vector3d barycentric = barycentricCoordinates(crossing, corners);
    if (barycentric.minCoeff() >= 0) return {crossing, crossing, 0};
  }
  const TrianglePoint from_a = closestPointOnTriangle(a, corners);
  const TrianglePoint from_b = closestPointOnTriangle(b, corners);
  ClosestPoints best{a, from_a.point, from_a.squared_distance};
  if (from_b.squared_distance < best.squared_distance) best = {b, from_b.point, from_b.squared_distance};
  for (int i = 0; i < 3; ++i) {
    const ClosestPoints edge = closestPointsOfSegments(a, b, corners.col(i), corners.col((i + 1) % 3));
    if (edge.squared_distance < best.squared_distance) best = edge;
  }
  return best;
}

Eigen::Vector3d barycentricCoordinates(const Eigen::Vector3d& point, const Eigen::Matrix3d& corners) {
  const Eigen::Vector3d ab = corners.col(1) - corners.col(0);
  const Eigen::Vector3d ac = corners.col(2) - corners.col(0);
  const Eigen::Vector3d p = point - corners.col(0);
  const Eigen::Vector3d area = ab.cross(ac);
  const double v = p.cross(ac).dot(area) / area.squaredNorm();
  const double w = ab.cross(p).dot(area) / area.squaredNorm();
  return {1 - v - w, v, w};
}

Eigen::Vector3d triangleAreaVector(const Eigen::Matrix3d& corners) {
  const Eigen::Vector3d ab = corners.col(1) - corners.col(0);
  const Eigen::Vector3d ac = corners.col(2) - corners.col(0);
  return 0.5 * ab.cross(ac);
}

}  // namespace polyscalpel
