// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

using CellLoops = PolyhedralMesh::CellLoops;

/// Outward faces of the tetrahedron with (b - a) . ((c - a) x (d - a)) > 0.
CellLoops tet(int a, int b, int c, int d) {
  return {{a, c, b}, {a, b, d}, {b, c, d}, {a, d, c}};
}

/// Origin, unit vectors, their sum (4), and a second set further along x (5 to 8).
Eigen::Matrix3Xd makePoints() {
  Eigen::Matrix3Xd points(3, 9);
  points << 0, 1, 0, 0, 1, 2, 3, 2, 2,  //
      0, 0, 1, 0, 1, 0, 0, 1, 0,        //
      0, 0, 0, 1, 1, 0, 0, 0, 1;
  return points;
}

std::string refusal(const Eigen::Matrix3Xd& points, const std::vector<CellLoops>& cells,
                    const std::vector<int>& regions = {}) {
  try {
    PolyhedralMesh(points, cells, regions);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  ADD_FAILURE() << "accepted";
  return {};
}

TEST(PolyhedralMesh, JoinsFacesOfNeighbours) {
  const PolyhedralMesh mesh(makePoints().leftCols(5), {tet(0, 1, 2, 3), tet(1, 4, 2, 3)}, {7, 9});
  EXPECT_EQ(mesh.numVertices(), 5);
  EXPECT_EQ(mesh.numCells(), 2);
  EXPECT_EQ(mesh.faceCapacity(), 7);
  EXPECT_EQ(mesh.cell(CellId(0)).region, 7);
  EXPECT_EQ(mesh.cell(CellId(1)).region, 9);
  int num_shared = 0;
  for (int f = 0; f < mesh.faceCapacity(); ++f) {
    const Face& face = mesh.face(FaceId(f));
    EXPECT_EQ(std::vector<char>(face.is_corner.begin(), face.is_corner.end()), std::vector<char>(3, 1));
    EXPECT_EQ(face.cut, 0);
    if (face.isBoundary()) {
      EXPECT_FALSE(mesh.neighbour(FaceId(f), face.cells[0]).isValid());
      continue;
    }
    ++num_shared;
    EXPECT_EQ(mesh.neighbour(FaceId(f), CellId(0)), CellId(1));
    EXPECT_EQ(mesh.neighbour(FaceId(f), CellId(1)), CellId(0));
  }
  EXPECT_EQ(num_shared, 1);
  EXPECT_EQ(findPieces(mesh).count, 1);
  EXPECT_EQ(checkMesh(mesh), std::vector<std::string>());
}

TEST(PolyhedralMesh, KeepsTheOrderOfPoints) {
  const PolyhedralMesh mesh(makePoints().leftCols(5), {tet(1, 4, 2, 3), tet(0, 1, 2, 3)});
  EXPECT_EQ(mesh.restPositions(), makePoints().leftCols(5));
  const std::vector<VertexId> vertices = {VertexId(1), VertexId(2), VertexId(3), VertexId(4)};
  EXPECT_EQ(mesh.cell(CellId(0)).vertices, vertices);
}

TEST(PolyhedralMesh, DropsUnusedPointsKeepingTheOrder) {
  const PolyhedralMesh mesh(makePoints(), {tet(5, 6, 7, 8)});
  ASSERT_EQ(mesh.numVertices(), 4);
  EXPECT_EQ(mesh.restPositions(), makePoints().rightCols(4));
  EXPECT_EQ(checkMesh(mesh), std::vector<std::string>());
}

TEST(PolyhedralMesh, CopiesAVertexThatAloneJoinsTwoBodies) {
  const PolyhedralMesh mesh(makePoints(), {tet(0, 1, 2, 3), tet(1, 6, 7, 8)});
  ASSERT_EQ(mesh.numVertices(), 8);
  // Point 1 stays with the first cell; its copy comes last. Points 4 and 5 are unused.
  EXPECT_EQ(mesh.restPosition(VertexId(1)), mesh.restPosition(VertexId(7)));
  EXPECT_EQ(mesh.cell(CellId(0)).vertices.back(), VertexId(3));
  EXPECT_EQ(mesh.cell(CellId(1)).vertices.back(), VertexId(7));
  EXPECT_EQ(findPieces(mesh).count, 2);
  EXPECT_EQ(checkMesh(mesh), std::vector<std::string>());
}

TEST(PolyhedralMesh, CopiesAnEdgeThatAloneJoinsTwoBodies) {
  Eigen::Matrix3Xd points(3, 6);
  points << 0, 1, 0, 0, -1, 0,  //
      0, 0, 1, 0, 0, -1,        //
      0, 0, 0, 1, 0, 0;
  // Both hold the edge (0, 3) and nothing else in common.
  const PolyhedralMesh mesh(points, {tet(0, 1, 2, 3), tet(0, 4, 5, 3)});
  EXPECT_EQ(mesh.numVertices(), 8);
  EXPECT_EQ(findPieces(mesh).count, 2);
  EXPECT_EQ(checkMesh(mesh), std::vector<std::string>());
}

TEST(PolyhedralMesh, LocalSizeIsTheShortestEdgeAround) {
  const PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {3, 2, 1}, {1, 1, 4});
  for (int v = 0; v < mesh.numVertices(); ++v) EXPECT_DOUBLE_EQ(mesh.localSize(VertexId(v)), 0.25);
  const PolyhedralMesh pair(makePoints().leftCols(5), {tet(0, 1, 2, 3), tet(1, 4, 2, 3)});
  EXPECT_EQ(pair.localSize(VertexId(0)), 1);
  EXPECT_EQ(pair.localSize(VertexId(4)), std::sqrt(2.0));
}

TEST(PolyhedralMesh, ListsTheFacesAroundAVertexAndTheEdgesOfACell) {
  const PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {2, 2, 2}, {2, 2, 2});
  EXPECT_EQ(mesh.facesAround(VertexId(13)).size(), 12u) << "the vertex in the middle";
  EXPECT_EQ(mesh.facesAround(VertexId(0)).size(), 3u);
  for (const CellId cell : mesh.cells()) {
    const auto edges = mesh.edges(cell);
    EXPECT_EQ(edges.size(), 12u);
    EXPECT_TRUE(std::is_sorted(edges.begin(), edges.end()));
    for (const auto& [a, b] : edges) {
      EXPECT_LT(a, b);
      EXPECT_DOUBLE_EQ((mesh.restPosition(a) - mesh.restPosition(b)).norm(), 1);
    }
  }
}

TEST(PolyhedralMesh, AnEmptyMeshIsValid) {
  const PolyhedralMesh mesh;
  EXPECT_EQ(mesh.numVertices(), 0);
  EXPECT_EQ(mesh.restPositions().cols(), 0);
  EXPECT_EQ(findPieces(mesh).count, 0);
  EXPECT_TRUE(mesh.cells().empty());
  EXPECT_EQ(checkMesh(mesh), std::vector<std::string>());
  EXPECT_EQ(PolyhedralMesh(makePoints(), {}).numVertices(), 0);
}

TEST(PolyhedralMesh, PiecesAreNumberedByTheirSmallestCell) {
  Eigen::Matrix3Xd points(3, 13);
  points << makePoints(), makePoints().rightCols(4).colwise() + Eigen::Vector3d(9, 0, 0);
  const Pieces pieces = findPieces(
      PolyhedralMesh(points, {tet(5, 6, 7, 8), tet(0, 1, 2, 3), tet(9, 10, 11, 12), tet(1, 4, 2, 3)}));
  EXPECT_EQ(pieces.count, 3);
  EXPECT_EQ(pieces.piece_of_cell, (std::vector<int>{0, 1, 2, 1}));
}

TEST(PolyhedralMesh, RefusesBadInputNamingTheCell) {
  const Eigen::Matrix3Xd points = makePoints();
  EXPECT_EQ(refusal(points, {tet(0, 1, 2, 3), tet(0, 1, 2, 9)}), "cell 1: point index 9: must be in [0, 8]");
  EXPECT_EQ(refusal(points, {tet(-1, 1, 2, 3)}), "cell 0: point index -1: must be in [0, 8]");
  EXPECT_EQ(refusal(points, {{}}), "cell 0: 0 faces: a closed cell has at least 4");
  CellLoops open = tet(0, 1, 2, 3);
  open[3] = {0, 3, 4};
  EXPECT_NE(refusal(points, {open}).find("cell 0: open at edge"), std::string::npos);
  CellLoops turned = tet(0, 1, 2, 3);
  std::reverse(turned[2].begin(), turned[2].end());
  EXPECT_NE(refusal(points, {turned}).find("twice in the same direction"), std::string::npos);
  CellLoops line = tet(0, 1, 2, 3);
  line[0] = {0, 1};
  EXPECT_NE(refusal(points, {line}).find("fewer than 3"), std::string::npos);
  EXPECT_NE(refusal(points, {tet(0, 0, 2, 3)}).find("twice"), std::string::npos);
  EXPECT_EQ(refusal(points, {tet(0, 2, 1, 3)}), "cell 0: volume -0.166667 m^3: must be > 0");
  EXPECT_NE(refusal(points, {tet(0, 1, 2, 6)}).find("volume 0 m^3: must be > 0"), std::string::npos);
  // Two whole tetrahedra as one cell.
  CellLoops both = tet(0, 1, 2, 3);
  for (const auto& loop : tet(5, 6, 7, 8)) both.push_back(loop);
  EXPECT_NE(refusal(points, {both}).find("do not form one closed polyhedron"), std::string::npos);
  EXPECT_NE(refusal(points, {tet(0, 1, 2, 3), tet(0, 1, 2, 3)}).find("is not the reverse"),
            std::string::npos);
  EXPECT_NE(refusal(points, {tet(0, 1, 2, 3), tet(1, 4, 2, 3), tet(1, 6, 2, 3)})
                .find("belongs already to cells 0 and 1"),
            std::string::npos);
  EXPECT_NE(refusal(points, {tet(0, 1, 2, 3)}, {1, 2}).find("regions: 2 numbers for 1 cells"),
            std::string::npos);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInfinity}) {
    Eigen::Matrix3Xd broken = points;
    broken(1, 8) = bad;
    EXPECT_NE(refusal(broken, {tet(0, 1, 2, 3)}).find("point 8"), std::string::npos);
  }
}

}  // namespace
}  // namespace polyscalpel
