// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <functional>

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

Matrix3Xd verticalBlade() {
  return bladeFromTo({0, 0, -2}, {0, 0, 2});
}

Isometry3d at(double x, double y, double z = 0.5) {
  return polyscalpel::at(Vector3d(x, y, z));
}

/// A blade and a body that each follow a path; the body moves as a rigid body.
struct Stroke {
  PolyhedralMesh mesh = unitTets(5);
  BladeCut blade = BladeCut(verticalBlade(), {});
  int splits = 0, cuts = 0, pieces = 1;

  /// poses at fraction s in [0, 1] of the stroke
  void move(int steps, const std::function<Isometry3d(double)>& T_world_tool,
            const std::function<Isometry3d(double)>& T_world_body) {
    for (int i = 0; i < steps; ++i) {
      const double s0 = static_cast<double>(i) / steps, s1 = static_cast<double>(i + 1) / steps;
      const Matrix3Xd start = T_world_body(s0) * mesh.restPositions(),
                      end = T_world_body(s1) * mesh.restPositions();
      const CutResult result = blade.advance(mesh, start, end, T_world_tool(s0), T_world_tool(s1), cuts + 1);
      if (result.status != CutStatus::kCut) continue;
      ++cuts;
      splits += result.cells_split;
      pieces = result.pieces_after;
      ASSERT_TRUE(checkMesh(mesh).empty()) << i << ": " << checkMesh(mesh).front();
    }
    EXPECT_NEAR(volume(mesh, mesh.restPositions()), 1, 1e-12);
  }
};

TEST(BladeCut, AMovingBladeSplitsTissueAtRestProgressively) {
  Stroke stroke;
  stroke.move(
      100, [](double s) { return at(-0.5 + 2 * s, 0.47); }, [](double) { return at(0, 0, 0); });
  EXPECT_EQ(stroke.pieces, 2);
  EXPECT_GE(stroke.cuts, 4) << "a progressive cut opens in several steps";
  EXPECT_FALSE(stroke.blade.isCutting()) << "the stroke ends when the blade has left the tissue";
  EXPECT_EQ(stroke.blade.numPending(), 0);
}

TEST(BladeCut, TissueDrawnOverABladeAtRestIsCutAsByTheMovingBlade) {
  Stroke moving, drawn;
  moving.move(
      100, [](double s) { return at(-0.5 + 2 * s, 0.47); }, [](double) { return at(0, 0, 0); });
  drawn.move(
      100, [](double) { return at(0, 0.47); }, [](double s) { return at(0.5 - 2 * s, 0, 0); });
  EXPECT_EQ(drawn.pieces, 2);
  EXPECT_EQ(drawn.splits, moving.splits);
  EXPECT_EQ(drawn.mesh.numCells(), moving.mesh.numCells());
}

TEST(BladeCut, ABladeCarriedAlongByTheTissueCutsNothing) {
  // The blade stands in a slit's place inside the body from the start: it has crossed nothing, and both turn
  // and travel.
  Stroke stroke;
  const auto motion = [](double s) {
    Isometry3d T = at(0.8 * s, -0.3 * s, 0.1 * s);
    T.rotate(AngleAxisd(2 * s, Vector3d(1, 2, 3).normalized()));
    return T;
  };
  stroke.move(
      200, [&](double s) { return motion(s) * at(0.43, 0.47); }, motion);
  EXPECT_EQ(stroke.cuts, 0);
  EXPECT_EQ(stroke.splits, 0);
  EXPECT_EQ(stroke.blade.numPending(), 0);
}

TEST(BladeCut, BothMovingAgainstEachOtherCutOnce) {
  Stroke stroke;
  stroke.move(
      60, [](double s) { return at(-0.5 + 1.4 * s, 0.47); }, [](double s) { return at(0.5 - s, 0, 0); });
  EXPECT_EQ(stroke.pieces, 2);
}

TEST(BladeCut, ATurningBladeAtCoarseStepsCutsThrough) {
  for (const int steps : {12, 48, 480, 4800}) {
    Stroke stroke;
    stroke.move(
        steps,
        [](double s) {
          Isometry3d T = at(-0.5 + 2 * s, 0.4 + 0.15 * std::sin(4 * s));
          T.rotate(AngleAxisd(0.5 * std::sin(6 * s), Vector3d::UnitX()));
          return T;
        },
        [](double) { return at(0, 0, 0); });
    EXPECT_EQ(stroke.pieces, 2) << steps;
  }
}

TEST(BladeCut, GoingBackThroughTheSameSlitSplitsNothingMore) {
  Stroke stroke;
  const auto path = [](double s) { return at(s < 0.5 ? -0.5 + 2.6 * s : 0.8 - 2.6 * (s - 0.5), 0.47); };
  stroke.move(100, path, [](double) { return at(0, 0, 0); });
  Stroke half;
  half.move(
      50, [&](double s) { return path(0.5 * s); }, [](double) { return at(0, 0, 0); });
  const CutResult end = half.blade.finish(half.mesh, half.mesh.restPositions(), half.cuts + 1);
  EXPECT_EQ(stroke.pieces, 1);
  // The end of a stroke also closes the front, where a blade that turns has left cells passed in part.
  EXPECT_GE(stroke.splits, half.splits);
  EXPECT_LE(stroke.splits, half.splits + end.cells_split);
}

TEST(BladeCut, FinishInTheMiddleLeavesAValidMesh) {
  Stroke stroke;
  stroke.move(
      40, [](double s) { return at(-0.5 + s, 0.47); }, [](double) { return at(0, 0, 0); });
  EXPECT_TRUE(stroke.blade.isCutting());
  stroke.blade.finish(stroke.mesh, stroke.mesh.restPositions(), stroke.cuts + 1);
  EXPECT_FALSE(stroke.blade.isCutting());
  EXPECT_TRUE(checkMesh(stroke.mesh).empty());
}

/// A stroke that ends within the body, also in planes of the mesh, and is taken up there by another blade.
TEST(BladeCut, AStrokeThatGoesOnWhereAnotherEndedLeavesNoBridge) {
  for (int trial = 0; trial < 24; ++trial) {
    SCOPED_TRACE(trial);
    PolyhedralMesh mesh = unitTets(5);
    const double slope = -0.2 + 0.017 * trial, bend = trial % 2 ? 0 : 0.03;
    const int steps = 60, stop = 18 + trial;
    const auto pose = [&](int i) {
      const double x = -0.5 + 2.0 * i / steps;
      return at(x, 0.52 + slope * (x - 0.5) + bend * std::sin(8 * x));
    };
    CutResult result;
    for (const auto& [from, to] : {std::make_pair(0, stop), std::make_pair(stop, steps)}) {
      BladeCut blade(verticalBlade(), {});
      for (int i = from; i < to; ++i)
        blade.advance(mesh, mesh.restPositions(), mesh.restPositions(), pose(i), pose(i + 1), 1);
      result = blade.finish(mesh, mesh.restPositions(), 1);
      ASSERT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();
      EXPECT_EQ(result.pieces_after, to == steps ? 2 : 1);
    }
  }
}

TEST(BladeCut, AnotherCutInTheMiddleOfAStrokeIsFollowed) {
  Stroke stroke;
  const auto still = [](double) { return at(0, 0, 0); };
  stroke.move(
      40, [](double s) { return at(-0.5 + s, 0.47); }, still);
  const Matrix3Xd positions = stroke.mesh.restPositions();
  const CutResult other =
      cutMesh(stroke.mesh, positions, PlaneCut{Vector3d(0.52, 0, 0), Vector3d::UnitX()}, {}, stroke.cuts + 1);
  ASSERT_EQ(other.status, CutStatus::kCut);
  stroke.blade.update(stroke.mesh, other.change);
  stroke.move(
      40, [](double s) { return at(0.5 + s, 0.47); }, still);
  EXPECT_EQ(stroke.pieces, 4);
}

TEST(BladeCut, PendingPointsLieWhereTheBladeHasBeenAndAreGoneWithIt) {
  Stroke stroke;
  const auto still = [](double) { return at(0, 0, 0); };
  int most = 0;
  for (int i = 0; i < 40; ++i) {
    const double start_x = -0.5 + 0.05 * i, end_x = start_x + 0.05;
    stroke.move(
        1, [&](double s) { return at(start_x + s * (end_x - start_x), 0.47); }, still);
    const Matrix3Xd points = stroke.blade.pendingPoints(stroke.mesh.restPositions());
    ASSERT_EQ(points.cols(), stroke.blade.numPending());
    most = std::max(most, stroke.blade.numPending());
    for (const auto& point : points.colwise()) {
      EXPECT_NEAR(point.y(), 0.47, 1e-12);
      EXPECT_LE(point.x(), end_x + 1e-12);
    }
  }
  EXPECT_GT(most, 0);
  EXPECT_FALSE(stroke.blade.isCutting()) << "it has left";
  EXPECT_EQ(stroke.blade.pendingPoints(stroke.mesh.restPositions()).cols(), 0);
}

TEST(BladeCut, PendingPointsMoveWithTheTissueAndAreReleasedWithTheBlade) {
  Stroke stroke;
  stroke.move(
      20, [](double s) { return at(-0.5 + s, 0.47); }, [](double) { return at(0, 0, 0); });
  ASSERT_GT(stroke.blade.numPending(), 0);
  const Matrix3Xd positions = stroke.mesh.restPositions();
  const Matrix3Xd moved = (2 * positions).colwise() + Vector3d(1, -2, 3);
  const Matrix3Xd points = stroke.blade.pendingPoints(positions);
  EXPECT_TRUE(stroke.blade.pendingPoints(moved).isApprox((2 * points).colwise() + Vector3d(1, -2, 3), 1e-12));
  const int cells = stroke.mesh.numCells();
  stroke.blade.forget();
  EXPECT_EQ(stroke.blade.pendingPoints(positions).cols(), 0);
  EXPECT_EQ(stroke.mesh.numCells(), cells);
}

TEST(BladeCut, BadBladesAreRefused) {
  EXPECT_THROW(BladeCut(Matrix3Xd::Zero(3, 1), {}), std::invalid_argument);
  EXPECT_THROW(BladeCut(Matrix3Xd::Zero(3, 2), {}), std::invalid_argument);
  Matrix3Xd edge = verticalBlade();
  edge(0, 0) = std::nan("");
  EXPECT_THROW(BladeCut(edge, {}), std::invalid_argument);
}

TEST(BladeCut, MotionsThatAreNotFiniteAreRefusedAndTheStrokeGoesOn) {
  Stroke stroke;
  const auto still = [](double) { return at(0, 0, 0); };
  stroke.move(
      40, [](double s) { return at(-0.5 + s, 0.47); }, still);
  const int cells = stroke.mesh.numCells(), pending = stroke.blade.numPending();
  const Matrix3Xd positions = stroke.mesh.restPositions();
  Matrix3Xd torn = positions;
  torn(1, 3) = kInfinity;
  const Isometry3d here = at(0.5, 0.47), nowhere = at(std::nan(""), 0.47);
  EXPECT_THROW(stroke.blade.advance(stroke.mesh, positions, positions, here, nowhere, 9),
               std::invalid_argument);
  EXPECT_THROW(stroke.blade.advance(stroke.mesh, positions, positions, nowhere, here, 9),
               std::invalid_argument);
  EXPECT_THROW(stroke.blade.advance(stroke.mesh, positions, torn, here, here, 9), std::invalid_argument);
  EXPECT_THROW(stroke.blade.advance(stroke.mesh, torn, positions, here, here, 9), std::invalid_argument);
  EXPECT_EQ(stroke.mesh.numCells(), cells);
  EXPECT_EQ(stroke.blade.numPending(), pending);
  stroke.move(
      40, [](double s) { return at(0.5 + s, 0.47); }, still);
  EXPECT_EQ(stroke.pieces, 2);
}

TEST(CuttingConfig, BoundsAreHeld) {
  const auto check = [](double CuttingConfig::*field, double lowest, double highest) {
    CuttingConfig config;
    for (const double good : {lowest, highest, 0.5 * (lowest + highest)}) {
      config.*field = good;
      EXPECT_NO_THROW(validate(config)) << good;
    }
    for (const double bad : {std::nextafter(lowest, -kInfinity), std::nextafter(highest, kInfinity),
                             std::nan(""), kInfinity, -kInfinity}) {
      config.*field = bad;
      EXPECT_THROW(validate(config), std::invalid_argument) << bad;
    }
  };
  check(&CuttingConfig::snap_tolerance, 1e-6, 0.2);
  check(&CuttingConfig::hold_back, 0, 2);
  check(&CuttingConfig::max_travel, 1e-3, 1);
  check(&CuttingConfig::close_front_after_s, 0, 1e6);
  for (const auto& [volume_m3, is_good] :
       {std::pair(0.0, true), std::pair(1e6, true), std::pair(-1e-12, false), std::pair(std::nan(""), false),
        std::pair(kInfinity, false)}) {
    CuttingConfig config;
    config.debris_volume_m3 = volume_m3;
    if (is_good) {
      EXPECT_NO_THROW(validate(config));
    } else {
      EXPECT_THROW(validate(config), std::invalid_argument);
    }
  }
}

}  // namespace
}  // namespace polyscalpel
