// SPDX-License-Identifier: BSD-3-Clause
//
// Strokes that come back to the slit they have made themselves.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "support/unit_cube.hpp"

namespace polyscalpel {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Way of a blade along z that enters the unit cube at x = 0, turns left round the middle on a circle, goes
/// down through its own way at a right angle and leaves at y = 0.
std::vector<Vector3d> loopWay(double dx, double dy) {
  constexpr int kLinePoses = 60, kArcPoses = 120;
  constexpr double kRadius = 0.2;
  std::vector<Vector3d> way;
  for (int i = 0; i < kLinePoses; ++i) way.emplace_back(-0.6 + 1.1 * i / kLinePoses, 0.35, 0);
  for (int i = 0; i < kArcPoses; ++i) {
    const double angle = EIGEN_PI * (1.5 * i / kArcPoses - 0.5);
    way.emplace_back(0.5 + kRadius * std::cos(angle), 0.55 + kRadius * std::sin(angle), 0);
  }
  for (int i = 0; i <= kLinePoses; ++i) way.emplace_back(0.3, 0.55 - 1.15 * i / kLinePoses, 0);
  for (Vector3d& place : way) place += Vector3d(dx, dy, 0);
  return way;
}

/// Volumes of the pieces [m^3], ascending.
std::vector<double> pieceVolumes(const PolyhedralMesh& mesh) {
  const Pieces pieces = findPieces(mesh);
  std::vector<double> volumes(pieces.count, 0.0);
  for (const CellId id : mesh.cells()) {
    volumes[pieces.piece_of_cell[id.index()]] += volume(makeCellSurface(mesh, id, mesh.restPositions()));
  }
  std::sort(volumes.begin(), volumes.end());
  return volumes;
}

/// Draws the loop through the body, turned round its middle by T_world_way. Returns the number of cells that
/// could not be split.
int drawLoop(PolyhedralMesh& mesh, double dx, double dy, const Isometry3d& T_world_way) {
  BladeCut blade(bladeFromTo({0, 0, -1}, {0, 0, 2}), {});
  const std::vector<Vector3d> way = loopWay(dx, dy);
  int left_whole = 0, cut = 0;
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const Matrix3Xd positions = mesh.restPositions();
    const CutResult result = blade.advance(mesh, positions, positions, T_world_way * at(way[i]),
                                           T_world_way * at(way[i + 1]), cut + 1);
    cut += result.status == CutStatus::kCut;
    left_whole += result.cells_left_whole;
  }
  EXPECT_FALSE(blade.isCutting()) << "it has left the body";
  return left_whole;
}

TEST(OwnSlit, TheInsideOfALoopThatCrossesItselfComesOffWithoutSlivers) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> offset(-0.03, 0.03);
  for (int trial = 0; trial < 20; ++trial) {
    const double dx = offset(random), dy = offset(random);
    PolyhedralMesh mesh = unitTets(8);
    EXPECT_EQ(drawLoop(mesh, dx, dy, Isometry3d::Identity()), 0) << trial;
    ASSERT_TRUE(checkMesh(mesh).empty()) << trial << ": " << checkMesh(mesh).front();
    const std::vector<double> volumes = pieceVolumes(mesh);
    ASSERT_EQ(volumes.size(), 3u) << trial;
    // The corner before the loop and the loop's inside, each within twice the snap distance of its walls.
    const double corner = (0.3 + dx) * (0.35 + dy), inside = 0.04 * (1 + 0.75 * EIGEN_PI);
    constexpr double kReach = 2 * 0.05 / 8;
    EXPECT_NEAR(volumes[0], std::min(corner, inside), kReach * 1.4) << trial;
    EXPECT_NEAR(volumes[1], std::max(corner, inside), kReach * 1.4) << trial;
    EXPECT_NEAR(volumes[0] + volumes[1] + volumes[2], 1, 1e-12) << trial;
  }
}

TEST(OwnSlit, ALoopAskewToTheCellsComesOffToo) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 12; ++trial) {
    const double angle = 0.3 * uniform(random);
    const Vector3d axis = Vector3d(uniform(random), uniform(random), uniform(random)).normalized();
    const double dx = 0.03 * uniform(random), dy = 0.03 * uniform(random);
    const Vector3d middle(0.5, 0.5, 0.5);
    const Isometry3d turn = at(middle) * AngleAxisd(angle, axis) * at(-middle);
    for (PolyhedralMesh mesh : {unitTets(8), unitHexes(8)}) {
      EXPECT_EQ(drawLoop(mesh, dx, dy, turn), 0) << trial;
      ASSERT_TRUE(checkMesh(mesh).empty()) << trial << ": " << checkMesh(mesh).front();
      EXPECT_EQ(pieceVolumes(mesh).size(), 3u) << trial << " at " << mesh.numCells();
    }
  }
}

TEST(OwnSlit, ALoopThroughABallComesOffThoughItGrazesEdges) {
  // Cells at all angles to the way: its bend passes edges of theirs in and out, at corners two snap distances
  // away, and it goes down through its own slit beside corners of that. These have hung on.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Vector3d middle(0.5, 0.5, 0.5);
  for (int trial = 0; trial < 60; ++trial) {
    const double angle = 0.3 * uniform(random);
    const Vector3d axis = Vector3d(uniform(random), uniform(random), uniform(random)).normalized();
    const double dx = 0.03 * uniform(random), dy = 0.03 * uniform(random);
    constexpr int kBridged[] = {1, 2, 12, 17, 26, 31, 45};
    if (std::find(std::begin(kBridged), std::end(kBridged), trial) == std::end(kBridged)) continue;
    PolyhedralMesh mesh = makeTetBall(middle, 0.5, 4);
    EXPECT_EQ(drawLoop(mesh, dx, dy, at(middle) * AngleAxisd(angle, axis) * at(-middle)), 0) << trial;
    ASSERT_TRUE(checkMesh(mesh).empty()) << trial << ": " << checkMesh(mesh).front();
    EXPECT_EQ(pieceVolumes(mesh).size(), 3u) << trial;
  }
}

/// A blade bent into legs along y that are joined at their ends, as a hairpin is.
Matrix3Xd hairpin(int legs, double half_length_m, double gap_m) {
  constexpr int kPoints = 5;
  Matrix3Xd edge(3, kPoints * legs);
  for (int leg = 0; leg < legs; ++leg) {
    for (int i = 0; i < kPoints; ++i) {
      const double y = (leg % 2 == 0 ? 1 : -1) * (2.0 * i / (kPoints - 1) - 1);
      edge.col(leg * kPoints + i) = Vector3d(gap_m * (leg - 0.5 * (legs - 1)), half_length_m * y, 0);
    }
  }
  return edge;
}

TEST(OwnSlit, HairpinsThatStopInsideLeaveAValidMesh) {
  for (const int legs : {2, 3}) {
    PolyhedralMesh mesh = makeTetBall(Vector3d::Zero(), 0.05, 4);
    const double whole = volume(mesh, mesh.restPositions());
    constexpr int kCuts = 6, kPoses = 25;
    for (int cut = 0; cut < kCuts; ++cut) {
      SweepCut sweep{hairpin(legs, 0.065, 0.012 / legs), {}};
      for (int i = 0; i < kPoses; ++i) {
        const double s = static_cast<double>(i) / (kPoses - 1);
        Isometry3d T = at({0, 0, 0.055 - 0.075 * s});
        T.rotate(AngleAxisd(cut % 2 == 0 ? 0 : EIGEN_PI / 2, Vector3d::UnitZ()));
        T.translate(Vector3d(0.025 * (cut / 2 - 1) + 0.001, 0, 0));
        T.rotate(AngleAxisd(0.1 * (s - 0.5), Vector3d::UnitZ()));
        sweep.T_world_tool.push_back(T);
      }
      const CutResult result = cutMesh(mesh, mesh.restPositions(), sweep, {}, cut + 1);
      ASSERT_EQ(result.status, CutStatus::kCut) << legs << " legs, cut " << cut;
      ASSERT_TRUE(checkMesh(mesh).empty()) << legs << " legs, cut " << cut << ": " << checkMesh(mesh).front();
    }
    EXPECT_NEAR(volume(mesh, mesh.restPositions()), whole, 1e-12 * whole) << legs;
  }
}

}  // namespace
}  // namespace polyscalpel
