// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/piece_colours.hpp"

#include <algorithm>
#include <array>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/ros_bridge/geometry_conversions.hpp"

namespace polyscalpel {
namespace {

constexpr std::size_t kNumColours = 8;
const std::array<Eigen::Vector3d, kNumColours> kColours = {
    Eigen::Vector3d(0.20, 0.55, 0.80), Eigen::Vector3d(0.93, 0.72, 0.20), Eigen::Vector3d(0.16, 0.52, 0.36),
    Eigen::Vector3d(0.85, 0.52, 0.74), Eigen::Vector3d(0.36, 0.30, 0.62), Eigen::Vector3d(0.62, 0.80, 0.36),
    Eigen::Vector3d(0.80, 0.38, 0.12), Eigen::Vector3d(0.52, 0.82, 0.86)};
/// Part of white in the colour of a cut face.
constexpr double kPaleness = 0.4;

}  // namespace

Eigen::Vector3d pieceColour(int piece) {
  POLYSCALPEL_ASSERT(piece >= 1);
  return kColours[static_cast<std::size_t>(piece - 1) % kNumColours];
}

void colourByPieces(visualization_msgs::Marker& marker, const PolyhedralMesh& mesh,
                    const SurfaceTriangles& triangles, const Pieces& pieces) {
  POLYSCALPEL_ASSERT(marker.colors.size() == 3 * triangles.origins.size());
  const double alpha = marker.color.a;
  for (std::size_t i = 0; i < triangles.origins.size(); ++i) {
    const Face& face = mesh.face(triangles.origins[i].face);
    const int piece = pieces.piece_of_cell[static_cast<std::size_t>(face.cells[0].index())];
    if (piece == 0) continue;
    Eigen::Vector3d colour = pieceColour(piece);
    if (face.cut > 0) colour += kPaleness * (Eigen::Vector3d::Ones() - colour);
    for (int corner = 0; corner < 3; ++corner) {
      Eigen::Vector4d rgba;
      rgba << (colour * (1.3 * lightOn(triangles.normals[i].col(corner)))).cwiseMin(1.0), alpha;
      marker.colors[3 * i + static_cast<std::size_t>(corner)] = toColourMsg(rgba);
    }
  }
}

}  // namespace polyscalpel
