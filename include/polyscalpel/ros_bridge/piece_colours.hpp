// SPDX-License-Identifier: BSD-3-Clause
//
// Colours that tell the pieces of a cut body from each other.
#pragma once

#include <visualization_msgs/Marker.h>
#include <Eigen/Core>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/ros_bridge/tissue_markers.hpp"

namespace polyscalpel {

/// Red, green and blue in [0, 1] for a piece by its number >= 1; eight colours in turns. They are our own
/// choice: neighbours in the row differ in hue and in lightness.
Eigen::Vector3d pieceColour(int piece);

/// Gives the corners of a marker made from these triangles of the mesh the colour of their piece, lit; cut
/// faces are paler. Piece 0, the largest part of what was one, keeps the marker's own colours.
void colourByPieces(visualization_msgs::Marker& marker, const PolyhedralMesh& mesh,
                    const SurfaceTriangles& triangles, const Pieces& pieces);

}  // namespace polyscalpel
