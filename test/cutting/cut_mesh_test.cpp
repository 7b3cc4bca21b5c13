// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/cut_mesh.hpp"

#include <cmath>
#include <random>
#include <set>
#include <sstream>

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

TEST(CutMesh, APlaneAlongFacesOpensTheirPartsWhoseCornersAreAllNew) {
  // A tip that enters beside a corner divides the face below one block, whose middle part has corners from
  // which no edge of that block leaves the face.
  PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d::Ones(), Vector3i::Constant(4));
  SweepCut tip;
  tip.edge_tool.resize(3, 2);
  tip.edge_tool << 0, 0, 0, 0, -0.017, 0.017;
  Isometry3d T = Isometry3d::Identity();
  T.linear() << -0.83715347382867522, -0.3022595986291583, 0.45586532692575094,  //
      -0.54473497742053523, 0.38549543854876428, -0.74475302700475476,           //
      0.049374746897889704, -0.87179837227115553, -0.48737022116060114;
  T.translation() << 0.9195, 1.0290, 0.6224;
  tip.T_world_tool.push_back(T);
  T.translation() << 0.8898, 1.0097, 0.6241;
  tip.T_world_tool.push_back(T);
  EXPECT_GT(cutAndCheck(mesh, tip).cells_split, 0);
  EXPECT_EQ(cutAndCheck(mesh, plane({0, 0, 0.75}, Vector3d::UnitZ())).pieces_after, 2);
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

/// Everything a cut could have changed.
std::string fingerprint(const PolyhedralMesh& mesh) {
  std::ostringstream text;
  text << std::hexfloat;
  for (int i = 0; i < mesh.numVertices(); ++i) text << mesh.restPosition(VertexId(i)).transpose() << ' ';
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    const Face& face = mesh.face(FaceId(i));
    for (const VertexId v : face.loop) text << v.index() << ' ';
    text << face.cells[0].index() << ' ' << face.cells[1].index() << ' ' << face.cut << '\n';
  }
  for (int i = 0; i < mesh.cellCapacity(); ++i) {
    for (const FaceId f : mesh.cell(CellId(i)).faces) text << f.index() << ' ';
    text << '\n';
  }
  return text.str();
}

TEST(CutMesh, AListIsCutAsItsPartsOneByOne) {
  const std::vector<CutOperation> operations = {plane({0.5, 0, 0}, Vector3d::UnitX()),
                                                plane({1.5, 0, 0}, {2, 0.3, 0}),
                                                plane({0, 1.5, 0}, -Vector3d::UnitY())};
  PolyhedralMesh at_once = blocks(), one_by_one = blocks();
  const CutResult result = cutMesh(at_once, at_once.restPositions(), operations, {}, 5);
  ASSERT_EQ(result.status, CutStatus::kCut) << result.message;
  int splits = 0, cut = 5;
  double area = 0;
  for (const CutOperation& operation : operations) {
    const Matrix3Xd positions = one_by_one.restPositions();
    const CutResult part = cutMesh(one_by_one, positions, operation, {}, cut++);
    splits += part.cells_split;
    area += part.cut_area_m2;
  }
  EXPECT_EQ(fingerprint(at_once), fingerprint(one_by_one));
  EXPECT_EQ(result.cells_split, splits);
  EXPECT_DOUBLE_EQ(result.cut_area_m2, area);
  EXPECT_EQ(result.cut, 5);
  EXPECT_EQ(result.num_cuts, 3);
  EXPECT_EQ(result.pieces_before, 1);
  EXPECT_EQ(result.pieces_after, 6);
  EXPECT_EQ(static_cast<int>(result.change.new_vertices.size()), at_once.numVertices() - 64);
  for (const NewCell& cell : result.change.new_cells) {
    EXPECT_TRUE(at_once.cell(cell.cell).isAlive());
    EXPECT_LT(cell.parent.index(), 27) << "parents are cells of the mesh before the list";
    EXPECT_FALSE(at_once.cell(cell.parent).isAlive());
  }
}

TEST(CutMesh, AListOfWhichOneIsNoCutOrCutsNothingLeavesTheMeshToTheBit) {
  PolyhedralMesh mesh = blocks();
  const Matrix3Xd positions = mesh.restPositions();
  const std::string before = fingerprint(mesh);
  const CutOperation good = plane({0.5, 0, 0}, Vector3d::UnitX());
  const auto messageOf = [&](const std::vector<CutOperation>& operations) -> std::string {
    try {
      cutMesh(mesh, positions, operations, {}, 1);
    } catch (const std::invalid_argument& exception) {
      return exception.what();
    }
    return {};
  };
  EXPECT_NE(messageOf({good, plane({1, 1, 1}, Vector3d::Zero())}).find("cut 2 of 2"), std::string::npos);
  EXPECT_NE(messageOf({}).find("empty"), std::string::npos);
  EXPECT_EQ(fingerprint(mesh), before);

  const CutResult missed = cutMesh(mesh, positions, {good, plane({9, 0, 0}, Vector3d::UnitX()), good}, {}, 1);
  EXPECT_EQ(missed.status, CutStatus::kMissed);
  EXPECT_NE(missed.message.find("cut 2 of 3"), std::string::npos) << missed.message;
  EXPECT_TRUE(missed.change.isEmpty());
  EXPECT_EQ(missed.cells_split, 0);
  EXPECT_EQ(missed.pieces_after, 1);
  EXPECT_EQ(fingerprint(mesh), before);

  SweepCut far = curvedSweep(2);
  far.T_world_tool[0].translation().x() = -1e6;
  const CutResult refused = cutMesh(mesh, positions, {good, far}, {}, 1);
  EXPECT_EQ(refused.status, CutStatus::kRefused) << refused.message;
  EXPECT_NE(refused.message.find("sub-steps"), std::string::npos) << refused.message;
  EXPECT_EQ(fingerprint(mesh), before);
}

TEST(CutMesh, ASweepIsRefusedFromTheStatedNumberOfSubStepsOn) {
  PolyhedralMesh mesh = blocks();
  const Matrix3Xd positions = mesh.restPositions();
  const CuttingConfig config;
  const double longest = kMostSubSteps * config.max_travel;  // local sizes are 1
  SweepCut sweep;
  sweep.edge_tool.resize(3, 2);
  sweep.edge_tool << 0, 0, 0, 0, -9, 9;
  sweep.T_world_tool.resize(2, Isometry3d::Identity());
  sweep.T_world_tool[0].translation() = Vector3d(4 - 1.01 * longest, 1.4, 1);
  sweep.T_world_tool[1].translation() = Vector3d(4, 1.4, 1);
  EXPECT_EQ(cutMesh(mesh, positions, sweep, config, 1).status, CutStatus::kRefused);
  EXPECT_EQ(mesh.numCells(), 27);
  // The same way where no tissue is near is none too long.
  SweepCut away = sweep;
  for (Isometry3d& T : away.T_world_tool) T.translation().y() += 4 * longest;
  EXPECT_EQ(cutMesh(mesh, positions, away, config, 1).status, CutStatus::kMissed);
  sweep.T_world_tool[0].translation().x() = 4 - 0.99 * longest;
  EXPECT_EQ(cutMesh(mesh, positions, sweep, config, 1).status, CutStatus::kCut);
  EXPECT_EQ(findPieces(mesh).count, 2);
}

TEST(BladeCut, AMotionThatIsTooLongIsRefusedAndEndsTheStroke) {
  PolyhedralMesh mesh = blocks();
  const Matrix3Xd positions = mesh.restPositions();
  Matrix3Xd edge(3, 2);
  edge << 0, 0, 0, 0, -9, 9;
  BladeCut blade(edge, {});
  Isometry3d start = Isometry3d::Identity(), inside = start, far = start;
  start.translation() = Vector3d(-1, 1.4, 1);
  inside.translation() = Vector3d(0.7, 1.4, 1);
  far.translation() = Vector3d(1e9, 1.4, 1);
  blade.advance(mesh, positions, positions, start, inside, 1);
  ASSERT_GT(blade.numPending(), 0);
  const std::string before = fingerprint(mesh);
  const CutResult result = blade.advance(mesh, mesh.restPositions(), mesh.restPositions(), inside, far, 1);
  EXPECT_EQ(result.status, CutStatus::kRefused);
  EXPECT_FALSE(result.message.empty());
  EXPECT_EQ(fingerprint(mesh), before);
  EXPECT_FALSE(blade.isCutting());
}

TEST(CutMesh, APolygonMayHaveSidesInOneLine) {
  // A comb: the sides at y = 2 lie in one line and apart.
  PolygonCut comb;
  comb.corners_world.resize(3, 8);
  comb.corners_world << 0.47, 0.47, 0.47, 0.47, 0.47, 0.47, 0.47, 0.47,  //
      -1, 4, 4, 2.2, 2.2, 0.8, 0.8, -1,                                  //
      -1, -1, 4, 4, 1.5, 1.5, 4, 4;
  PolyhedralMesh mesh = blocks();
  EXPECT_EQ(cutAndCheck(mesh, comb).status, CutStatus::kCut);
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
  sweep = curvedSweep(2);
  sweep.edge_tool.resize(3, 3);
  sweep.edge_tool << 0, 0, 0, 0, 0, 0, -1, 1, -1;  // folded back on itself
  refused(sweep);
  sweep = curvedSweep(2);
  sweep.T_world_tool[1].linear() *= 1.1;  // not rigid
  refused(sweep);
  sweep = curvedSweep(2);
  sweep.T_world_tool[1].linear().col(0) *= -1;  // a mirror
  refused(sweep);
  sweep = curvedSweep(2);
  sweep.T_world_tool[1].translation().x() = 2e9;
  refused(sweep);
  PolygonCut round;  // simple, but with one corner too many
  round.corners_world.setZero(3, kMostCorners + 1);
  for (int i = 0; i <= kMostCorners; ++i) {
    const double angle = 2 * M_PI * i / (kMostCorners + 1);
    round.corners_world.col(i).head<2>() << std::cos(angle), std::sin(angle);
  }
  refused(round);
  sweep = curvedSweep(2);
  sweep.edge_tool = round.corners_world;
  refused(sweep);
  refused(plane({1e300, 0, 0}, Vector3d::UnitX()));
  refused(plane({0, 0, 0}, {1e300, 1e300, 0}));  // its length is not finite
  polygon.corners_world.setConstant(1e200);
  refused(polygon);
}

}  // namespace
}  // namespace polyscalpel
