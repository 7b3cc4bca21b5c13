// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/collision/triangle_contact.hpp"

namespace polyscalpel {

/// A closed triangle surface with its signed distance. Immutable.
///
/// The sign comes from angle-weighted pseudo-normals (J. A. Baerentzen, H. Aanaes, "Signed Distance
/// Computation Using the Angle Weighted Pseudonormal", 2005), which is right for every closed surface that
/// does not pass through itself.
class ToolMesh {
 public:
  /// Reads .obj .off .ply .stl; scale: file units to metres. Throws std::invalid_argument naming file and
  /// reason: not readable, no triangles, a face that is no triangle, coordinates not finite, not closed,
  /// inside out.
  ToolMesh(const std::string& path, double scale);
  ~ToolMesh();

  /// 3 x 3k, three columns a triangle, outward [m].
  const Eigen::Matrix3Xd& triangles() const;

  /// Distance to the surface, negative inside [m]; `gradient` gets the unit outward direction.
  double signedDistance(const Eigen::Vector3d& point, Eigen::Vector3d& gradient) const;

  /// Appends the contacts of one triangle of the tissue: the triangle is halved until its parts are no longer
  /// than half the smallest extent of the tool's bounding box, three times at most, and each part near the
  /// tool is one contact, pushed the shortest way out at its centroid. Parts that would be pulled outward are
  /// dropped. Limits: details of the tool finer than an eighth of the tissue's triangles can slip through,
  /// and a tool thinner than its own depth in the tissue is lost: give such a tool as a box.
  void appendContacts(const Eigen::Matrix3d& corners, double margin,
                      std::vector<TriangleContact>& contacts) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace polyscalpel
