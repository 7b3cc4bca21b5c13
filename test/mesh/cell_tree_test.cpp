// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/cell_tree.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

AlignedBox3d boxOf(const PolyhedralMesh& mesh, CellId cell, const Matrix3Xd& positions) {
  AlignedBox3d box;
  for (const VertexId v : mesh.cell(cell).vertices) box.extend(positions.col(v.index()));
  return box;
}

AlignedBox3d boxAround(const Vector3d& centre, double half) {
  return {centre - Vector3d::Constant(half), centre + Vector3d::Constant(half)};
}

std::set<CellId> visited(const CellTree& tree, const PolyhedralMesh& mesh, const AlignedBox3d& box) {
  std::set<CellId> cells;
  tree.visit(
      mesh, [&](const CellTree::Bound& bound) { return bound.box.intersects(box); },
      [&](CellId cell) {
        EXPECT_TRUE(mesh.cell(cell).isAlive());
        EXPECT_TRUE(cells.insert(cell).second) << "visited twice";
        return true;
      });
  return cells;
}

/// Every cell that meets the box is visited, and of all others few.
void expectFound(const CellTree& tree, const PolyhedralMesh& mesh, const Matrix3Xd& positions,
                 const AlignedBox3d& box) {
  const std::set<CellId> found = visited(tree, mesh, box);
  for (const CellId cell : mesh.cells()) {
    if (boxOf(mesh, cell, positions).intersects(box)) {
      EXPECT_EQ(found.count(cell), 1u) << cell.index();
    }
  }
  EXPECT_LT(found.size(), 0.2 * mesh.numCells());
}

TEST(CellTree, AnEmptyTreeVisitsEveryCellUntilItIsToldToStop) {
  const PolyhedralMesh mesh = makeTetBall(Vector3d::Zero(), 1, 2);
  EXPECT_EQ(static_cast<int>(visited({}, mesh, boxAround(Vector3d::Constant(9), 1)).size()), mesh.numCells());
  int count = 0;
  CellTree().visit(
      mesh, [](const CellTree::Bound&) { return true; }, [&](CellId) { return ++count < 3; });
  EXPECT_EQ(count, 3);
}

TEST(CellTree, FindsTheCellsOfABodyThatMovesAndIsCut) {
  PolyhedralMesh mesh = makeTetBall(Vector3d::Zero(), 1, 4);
  Matrix3Xd positions = mesh.restPositions();
  CellTree tree;
  tree.fit(mesh, positions);
  for (int i = 0; i < 40; ++i) {
    // Small motions that the boxes outlast, and now and then one that they do not.
    const Vector3d way = (i % 10 == 9 ? 0.7 : 0.01) * Vector3d(1, 0.3, -0.2);
    positions.colwise() += way;
    tree.fit(mesh, positions);
    const Vector3d centre = positions.rowwise().mean();
    PolygonCut cut;
    const Vector3d u = 0.3 * Vector3d(std::cos(i), std::sin(i), 0), v(0, 0, 0.3);
    cut.corners_world.resize(3, 4);
    cut.corners_world << centre - u - v, centre + u - v, centre + u + v, centre - u + v;
    const CutResult result = cutMesh(mesh, positions, cut, {}, i + 1);
    extendByNewVertices(result.change.new_vertices, positions);
    tree.update(mesh, result.change);
    expectFound(tree, mesh, positions, boxAround(centre + 0.5 * Vector3d::UnitZ(), 0.1));
    expectFound(tree, mesh, positions, boxAround(centre + 0.4 * Vector3d::UnitX(), 0.05));
    EXPECT_EQ(static_cast<int>(visited(tree, mesh, boxAround(centre, 10)).size()), mesh.numCells());
  }
}

TEST(CellTree, HoldsForEverythingBetweenTwoPositions) {
  const PolyhedralMesh mesh = makeTetBall(Vector3d::Zero(), 1, 3);
  const Matrix3Xd start = mesh.restPositions();
  const Matrix3Xd end = start.colwise() + Vector3d(0.4, 0, 0);
  CellTree tree;
  tree.fit(mesh, start, end, boxAround(Vector3d::Zero(), 1));
  for (const double s : {0.0, 0.3, 1.0}) {
    const Matrix3Xd between = (1 - s) * start + s * end;
    const AlignedBox3d box = boxAround(Vector3d(1.1, 0, 0), 0.05);
    const std::set<CellId> found = visited(tree, mesh, box);
    for (const CellId cell : mesh.cells()) {
      if (boxOf(mesh, cell, between).intersects(box)) {
        EXPECT_EQ(found.count(cell), 1u);
      }
    }
  }
}

TEST(CellTree, ABodyClearOfTheRegionIsNotFittedYetNothingIsMissed) {
  const PolyhedralMesh mesh = makeTetBall(Vector3d::Zero(), 1, 3);
  Matrix3Xd positions = mesh.restPositions();
  CellTree tree;
  tree.fit(mesh, positions);
  positions.colwise() += Vector3d(1, 0, 0);
  tree.fit(mesh, positions, positions, boxAround(Vector3d(0, 9, 0), 1));
  // Far from the region, still every cell there is found, though by boxes that are wide.
  const std::set<CellId> wide = visited(tree, mesh, boxAround(Vector3d(1.9, 0, 0), 0.05));
  tree.fit(mesh, positions, positions, boxAround(Vector3d(2, 0, 0), 1));
  const std::set<CellId> fitted = visited(tree, mesh, boxAround(Vector3d(1.9, 0, 0), 0.05));
  EXPECT_FALSE(fitted.empty());
  EXPECT_LT(fitted.size(), wide.size());
  for (const CellId cell : fitted) EXPECT_EQ(wide.count(cell), 1u);
}

TEST(CellTree, TheSameCallsGiveTheSameOrder) {
  const auto run = [] {
    PolyhedralMesh mesh = makeTetBall(Vector3d::Zero(), 1, 3);
    const Matrix3Xd positions = mesh.restPositions();
    CellTree tree;
    tree.fit(mesh, positions);
    tree.update(mesh, cutMesh(mesh, positions, PlaneCut{}, {}, 1).change);
    std::vector<int> order;
    tree.visit(
        mesh, [](const CellTree::Bound&) { return true; },
        [&](CellId cell) {
          order.push_back(cell.index());
          return true;
        });
    return order;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace polyscalpel
