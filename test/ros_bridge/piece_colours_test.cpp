// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/piece_colours.hpp"

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

constexpr double kAlpha = 0.5;
const Eigen::Vector4d kPlain(1, 0, 0, kAlpha);

TEST(PieceColours, NeighboursInTheRowDiffer) {
  for (int piece = 1; piece < 20; ++piece) {
    EXPECT_GT((pieceColour(piece) - pieceColour(piece + 1)).norm(), 0.3) << piece;
    EXPECT_TRUE((pieceColour(piece).array() >= 0).all() && (pieceColour(piece).array() <= 1).all());
  }
}

TEST(PieceColours, TheFirstPieceKeepsItsColoursTheOthersHaveTheirOwn) {
  PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {3, 3, 3}, {3, 3, 3});
  const Eigen::Matrix3Xd positions = mesh.restPositions();
  ASSERT_EQ(cutMesh(mesh, positions, PlaneCut{{1.4, 0, 0}, {1, 0, 0}}, CuttingConfig(), 1).status,
            CutStatus::kCut);
  const Pieces pieces = findPieces(mesh);
  ASSERT_EQ(pieces.count, 2);
  for (const bool cut_faces : {false, true}) {
    const SurfaceTriangles triangles = makeSurfaceTriangles(mesh, mesh.restPositions(), cut_faces);
    const visualization_msgs::Marker plain = makeTriangleMarker(triangles, kPlain);
    visualization_msgs::Marker marker = plain;
    colourByPieces(marker, mesh, triangles, pieces);
    ASSERT_EQ(marker.colors.size(), plain.colors.size());
    int coloured = 0;
    for (std::size_t i = 0; i < marker.colors.size(); ++i) {
      const Face& face = mesh.face(triangles.origins[i / 3].face);
      const bool is_first = pieces.piece_of_cell[static_cast<std::size_t>(face.cells[0].index())] == 0;
      EXPECT_EQ(marker.colors[i] == plain.colors[i], is_first);
      EXPECT_EQ(marker.colors[i].a, static_cast<float>(kAlpha));
      coloured += !is_first;
    }
    EXPECT_GT(coloured, 0);
    EXPECT_LT(coloured, static_cast<int>(marker.colors.size()));
  }
}

}  // namespace
}  // namespace polyscalpel
