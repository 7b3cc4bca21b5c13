// SPDX-License-Identifier: BSD-3-Clause
//
// Closest points of points, segments and triangles in closed form, by the Voronoi regions of the features (C.
// Ericson, "Real-Time Collision Detection", 2005, sections 5.1.5 and 5.1.9). Degenerate segments and
// triangles are allowed: the result is a closest point on what is left of them, never NaN.
#pragma once

#include <Eigen/Core>

namespace polyscalpel {

/// A point on a triangle and how far it is from the query.
struct TrianglePoint {
  Eigen::Vector3d point;
  Eigen::Vector3d
      barycentric;  ///< >= 0, sum 1; exactly 0 for the corners that the closest feature does not have
  double squared_distance = 0;
};

/// The point of a triangle (corners: one column each) that is closest to `point`.
TrianglePoint closestPointOnTriangle(const Eigen::Vector3d& point, const Eigen::Matrix3d& corners);

/// Closest points of two segments or of a segment and a triangle.
struct ClosestPoints {
  Eigen::Vector3d first;   ///< on the first argument
  Eigen::Vector3d second;  ///< on the second argument
  double squared_distance = 0;
};

/// Closest points of the segments (a_0, a_1) and (b_0, b_1).
ClosestPoints closestPointsOfSegments(const Eigen::Vector3d& a_0, const Eigen::Vector3d& a_1,
                                      const Eigen::Vector3d& b_0, const Eigen::Vector3d& b_1);

/// Closest points of the segment (a, b) and a triangle (corners: one column each); squared_distance is 0 and
/// both points are the same where the segment passes through the triangle.
ClosestPoints closestPointsOfSegmentAndTriangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                                const Eigen::Matrix3d& corners);

/// Barycentric coordinates of the projection of `point` on the triangle's plane; sum 1. The triangle must
/// have area.
Eigen::Vector3d barycentricCoordinates(const Eigen::Vector3d& point, const Eigen::Matrix3d& corners);

/// Area vector of a triangle: its length is the area, its direction the normal by the right-hand rule.
Eigen::Vector3d triangleAreaVector(const Eigen::Matrix3d& corners);

}  // namespace polyscalpel
