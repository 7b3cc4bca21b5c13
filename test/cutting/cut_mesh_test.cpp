// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/cut_mesh.hpp"

#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::Vector3i;

PolyhedralMesh blocks() {
  return makeHexBox(Vector3d::Zero(), Vector3d::Constant(3), Vector3i::Constant(3));
}

PlaneCut plane(const Vector3d& point, const Vector3d& normal) {
  return {point, normal};
}

/// Cuts the rest shape and checks every invariant afterwards.
CutResult cutAndCheck(PolyhedralMesh& mesh, const CutOperation& operation, const CuttingConfig& config = {}) {
  static int number = 0;
  const double volume_before = volume(mesh, mesh.restPositions());
  const Matrix3Xd positions = mesh.restPositions();
  const CutResult result = cutMesh(mesh, positions, operation, config, ++number);
  const auto violations = checkMesh(mesh);
  EXPECT_TRUE(violations.empty()) << violations.size() << " violations, first: " << violations.front();
  EXPECT_NEAR(volume(mesh, mesh.restPositions()), volume_before, 1e-12 * volume_before);
  EXPECT_EQ(result.pieces_after, findPieces(mesh).count);
  return result;
}

TEST(CutMesh, TwentySevenHexahedraUnderThreeAxisPlanesGiveSixtyCellsAndSixPieces) {
  // Wicke, Botsch, Gross 2007 and their German summary: 27 -> 60.
  PolyhedralMesh mesh = blocks();
  cutAndCheck(mesh, plane({0.5, 0, 0}, Vector3d::UnitX()));
  cutAndCheck(mesh, plane({1.5, 0, 0}, Vector3d::UnitX()));
  const CutResult last = cutAndCheck(mesh, plane({0, 1.5, 0}, Vector3d::UnitY()));
  EXPECT_EQ(mesh.numCells(), 60);
  EXPECT_EQ(last.pieces_after, 6);
  EXPECT_EQ(last.cells_left_whole, 0);
}

TEST(CutMesh, TwentySevenHexahedraUnderAStraightAndADiagonalPlaneGiveSixtyCellsAndFourPieces) {
  PolyhedralMesh mesh = blocks();
  cutAndCheck(mesh, plane({1.5, 0, 0}, Vector3d::UnitX()));
  const CutResult last = cutAndCheck(mesh, plane(Vector3d::Constant(4.6732 / 3), Vector3d::Ones()));
  EXPECT_EQ(mesh.numCells(), 60);
  EXPECT_EQ(last.pieces_after, 4);
}

TEST(CutMesh, APlaneAlongFacesSplitsNoCellAndLeavesTwoPieces) {
  PolyhedralMesh mesh = blocks();
  const CutResult result = cutAndCheck(mesh, plane({1, 0, 0}, Vector3d::UnitX()));
  EXPECT_EQ(result.status, CutStatus::kCut);
  EXPECT_EQ(mesh.numCells(), 27);
  EXPECT_EQ(result.pieces_after, 2);
  EXPECT_EQ(result.cells_split, 0);
  EXPECT_NEAR(result.cut_area_m2, 9, 1e-12);
}

TEST(CutMesh, APlaneThroughVerticesAndAlongDiagonalsLeavesTwoPieces) {
  for (const Vector3d& normal :
       {Vector3d(1, 1, 0), Vector3d(1, 1, 1), Vector3d(1, -1, 0), Vector3d(1, 1, -1)}) {
    PolyhedralMesh mesh = blocks();
    const CutResult result = cutAndCheck(mesh, plane({1, 1, 1}, normal));
    EXPECT_EQ(result.pieces_after, 2) << normal.transpose();
    EXPECT_EQ(result.cells_left_whole, 0);
  }
}

TEST(CutMesh, APlaneThatMissesLeavesTheMeshAsItWas) {
  PolyhedralMesh mesh = blocks();
  const CutResult result = cutAndCheck(mesh, plane({4, 0, 0}, Vector3d::UnitX()));
  EXPECT_EQ(result.status, CutStatus::kMissed);
  EXPECT_TRUE(result.change.isEmpty());
  EXPECT_EQ(mesh.numVertices(), 64);
}

TEST(CutMesh, RandomPlanesThroughTetsMakeTwoPiecesOfTheRightVolume) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < 60; ++i) {
    PolyhedralMesh mesh = makeTetBall(Vector3d::Zero(), 1, 3);
    const Vector3d normal = Vector3d(uniform(random), uniform(random), uniform(random)).normalized();
    const Vector3d point = 0.6 * Vector3d(uniform(random), uniform(random), uniform(random));
    const CutResult result = cutAndCheck(mesh, plane(point, normal));
    EXPECT_EQ(result.pieces_after, 2) << i;
    EXPECT_EQ(result.cells_left_whole, 0) << i;
  }
}

TEST(CutMesh, ManyPlanesThroughOneBodyStayValid) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PolyhedralMesh mesh = makeTetBall(Vector3d::Zero(), 1, 3);
  int left_whole = 0, splits = 0;
  for (int i = 0; i < 30; ++i) {
    const Vector3d normal = Vector3d(uniform(random), uniform(random), uniform(random)).normalized();
    const Vector3d point = 0.6 * Vector3d(uniform(random), uniform(random), uniform(random));
    const Matrix3Xd positions = mesh.restPositions();
    const CutResult result = cutMesh(mesh, positions, plane(point, normal), {}, i + 1);
    ASSERT_TRUE(checkMesh(mesh).empty()) << i << ": " << checkMesh(mesh).front();
    left_whole += result.cells_left_whole;
    splits += result.cells_split;
  }
  RecordProperty("left_whole", left_whole);
  RecordProperty("splits", splits);
  EXPECT_LT(left_whole, 1e-3 * splits + 1) << splits;
}

/// A curved path through [0,1]^3: a vertical blade that enters at x < 0, swings in y and tilts, leaves at x
/// > 1.
SweepCut curvedSweep(int steps) {
  SweepCut sweep;
  sweep.edge_tool.resize(3, 2);
  sweep.edge_tool << 0, 0, 0, 0, -0.8, 0.8;
  for (int i = 0; i <= steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    Isometry3d T = Isometry3d::Identity();
    T.translation() = Vector3d(-0.3 + 1.6 * s, 0.45 + 0.2 * std::sin(5 * s), 0.5);
    T.linear() = AngleAxisd(0.4 * (s - 0.5), Vector3d::UnitX()).toRotationMatrix();
    sweep.T_world_tool.push_back(T);
  }
  return sweep;
}

TEST(CutMesh, ACurvedSweepGivesTheSamePiecesAtAnyNumberOfSteps) {
  std::set<int> cells;
  for (const int steps : {24, 240, 2400}) {
    PolyhedralMesh mesh = makeTetBox(Vector3d::Zero(), Vector3d::Ones(), Vector3i::Constant(6));
    const CutResult result = cutAndCheck(mesh, curvedSweep(steps));
    EXPECT_EQ(result.pieces_after, 2) << steps;
    EXPECT_EQ(result.cells_left_whole, 0) << steps;
    cells.insert(mesh.numCells());
  }
  EXPECT_LT(*cells.rbegin() - *cells.begin(), 0.02 * *cells.begin());
}

TEST(CutMesh, APolygonCutsOnlyWhereItReaches) {
  PolyhedralMesh mesh = makeTetBox(Vector3d::Zero(), Vector3d::Ones(), Vector3i::Constant(6));
  PolygonCut half;
  half.corners_world.resize(3, 4);
  half.corners_world << 0.47, 0.47, 0.47, 0.47, -1, 2, 2, -1, 0.5, 0.5, 2, 2;
  const CutResult result = cutAndCheck(mesh, half);
  EXPECT_EQ(result.status, CutStatus::kCut);
  EXPECT_EQ(result.pieces_after, 1);
  EXPECT_GT(result.cut_area_m2, 0.3);
  EXPECT_LT(result.cut_area_m2, 0.6);
}

TEST(CutMesh, BadInputIsRefusedAndTheMeshIsAsItWas) {
  PolyhedralMesh mesh = blocks();
  const Matrix3Xd positions = mesh.restPositions();
  const double nan = std::nan("");
  const auto refused = [&](const CutOperation& operation) {
    EXPECT_THROW(cutMesh(mesh, positions, operation, {}, 1), std::invalid_argument);
    EXPECT_EQ(mesh.numCells(), 27);
    EXPECT_EQ(mesh.numVertices(), 64);
  };
  refused(plane(Vector3d::Zero(), Vector3d::Zero()));
  refused(plane({nan, 0, 0}, Vector3d::UnitX()));
  refused(plane({0, 0, 0}, {0, kInfinity, 0}));
  refused(PolygonCut{});
  PolygonCut polygon;
  polygon.corners_world.resize(3, 4);
  polygon.corners_world << 0, 1, 0, 1, 0, 1, 1, 0, 0, 0, 0, 0;  // a bow tie
  refused(polygon);
  polygon.corners_world << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0.5;  // not flat
  refused(polygon);
  polygon.corners_world << 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;  // a repeated corner
  refused(polygon);
  polygon.corners_world << 0, 1, 2, 3, 0, 0, 0, 0, 0, 0, 0, 0;  // on a line
  refused(polygon);
  SweepCut sweep = curvedSweep(2);
  sweep.T_world_tool.resize(1);
  refused(sweep);
  sweep = curvedSweep(2);
  sweep.T_world_tool[1].translation().x() = nan;
  refused(sweep);
  sweep = curvedSweep(2);
  sweep.edge_tool.setZero();
  refused(sweep);
}

}  // namespace
}  // namespace polyscalpel
