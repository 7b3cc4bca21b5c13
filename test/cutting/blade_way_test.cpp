// SPDX-License-Identifier: BSD-3-Clause
//
// A blade that comes back: in its own slit, where it cuts nothing, or by another way, where what lies between
// the two comes off.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/blade_way.hpp"
#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Poses = std::vector<Isometry3d>;

constexpr double kCellSize = 0.2;

Matrix3Xd straightBlade(double half_length) {
  Matrix3Xd edge(3, 2);
  edge << 0, 0, 0, 0, -half_length, half_length;
  return edge;
}

/// A cube of edge length 1.
PolyhedralMesh makeCube(bool is_of_tets) {
  const Eigen::Vector3i cells = Eigen::Vector3i::Constant(static_cast<int>(std::lround(1 / kCellSize)));
  return is_of_tets ? makeTetBox(Vector3d::Zero(), Vector3d::Ones(), cells)
                    : makeHexBox(Vector3d::Zero(), Vector3d::Ones(), cells);
}

/// A stroke in the x-y plane of a frame that lies askew, the blade along its z axis.
struct Track {
  Isometry3d T_world_track = Isometry3d::Identity();

  explicit Track(int variant) {
    T_world_track.linear() =
        AngleAxisd(0.3 + 1.1 * variant, Vector3d(0.2, 0.1, 1).normalized()).toRotationMatrix();
    T_world_track.translation() = Vector3d(0.47 + 0.013 * variant, 0.53 - 0.017 * variant, 0.5);
  }
  Isometry3d pose(double x, double y, double turn = 0) const {
    Isometry3d T = T_world_track;
    T.translate(Vector3d(x, y, 0));
    T.rotate(AngleAxisd(turn, Vector3d::UnitZ()));
    return T;
  }
};

/// In along the x axis up to the origin, and out again, the angle between the two ways.
Poses vTurn(const Track& track, double angle, int steps) {
  constexpr double kWay = 1.6;
  Poses poses;
  for (int i = 0; i <= steps; ++i) poses.push_back(track.pose(kWay * (i - steps) / steps, 0));
  for (int i = 1; i <= steps; ++i) {
    const double way = kWay * i / steps / std::cos(angle);
    poses.push_back(track.pose(-way * std::cos(angle), way * std::sin(angle)));
  }
  return poses;
}

/// Draws a blade through a mesh that lies still, pose by pose.
void draw(PolyhedralMesh& mesh, const Matrix3Xd& edge, const Poses& poses,
          const std::function<void(BladeCut&, std::size_t)>& after_step = {}) {
  BladeCut blade(edge, CuttingConfig());
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const Matrix3Xd still = mesh.restPositions();
    blade.advance(mesh, still, still, poses[i], poses[i + 1], 1);
    if (after_step) after_step(blade, i);
  }
  const Matrix3Xd still = mesh.restPositions();
  blade.finish(mesh, still, 1);
  EXPECT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();
}

/// Volume of what lies between the two ways of a V turn, by sums over a grid [m^3].
double volumeBetween(const Track& track, double angle) {
  constexpr int kPoints = 50;
  int inside = 0;
  for (int i = 0; i < kPoints; ++i) {
    for (int j = 0; j < kPoints; ++j) {
      for (int k = 0; k < kPoints; ++k) {
        const Vector3d x =
            track.T_world_track.inverse() * ((Vector3d(i, j, k).array() + 0.5) / kPoints).matrix();
        inside += x.y() > 0 && -x.x() * std::sin(angle) - x.y() * std::cos(angle) > 0;
      }
    }
  }
  return inside / std::pow(kPoints, 3);
}

std::vector<double> volumesOfPieces(const PolyhedralMesh& mesh) {
  const Pieces pieces = findPieces(mesh);
  std::vector<double> volumes(pieces.count, 0.0);
  for (const CellId id : mesh.cells())
    volumes[pieces.piece_of_cell[id.index()]] += volume(makeCellSurface(mesh, id, mesh.restPositions()));
  std::sort(volumes.begin(), volumes.end());
  return volumes;
}

void expectWedge(const PolyhedralMesh& mesh, const Track& track, double angle) {
  const std::vector<double> volumes = volumesOfPieces(mesh);
  ASSERT_EQ(volumes.size(), 2u);
  // Either wall may lie off its plane by the snap distance; none has an area above that of a section.
  EXPECT_NEAR(volumes[0], volumeBetween(track, angle),
              2 * CuttingConfig().snap_tolerance * kCellSize * std::sqrt(2));
}

TEST(BladeWay, TellsHowFarABladeIsOffItsSlit) {
  BladeWay way;
  const Matrix3Xd edge = straightBlade(0.5);
  const auto at = [&](double x, double y, double z) { return Matrix3Xd(edge.colwise() + Vector3d(x, y, z)); };
  for (int i = 0; i <= 20; ++i) way.goOn(at(0.1 * i, 0, 0), 0.05);
  EXPECT_NEAR(way.distance(at(0.73, 0, 0)), 0, 1e-12);
  EXPECT_NEAR(way.distance(at(0.73, 0.02, 0)), 0.02, 1e-12);
  EXPECT_NEAR(way.distance(at(0.73, -0.02, 3)), 0.02, 1e-12) << "further along itself";
  EXPECT_NEAR(way.distance(at(-2, 0.02, 0)), 0.02, 1e-12) << "before the way's beginning";
  way.follow(Isometry3d(Eigen::Translation3d(0, 1, 0)));
  EXPECT_NEAR(way.distance(at(0.73, 1, 0)), 0, 1e-12);
}

TEST(BladeWay, FollowsABend) {
  BladeWay way;
  const auto at = [&](double angle, double radius) {
    return Matrix3Xd(straightBlade(0.5).colwise() + radius * Vector3d(std::cos(angle), std::sin(angle), 0));
  };
  for (int i = 0; i <= 100; ++i) way.goOn(at(0.02 * i, 1), 0);
  for (int i = 10; i <= 90; ++i) {
    EXPECT_LT(way.distance(at(0.02 * i + 0.01, 1)), 1e-4);
    EXPECT_NEAR(way.distance(at(0.02 * i + 0.01, 1.05)), 0.05, 1e-4);
  }
}

TEST(BladeTurn, WhatLiesBetweenTheWaysInAndOutComesOff) {
  for (const bool is_of_tets : {false, true}) {
    for (const double degrees : {5.0, 10.0, 20.0, 40.0, 60.0, 80.0}) {
      for (int variant = 0; variant < 4; ++variant) {
        SCOPED_TRACE(testing::Message()
                     << (is_of_tets ? "tets, " : "hexes, ") << degrees << " degrees, variant " << variant);
        const Track track(variant);
        const double angle = degrees * M_PI / 180;
        // Drawn in steps of a third to one cell.
        PolyhedralMesh mesh = makeCube(is_of_tets);
        draw(mesh, straightBlade(3), vTurn(track, angle, 8 + 3 * variant));
        expectWedge(mesh, track, angle);
      }
    }
  }
}

TEST(BladeTurn, ItMakesNoDifferenceHowFineTheStepsAreOrWhetherTheBladeRests) {
  const Track track(2);
  const double angle = 0.4;
  for (const bool is_of_tets : {false, true}) {
    for (const int steps : {1, 4, 16, 64, 256}) {
      SCOPED_TRACE(testing::Message() << (is_of_tets ? "tets, " : "hexes, ") << steps << " steps");
      PolyhedralMesh at_once = makeCube(is_of_tets), drawn = makeCube(is_of_tets),
                     rested = makeCube(is_of_tets);
      const Poses poses = vTurn(track, angle, steps);
      const Matrix3Xd still = at_once.restPositions();
      cutMesh(at_once, still, SweepCut{straightBlade(3), poses}, CuttingConfig(), 1);
      expectWedge(at_once, track, angle);
      draw(drawn, straightBlade(3), poses);
      expectWedge(drawn, track, angle);
      draw(rested, straightBlade(3), poses, [&](BladeCut& blade, std::size_t step) {
        const Matrix3Xd positions = rested.restPositions();
        if (static_cast<int>(step) + 1 == steps) blade.closeFront(rested, positions, 1);
      });
      expectWedge(rested, track, angle);
    }
  }
}

TEST(BladeTurn, AMotionThatIsRefusedClosesNoSlitWhereTheBladeHasTurned) {
  const Track track(0);
  PolyhedralMesh mesh = makeCube(true);
  BladeCut blade(straightBlade(3), CuttingConfig());
  const Poses poses = vTurn(track, 0.5, 12);
  const auto advance = [&](const Isometry3d& from, const Isometry3d& to) {
    const Matrix3Xd still = mesh.restPositions();
    return blade.advance(mesh, still, still, from, to, 1);
  };
  for (int i = 0; i < 12; ++i) advance(poses[i], poses[i + 1]);
  ASSERT_TRUE(blade.isCutting());
  const Matrix3Xd before = mesh.restPositions();
  const int num_cells = mesh.numCells();
  Isometry3d away = poses[12];
  away.translate(Vector3d(-1e5, 1e5, 0));
  EXPECT_EQ(advance(poses[12], away).status, CutStatus::kRefused);
  EXPECT_EQ(mesh.numCells(), num_cells);
  EXPECT_EQ(mesh.restPositions(), before);
  EXPECT_FALSE(blade.isCutting()) << "the stroke has ended";
  EXPECT_TRUE(checkMesh(mesh).empty());
}

TEST(BladeTurn, TissueThatMovesAlongMakesNoDifference) {
  // Blade and tissue turn and move together while the V is drawn.
  const Track track(1);
  const Poses poses = vTurn(track, 0.5, 40);
  PolyhedralMesh mesh = makeCube(true);
  BladeCut blade(straightBlade(3), CuttingConfig());
  const auto ride = [](std::size_t i) {
    Isometry3d T(AngleAxisd(0.01 * i, Vector3d(1, 2, 3).normalized()));
    T.pretranslate(0.02 * i * Vector3d(1, -1, 0.5));
    return T;
  };
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const Matrix3Xd start = ride(i) * mesh.restPositions(), end = ride(i + 1) * mesh.restPositions();
    blade.advance(mesh, start, end, ride(i) * poses[i], ride(i + 1) * poses[i + 1], 1);
  }
  const Matrix3Xd end = ride(poses.size() - 1) * mesh.restPositions();
  blade.finish(mesh, end, 1);
  EXPECT_TRUE(checkMesh(mesh).empty());
  expectWedge(mesh, track, 0.5);
}

TEST(BladeTurn, DrawnBackInItsOwnBentSlitABladeCutsNothing) {
  // Along an arc of five cells' radius, back half the way, and on.
  const Track track(3);
  const auto pose = [&](double s) {
    const double angle = 1.6 * (s - 0.5);
    return track.pose(std::sin(angle), 1 - std::cos(angle), angle);
  };
  constexpr int kSteps = 60;
  Poses through, with_return;
  for (int i = 0; i <= kSteps; ++i) through.push_back(pose(i / double(kSteps)));
  for (int i = 0; i <= 40; ++i) with_return.push_back(through[i]);
  for (int i = 39; i >= 20; --i) with_return.push_back(through[i]);
  for (int i = 21; i <= kSteps; ++i) with_return.push_back(through[i]);
  for (const bool is_of_tets : {false, true}) {
    PolyhedralMesh once = makeCube(is_of_tets), returned = makeCube(is_of_tets);
    draw(once, straightBlade(3), through);
    draw(returned, straightBlade(3), with_return);
    EXPECT_EQ(findPieces(once).count, 2);
    EXPECT_EQ(findPieces(returned).count, 2);
    EXPECT_EQ(returned.numCells(), once.numCells());
  }
}

TEST(BladeTurn, AHandThatTremblesMakesNoMoreCells) {
  const Track track(4);
  Poses calm, trembling;
  for (int i = 0; i <= 120; ++i) {
    const double x = -1.2 + 0.02 * i;
    calm.push_back(track.pose(x, 0));
    // To and fro by a quarter of a cell, and aside by less than the snap distance.
    trembling.push_back(
        track.pose(x + 0.25 * kCellSize * std::sin(2.4 * i), 0.02 * kCellSize * std::sin(5.1 * i)));
  }
  for (const bool is_of_tets : {false, true}) {
    PolyhedralMesh straight = makeCube(is_of_tets), trembled = makeCube(is_of_tets);
    draw(straight, straightBlade(3), calm);
    draw(trembled, straightBlade(3), trembling);
    EXPECT_EQ(findPieces(straight).count, 2);
    EXPECT_EQ(findPieces(trembled).count, 2);
    EXPECT_LE(trembled.numCells(), 1.02 * straight.numCells());
  }
}

}  // namespace
}  // namespace polyscalpel
