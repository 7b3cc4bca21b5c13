// SPDX-License-Identifier: BSD-3-Clause
//
// Cells of every shape that earlier cuts leave are split by what passes them.
#include "polyscalpel/cutting/split_cells.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "support/torture.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Vertex at a point, which must be there.
VertexId vertexAt(const PolyhedralMesh& mesh, const Vector3d& point) {
  for (int i = 0; i < mesh.numVertices(); ++i) {
    if (mesh.restPosition(VertexId(i)) == point) return VertexId(i);
  }
  throw std::logic_error("no vertex there");
}

using Ends = std::pair<Vector3d, Vector3d>;

/// Gives two edges of a face a vertex in their middle, and the face a chord from one to the other, as a cut
/// through a neighbour leaves them.
void chordBetweenMiddles(PolyhedralMesh& mesh, const Ends& first, const Ends& second) {
  MeshEditor editor(mesh);
  const VertexId from = editor.splitEdge(vertexAt(mesh, first.first), vertexAt(mesh, first.second), 0.5);
  const VertexId to = editor.splitEdge(vertexAt(mesh, second.first), vertexAt(mesh, second.second), 0.5);
  for (const FaceId id : std::vector<FaceId>(mesh.facesAround(from))) {
    const auto& around = mesh.facesAround(to);
    if (std::find(around.begin(), around.end(), id) != around.end()) editor.splitFace(id, from, to);
  }
  editor.commit();
}

TEST(SplitCells, AVertexBetweenTwoCornersOfTheCutInOneEdgeJoinsIt) {
  // A cube with a vertex in its edge along z and a chord from there, as a cut through a neighbour leaves
  // them. A plane that passes the edge within the snap distance crosses other edges at the edge's ends, and
  // none at that vertex.
  for (const double off : {0.001, 0.02, 0.04}) {
    PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d::Ones(), {1, 1, 1});
    chordBetweenMiddles(mesh, {{0, 0, 0}, {0, 0, 1}}, {{1, 0, 0}, {1, 0, 1}});
    ASSERT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();

    const Matrix3Xd positions = mesh.restPositions();
    const PlaneCut plane{Vector3d(0, off, 0), Vector3d(1, -1, 0)};
    const CutResult result = cutMesh(mesh, positions, plane, CuttingConfig(), 1);
    EXPECT_EQ(result.cells_left_whole, 0) << off;
    EXPECT_EQ(result.pieces_after, 2) << off;
    EXPECT_TRUE(checkMesh(mesh).empty()) << off;
  }
}

TEST(SplitCells, AFaceWithVerticesInAStraightSideOpensAlongIt) {
  // A plane goes along the face between two cubes, so near that all its corners are snapped. The vertices in
  // one of its sides have no edge but along the face and away from the plane: nothing of them is crossed.
  PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d(1, 1, 2), {1, 1, 2});
  chordBetweenMiddles(mesh, {{0, 0, 1}, {0, 1, 1}}, {{0, 0, 2}, {0, 1, 2}});
  chordBetweenMiddles(mesh, {{0, 0.5, 1}, {0, 1, 1}}, {{0, 0.5, 2}, {0, 1, 2}});
  ASSERT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();

  const Matrix3Xd positions = mesh.restPositions();
  const PlaneCut plane{Vector3d(0, 0, 1 - 1e-12), Vector3d::UnitZ()};
  const CutResult result = cutMesh(mesh, positions, plane, CuttingConfig(), 1);
  EXPECT_EQ(result.cells_split, 0);
  EXPECT_EQ(result.pieces_after, 2);
  EXPECT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();
}

TEST(SplitCells, AnEdgeThatIsShutBetweenTwoWallsIsDividedForEachOfThem) {
  // A slit within the middle layer of a block has one edge inside, with two cells on either side and its ends
  // on the slit's front.
  PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d(2, 2, 3), {2, 2, 3});
  const VertexId a = vertexAt(mesh, {1, 1, 1}), b = vertexAt(mesh, {1, 1, 2});
  MeshEditor editor(mesh);
  for (const FaceId id : std::vector<FaceId>(mesh.facesAround(a))) {
    const Face& face = mesh.face(id);
    if (!hasEdge(face, a, b)) continue;
    const bool is_in_slit = std::all_of(face.loop.begin(), face.loop.end(),
                                        [&](VertexId v) { return mesh.restPosition(v).x() == 1; });
    if (is_in_slit) editor.openFace(id, 1);
  }
  editor.commit();
  ASSERT_EQ(numFansAroundEdge(mesh, a, b), 2);
  ASSERT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();

  const Matrix3Xd positions = mesh.restPositions();
  const PlaneCut across{Vector3d(0, 0, 1.5), Vector3d::UnitZ()};
  const CutResult result = cutMesh(mesh, positions, across, CuttingConfig(), 2);
  EXPECT_EQ(result.cells_left_whole, 0);
  EXPECT_EQ(result.cells_split, 4);
  EXPECT_EQ(result.pieces_after, 2);
  EXPECT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();
  const auto isInMiddle = [&](const NewVertex& made) {
    return mesh.restPosition(made.vertex) == Vector3d(1, 1, 1.5);
  };
  const auto& made = result.change.new_vertices;
  EXPECT_EQ(std::count_if(made.begin(), made.end(), isInMiddle), 4) << "one for each corner of the pieces";
}

TEST(SplitCells, AStrokeThatCrossesAnEdgeTwiceBitesNothingOffIt) {
  // A cube with a vertex in an edge. The blade goes in through the edge on one side of the vertex and out
  // again on the other one: all that it leaves of the cell between is that edge.
  PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d::Ones(), {1, 1, 1});
  MeshEditor editor(mesh);
  editor.splitEdge(vertexAt(mesh, {0, 0, 0}), vertexAt(mesh, {0, 0, 1}), 0.5);
  editor.commit();
  SweepCut sweep;
  sweep.edge_tool.resize(3, 2);
  sweep.edge_tool << -2, 2, 2, -2, 0, 0;
  for (int i = -8; i <= 8; ++i) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    const double depth = 0.2 - 0.7 * std::abs(i) / 8;
    T.translation() = Vector3d(depth, depth, 0.5 + 0.15 * i);
    sweep.T_world_tool.push_back(T);
  }
  const Matrix3Xd positions = mesh.restPositions();
  const CutResult result = cutMesh(mesh, positions, sweep, CuttingConfig(), 1);
  EXPECT_EQ(result.status, CutStatus::kNothingSeparated);
  EXPECT_EQ(result.cells_left_whole, 0);
}

TEST(SplitCells, ASmallPartOfGoodShapeComesOff) {
  // Three planes at right angles cut a cube of 0.002 h off a corner: its sub-tets have 3e-10 h^3.
  PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d::Ones(), {1, 1, 1});
  CuttingConfig config;
  config.snap_tolerance = 1e-6;
  for (int axis = 0; axis < 3; ++axis) {
    const Matrix3Xd positions = mesh.restPositions();
    const PlaneCut plane{Vector3d::Constant(0.002), Vector3d::Unit(axis)};
    const CutResult result = cutMesh(mesh, positions, plane, config, axis + 1);
    EXPECT_EQ(result.cells_left_whole, 0) << axis;
    EXPECT_EQ(result.pieces_after, 2 << axis);
    EXPECT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();
  }
}

TEST(SplitCells, WhatRandomCutsPassComesApart) {
  // Bodies in which caps had facets in the plane of a part's own faces, in which parts up to twice as thick
  // as the snap distance joined the cut although a division would have had them come apart, in which no plane
  // across the border but an askew one divides a cell soundly, and in which a vertex between two corners of
  // the cut, or at the end of a chord that a division has made, was taken to lie on the wrong side.
  struct Body {
    std::string name;
    unsigned seed;
    int cuts;
  };
  for (const Body& body : std::vector<Body>{{"block", 3, 25},
                                            {"block", 13, 25},
                                            {"block", 31, 17},
                                            {"block", 37, 18},
                                            {"ball", 6, 17},
                                            {"block", 6, 13},
                                            {"block", 11, 22},
                                            {"block", 21, 19},
                                            {"block", 41, 17},
                                            {"block", 236, 9},
                                            {"block", 308, 5}}) {
    std::vector<TortureFailure> failures;
    for (const TortureRow& row : torture(TortureSize::kSmall, body.name, body.seed, body.cuts, failures)) {
      EXPECT_EQ(row.left_whole, 0) << body.name << ", seed " << body.seed << ": " << row.kind;
      EXPECT_EQ(row.pieces_missing, 0) << body.name << ", seed " << body.seed << ": " << row.kind;
      EXPECT_EQ(row.invalid, 0) << body.name << ", seed " << body.seed << ": " << row.kind;
    }
  }
}

}  // namespace
}  // namespace polyscalpel
