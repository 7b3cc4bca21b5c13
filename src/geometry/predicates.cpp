// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/geometry/predicates.hpp"

#include <cmath>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Gmpq.h>
#include <Eigen/Geometry>

namespace polyscalpel {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CGAL::Gmpq;
using Eigen::Vector3d;

Kernel::Point_3 toPoint(const Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

/// Exact sign of det(b - a, c - a, d - a).
int orientation(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  return static_cast<int>(CGAL::orientation(toPoint(a), toPoint(b), toPoint(c), toPoint(d)));
}

double determinant(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Exact sign of the first non-zero component of (b - a) x (d - c): the sign of its product with the mesh's
/// shift.
int shiftSign(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Gmpq first = (Gmpq(b[j]) - Gmpq(a[j])) * (Gmpq(d[k]) - Gmpq(c[k]));
    const Gmpq second = (Gmpq(b[k]) - Gmpq(a[k])) * (Gmpq(d[j]) - Gmpq(c[j]));
    const auto sign = CGAL::sign(first - second);
    if (sign != CGAL::ZERO) return static_cast<int>(sign);
  }
  return 0;
}

/// Part of a quantity that is known to be on the side `sign`: rounding may not carry it across zero.
double magnitude(double value, int sign) {
  return std::max(0.0, value * sign);
}

}  // namespace

int sideOfPlane(const Vector3d& mesh_point, const Vector3d& plane_point, const Vector3d& normal) {
  const Vector3d offset = mesh_point - plane_point;
  const double value = normal.dot(offset);
  // Each of the three products carries at most 1.5 ulp of itself, the sum at most 2 more.
  const double bound = 4 * std::numeric_limits<double>::epsilon() * normal.cwiseAbs().dot(offset.cwiseAbs());
  if (std::abs(value) > bound && bound > std::numeric_limits<double>::min()) return value > 0 ? 1 : -1;
  Gmpq exact(0.0);
  for (int i = 0; i < 3; ++i) {
    exact = exact + Gmpq(normal[i]) * (Gmpq(mesh_point[i]) - Gmpq(plane_point[i]));
  }
  const auto sign = CGAL::sign(exact);
  if (sign != CGAL::ZERO) return static_cast<int>(sign);
  for (int i = 0; i < 3; ++i) {
    if (normal[i] != 0) return normal[i] > 0 ? 1 : -1;
  }
  return 0;
}

TriangleCrossing crossTriangle(const Vector3d& p, const Vector3d& q, const Vector3d& a, const Vector3d& b,
                               const Vector3d& c, MeshPart mesh_part) {
  const int shift = mesh_part == MeshPart::kSegment ? 1 : -1;  // of the segment, relative to the triangle
  TriangleCrossing crossing;

  // An endpoint in the plane moves off it by shift . ((b - a) x (c - a)).
  int side_p = orientation(a, b, c, p);
  int side_q = orientation(a, b, c, q);
  if (side_p == side_q && side_p != 0) return crossing;
  if (side_p == 0 || side_q == 0) {
    const int tie = shift * shiftSign(a, b, a, c);
    if (side_p == 0) side_p = tie;
    if (side_q == 0) side_q = tie;
  }
  if (side_p == side_q) return crossing;

  // det(q - p, a - p - s, b - p - s) = det(q - p, a - p, b - p) - s . ((b - a) x (q - p)) for a shift s of
  // the segment.
  const Vector3d* corners[3] = {&a, &b, &c};
  double weights[3];
  for (int i = 0; i < 3; ++i) {
    const Vector3d& u = *corners[(i + 1) % 3];
    const Vector3d& v = *corners[(i + 2) % 3];
    int side = orientation(p, q, u, v);
    if (side == 0) side = -shift * shiftSign(u, v, p, q);
    if (side != side_q) return crossing;
    weights[i] = magnitude(determinant(p, q, u, v), side);
  }

  crossing.sign = side_q;
  const double from_p = magnitude(determinant(a, b, c, p), side_p);
  const double to_q = magnitude(determinant(a, b, c, q), side_q);
  if (from_p + to_q > 0) crossing.segment_parameter = from_p / (from_p + to_q);
  const double sum = weights[0] + weights[1] + weights[2];
  crossing.barycentric = sum > 0 ? Vector3d(Vector3d(weights[0], weights[1], weights[2]) / sum)
                                 : Vector3d(Vector3d::Constant(1.0 / 3));
  return crossing;
}

}  // namespace polyscalpel
