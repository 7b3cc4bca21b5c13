// SPDX-License-Identifier: BSD-3-Clause
//
// Colours that show a field on the tissue. The colour map runs from dark blue over purple, red and orange to
// pale yellow. Its six colours are our own choice; their lightness (L* of CIE 1976) grows in nearly equal
// steps, 17 32 48 64 81 96, so that order and distance of values are seen as such, in grey print too.
#pragma once

#include <string>

#include <visualization_msgs/Marker.h>
#include <Eigen/Core>

#include "polyscalpel/elements/stress_recovery.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/ros_bridge/parameters.hpp"
#include "polyscalpel/ros_bridge/tissue_markers.hpp"

namespace polyscalpel {

/// Red, green and blue in [0, 1] for a value in [0, 1], linear between the map's colours; values beyond take
/// the first or last one.
Eigen::Vector3d mapColour(double value);

/// The field at the mesh's vertices [Pa]; of the error, which is known by cell, the mean over the cells
/// around. colour_by: one that shows a field. field: of this mesh as it is.
Eigen::VectorXd vertexValues(const PolyhedralMesh& mesh, const StressField& field, ColourBy colour_by);

/// Values of the first and last colour [Pa]: as asked for, or where that is [0, 0] the smallest and largest
/// value.
Eigen::Vector2d colourRange(const Eigen::VectorXd& values, const Eigen::Vector2d& asked_pa);

/// "von Mises stress 12.5 to 3401 Pa"
std::string describeColours(ColourBy colour_by, const Eigen::Vector2d& range_pa);

/// Gives the corners of a marker made from these triangles of the mesh the colours of their values, a little
/// darker where less light falls. vertex_values: one a vertex; virtual vertices take the mean of their
/// corners.
void colourByValues(visualization_msgs::Marker& marker, const PolyhedralMesh& mesh,
                    const SurfaceTriangles& triangles, const Eigen::VectorXd& vertex_values,
                    const Eigen::Vector2d& range_pa);

}  // namespace polyscalpel
