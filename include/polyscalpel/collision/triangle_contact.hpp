// SPDX-License-Identifier: BSD-3-Clause
//
// Contact of one triangle of the tissue's surface with a convex tool. The triangle's outside is where its
// corners go counter-clockwise; the tissue lies behind it. Everything in the shape's frame.
//
// Direction. Apart, tool and triangle are joined by their closest points. In overlap the direction is the
// shortest way out of the tool for the whole triangle, so a thin blade that presses with its edge pushes
// ahead, and one that lies in a slit pushes sideways. A surface can be pushed only towards its tissue:
// (a) The direction points inward, whatever the tool's shape: it stands.
// (b) In overlap it points outward (cosine to the outward normal above a half): the tool has sunk in by more
//     than half, or both ways out are equal, as on the flanks of a slit on the middle of a blade. The
//     triangle is pushed along its inward normal, unless more than nine tenths of the tool's extent along the
//     normal are inside already: then the tool pokes at the surface from within, and is no contact.
// (c) Everything else is no contact: a tool beneath the surface, the far side of the body, a surface that is
//     seen edge-on along the direction.
// So a tool that passes through a surface by more than its thickness in one step is lost to it, and a tool on
// edge that is thinner than its depth slips in where the triangles are so small, or their edges so placed,
// that the way out past their border is shorter than the way ahead: to hold it, the tissue's triangles must
// be several times longer than the depth.
//
// Area. The contact stands for the part of the triangle inside the tool (moved to overlap by a twentieth of
// the margin where it does not yet), as seen along the direction: never more than the tool's cross-section on
// a large triangle, and on small ones the sum is the touched surface, so that the force converges as the mesh
// is refined. The gap is the mean of the gap along the direction over that part. Round sections are polygons
// of 16 corners and equal area; a sphere's overlap with a large triangle is right to 2 % up to a depth of a
// quarter of its radius, to 10 % when it is half in.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/collision/convex_shape.hpp"

namespace polyscalpel {

/// How tool and triangle lie to each other.
struct TriangleGap {
  double gap = 0;          ///< distance [m]; in overlap minus the length of the way out along the normal
  Eigen::Vector3d normal;  ///< unit, from the tool to the triangle; in overlap the way out of the tool
};

/// Distance and direction between tool and triangle (corners: one column each), without regard to inside and
/// outside. Apart: exact to about 1e-12 of the sizes. In overlap the gap is that of a translation along the
/// normal which frees the triangle: the shortest for sphere, capsule and box; for the cylinder, whose rim is
/// searched from 16 places against each edge, nearly always the shortest, and never less. Nothing for a gap
/// of margin or more, or a triangle without area.
std::optional<TriangleGap> triangleGap(const ConvexShape& shape, const Eigen::Matrix3d& corners,
                                       double margin);

/// The same, by the rules (a) to (c) above: the direction in which the tool pushes the tissue.
std::optional<TriangleGap> pushOnTriangle(const ConvexShape& shape, const Eigen::Matrix3d& corners,
                                          double margin);

/// A part of a triangle in contact.
struct TriangleContact {
  Eigen::Vector3d barycentric;  ///< of the contact point, sum 1
  Eigen::Vector3d normal;       ///< unit, the direction in which the tool pushes the tissue
  double gap = 0;               ///< [m], mean over the part
  double area = 0;              ///< [m^2], as seen along the normal
};

/// Appends up to three contacts of the triangle, each with gap < margin: three so that the triangle cannot
/// tilt freely.
void appendContacts(const ConvexShape& shape, const Eigen::Matrix3d& corners, double margin,
                    std::vector<TriangleContact>& contacts);

}  // namespace polyscalpel
