// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/piece_tracker.hpp"

#include <map>
#include <random>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::Vector3i;

/// Equal to a search of the whole mesh but for the numbers, which are kept by the rule.
void expectTracked(const PolyhedralMesh& mesh, const PieceTracker& tracker, const Pieces& before,
                   const MeshChange& change) {
  const Pieces expected = findPieces(mesh);
  const Pieces& found = tracker.pieces();
  ASSERT_EQ(found.count, expected.count);
  ASSERT_EQ(found.piece_of_cell.size(), expected.piece_of_cell.size());
  std::map<int, int> number_of;  // expected -> found
  std::map<int, int> num_cells, first_cell;
  for (int i = 0; i < mesh.cellCapacity(); ++i) {
    const int number = found.piece_of_cell[i];
    if (expected.piece_of_cell[i] < 0) {
      EXPECT_EQ(number, -1);
      continue;
    }
    ASSERT_EQ(number_of.emplace(expected.piece_of_cell[i], number).first->second, number);
    if (num_cells[number]++ == 0) first_cell[number] = i;
  }
  ASSERT_EQ(static_cast<int>(num_cells.size()), found.count) << "one number for two pieces";

  std::map<CellId, CellId> parents;
  for (const NewCell& cell : change.new_cells) parents[cell.cell] = cell.parent;
  std::map<int, std::vector<int>> parts;  // of each piece that was
  for (const auto& [number, cell] : first_cell) {
    const auto parent = parents.find(CellId(cell));
    parts[before.piece_of_cell[parent == parents.end() ? cell : parent->second.index()]].push_back(number);
    EXPECT_EQ(tracker.numCells(number), num_cells[number]);
  }
  int next = before.count;
  for (const auto& [piece, numbers] : parts) {
    EXPECT_EQ(numbers.front(), piece) << "one part keeps the number";
    for (std::size_t i = 1; i < numbers.size(); ++i) {
      EXPECT_EQ(numbers[i], next++);
      EXPECT_GE(num_cells[piece], num_cells[numbers[i]]);
      if (num_cells[piece] == num_cells[numbers[i]]) {
        EXPECT_LT(first_cell[piece], first_cell[numbers[i]]);
      }
      if (i > 1) {
        EXPECT_LT(first_cell[numbers[i - 1]], first_cell[numbers[i]]);
      }
    }
  }
}

TEST(PieceTracker, FollowsRandomPlanes) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto somewhere = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  PolyhedralMesh mesh = makeTetBall(Vector3d::Zero(), 1, 3);
  PieceTracker tracker(mesh);
  for (int i = 0; i < 12; ++i) {
    const Matrix3Xd positions = mesh.restPositions();
    const Pieces before = tracker.pieces();
    const CutResult result = cutMesh(mesh, positions, PlaneCut{0.6 * somewhere(), somewhere()}, {}, i + 1);
    tracker.update(mesh, result.change);
    expectTracked(mesh, tracker, before, result.change);
  }
  EXPECT_GT(tracker.count(), 20);
}

TEST(PieceTracker, FollowsEqualHalves) {
  // Parts of equal size: the one with the smallest cell id keeps the number.
  PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d::Constant(4), Vector3i::Constant(4));
  PieceTracker tracker(mesh);
  int number = 0;
  for (const int axis : {0, 1, 2}) {
    for (const double at : {2.0, 1.0, 3.0, 0.5}) {
      const Matrix3Xd positions = mesh.restPositions();
      const Pieces before = tracker.pieces();
      const CutResult result =
          cutMesh(mesh, positions, PlaneCut{Vector3d::Constant(at), Vector3d::Unit(axis)}, {}, ++number);
      tracker.update(mesh, result.change);
      expectTracked(mesh, tracker, before, result.change);
    }
  }
  EXPECT_EQ(tracker.count(), 125);
}

TEST(PieceTracker, FollowsCutsThatDivideNothing) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto somewhere = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  PolyhedralMesh mesh = makeTetBall(Vector3d::Zero(), 1, 3);
  PieceTracker tracker(mesh);
  for (int i = 0; i < 40; ++i) {
    const Vector3d centre = somewhere(), u = 0.5 * somewhere(), v = u.cross(somewhere());
    PolygonCut polygon;
    polygon.corners_world.resize(3, 4);
    polygon.corners_world << centre - u - v, centre + u - v, centre + u + v, centre - u + v;
    const Matrix3Xd positions = mesh.restPositions();
    const Pieces before = tracker.pieces();
    const CutResult result = cutMesh(mesh, positions, polygon, {}, i + 1);
    tracker.update(mesh, result.change);
    expectTracked(mesh, tracker, before, result.change);
  }
}

TEST(PieceTracker, ARemovedPieceLeavesItsNumberToTheLastOne) {
  PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d::Constant(3), Vector3i::Constant(3));
  PieceTracker tracker(mesh);
  for (int i = 1; i <= 2; ++i) {
    const Matrix3Xd positions = mesh.restPositions();
    tracker.update(
        mesh, cutMesh(mesh, positions, PlaneCut{Vector3d::Constant(i), Vector3d::UnitX()}, {}, i).change);
  }
  ASSERT_EQ(tracker.count(), 3);
  // The tracker reads what is removed from the change alone.
  MeshChange removal;
  std::vector<CellId> last;
  for (const CellId cell : mesh.cells()) {
    const int piece = tracker.pieces().piece_of_cell[cell.index()];
    if (piece == 1) removal.removed_cells.push_back(cell);
    if (piece == 2) last.push_back(cell);
  }
  tracker.update(mesh, removal);
  EXPECT_EQ(tracker.count(), 2);
  EXPECT_EQ(tracker.numCells(1), 9);
  for (const CellId cell : last) EXPECT_EQ(tracker.pieces().piece_of_cell[cell.index()], 1);
  for (const CellId cell : removal.removed_cells) EXPECT_EQ(tracker.pieces().piece_of_cell[cell.index()], -1);
}

}  // namespace
}  // namespace polyscalpel
