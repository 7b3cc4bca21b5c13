// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/front_closure.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "support/slit_distance.hpp"
#include "support/unit_cube.hpp"

namespace polyscalpel {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kH = 0.2;  // of the meshes below [m]

/// Largest distance from points of the blade within the unit cube, but for those nearer than `leave_out` to
/// its ends, to the slit [m].
double largestLag(const PolyhedralMesh& mesh, const Matrix3Xd& blade_world, double leave_out) {
  double largest = 0;
  const double length = (blade_world.col(1) - blade_world.col(0)).norm();
  for (int i = 0; i <= 500; ++i) {
    const double s = i / 500.0;
    if (s * length < leave_out || (1 - s) * length < leave_out) continue;
    const Vector3d point = (1 - s) * blade_world.col(0) + s * blade_world.col(1);
    if (point.minCoeff() < 0 || point.maxCoeff() > 1) continue;
    largest = std::max(largest, distanceToSlit(mesh, point));
  }
  return largest;
}

void expectSound(const PolyhedralMesh& mesh) {
  const auto violations = checkMesh(mesh);
  EXPECT_TRUE(violations.empty()) << violations.front();
  EXPECT_NEAR(volume(mesh, mesh.restPositions()), 1, 1e-12);
}

class StoppingBlade : public testing::TestWithParam<bool> {
 protected:
  PolyhedralMesh mesh() const { return GetParam() ? unitTets(5) : unitHexes(5); }
  double largestLagInSizes() const { return GetParam() ? 0.05 : 0.1; }
};

TEST_P(StoppingBlade, HasTheSlitReachIt) {
  for (int stop = 0; stop < 12; ++stop) {
    PolyhedralMesh body = mesh();
    Isometry3d T_end = at({0.1 + 0.07 * stop, 0.47, 0.5});
    T_end.rotate(AngleAxisd(0.05 * stop, Vector3d(1, 2, 0).normalized()));
    const Matrix3Xd edge = bladeFromTo({0, 0, -2}, {0, 0, 2});
    const CutResult result = cutMesh(body, body.restPositions(),
                                     SweepCut{edge, {at({-0.5, 0.43, 0.5}), T_end}}, CuttingConfig{}, 1);
    expectSound(body);
    EXPECT_EQ(result.pieces_after, 1);
    EXPECT_LT(largestLag(body, T_end * edge, 0), largestLagInSizes() * kH) << stop;
  }
}

TEST_P(StoppingBlade, HasTheSlitReachItsTipWithin) {
  for (int stop = 0; stop < 12; ++stop) {
    PolyhedralMesh body = mesh();
    const double depth = 0.31 + 0.03 * stop;
    const Matrix3Xd edge = bladeFromTo({0, 0, 1 - depth}, {0, 0, 2});
    const Isometry3d T_end = at({0.13 + 0.061 * stop, 0.47, 0});
    cutMesh(body, body.restPositions(), SweepCut{edge, {at({-0.5, 0.43, 0}), T_end}}, CuttingConfig{}, 1);
    expectSound(body);
    EXPECT_LT(largestLag(body, T_end * edge, 0.2 * kH), largestLagInSizes() * kH) << stop;
    EXPECT_LT(largestLag(body, T_end * edge, 0), 0.2 * kH) << stop;
  }
}

TEST_P(StoppingBlade, MayStopAsOftenAsItLikes) {
  PolyhedralMesh body = mesh();
  const Matrix3Xd edge = bladeFromTo({0, 0, -2}, {0, 0, 2});
  BladeCut blade(edge, {});
  const auto pose = [](int i) { return at({-0.3 + 0.013 * i, 0.47 + 0.0004 * i, 0.5}); };
  CutResult result;
  for (int i = 0; i < 125; ++i) {
    const Matrix3Xd positions = body.restPositions();
    result = blade.advance(body, positions, positions, pose(i), pose(i + 1), 1);
    if (i % 7 == 0) {
      result = blade.closeFront(body, body.restPositions(), 1);
      EXPECT_LT(largestLag(body, pose(i + 1) * edge, 0), largestLagInSizes() * kH) << i;
    }
    expectSound(body);
  }
  EXPECT_EQ(result.pieces_after, 2);
  EXPECT_FALSE(blade.isCutting());
}

TEST_P(StoppingBlade, DividesNothingMoreWhenAskedAgain) {
  PolyhedralMesh body = mesh();
  BladeCut blade(bladeFromTo({0, 0, -2}, {0, 0, 2}), {});
  const Matrix3Xd positions = body.restPositions();
  blade.advance(body, positions, positions, at({-0.3, 0.47, 0.5}), at({0.51, 0.47, 0.5}), 1);
  EXPECT_EQ(blade.closeFront(body, body.restPositions(), 1).status, CutStatus::kCut);
  const int cells = body.numCells(), vertices = body.numVertices();
  EXPECT_EQ(blade.closeFront(body, body.restPositions(), 1).status, CutStatus::kNothingSeparated);
  EXPECT_EQ(body.numCells(), cells);
  EXPECT_EQ(body.numVertices(), vertices);
}

TEST_P(StoppingBlade, OpensNothingWhereItHasNotMoved) {
  PolyhedralMesh body = mesh();
  BladeCut blade(bladeFromTo({0, 0, -2}, {0, 0, 2}), {});
  const Matrix3Xd positions = body.restPositions();
  const Isometry3d T = at({0.51, 0.47, 0.5});
  blade.advance(body, positions, positions, T, T, 1);
  EXPECT_EQ(blade.finish(body, positions, 1).status, CutStatus::kMissed);
  EXPECT_EQ(body.numCells(), mesh().numCells());
}

INSTANTIATE_TEST_SUITE_P(Meshes, StoppingBlade, testing::Bool(),
                         [](const auto& info) { return info.param ? "Tetrahedra" : "Hexahedra"; });

}  // namespace
}  // namespace polyscalpel
