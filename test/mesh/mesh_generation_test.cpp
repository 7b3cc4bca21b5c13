// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/mesh_generation.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

constexpr double kPi = 3.14159265358979323846;

int numBoundaryFaces(const PolyhedralMesh& mesh) {
  int count = 0;
  for (int f = 0; f < mesh.faceCapacity(); ++f) count += mesh.face(FaceId(f)).isBoundary();
  return count;
}

TEST(MakeHexBox, HasTheGridsCountsAndVolume) {
  const PolyhedralMesh mesh = makeHexBox({-1, 2, 0.5}, {3, 2, 0.25}, {3, 4, 5});
  EXPECT_EQ(mesh.numCells(), 60);
  EXPECT_EQ(mesh.numVertices(), 4 * 5 * 6);
  EXPECT_EQ(numBoundaryFaces(mesh), 2 * (12 + 15 + 20));
  EXPECT_EQ(mesh.faceCapacity(), (6 * 60 + 2 * 47) / 2);
  EXPECT_NEAR(volume(mesh, mesh.restPositions()), 1.5, 1e-14);
  for (const CellId cell : mesh.cells()) {
    EXPECT_NEAR(volume(makeCellSurface(mesh, cell, mesh.restPositions())), 1.5 / 60, 1e-15);
  }
  EXPECT_EQ(findPieces(mesh).count, 1);
  EXPECT_EQ(checkMesh(mesh), std::vector<std::string>());
}

TEST(MakeHexBox, VerticesRunFastestAlongXAndMeetTheBoundsExactly) {
  const PolyhedralMesh mesh = makeHexBox({0.1, 0.2, 0.3}, {0.7, 0.7, 0.7}, {3, 3, 3});
  EXPECT_EQ(mesh.restPosition(VertexId(0)), Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(mesh.restPosition(VertexId(3)), Eigen::Vector3d(0.1 + 0.7, 0.2, 0.3));
  EXPECT_EQ(mesh.restPosition(VertexId(12)), Eigen::Vector3d(0.1, 0.2 + 0.7, 0.3));
  EXPECT_EQ(mesh.restPosition(VertexId(63)), Eigen::Vector3d(0.1 + 0.7, 0.2 + 0.7, 0.3 + 0.7));
}

TEST(MakeTetBox, FiveTetsACubeThatConform) {
  const PolyhedralMesh mesh = makeTetBox({0, 0, 0}, {0.4, 0.1, 0.1}, {32, 8, 8});
  EXPECT_EQ(mesh.numVertices(), 2673);
  EXPECT_EQ(mesh.numCells(), 10240);
  // Two triangles a square on the border and no others: neighbours conform.
  EXPECT_EQ(numBoundaryFaces(mesh), 2 * 2 * (64 + 2 * 256));
  EXPECT_NEAR(volume(mesh, mesh.restPositions()), 0.004, 1e-16);
  EXPECT_EQ(findPieces(mesh).count, 1);
  EXPECT_EQ(checkMesh(mesh), std::vector<std::string>());
}

TEST(MakeTetBox, CentralTetJoinsTheEvenCorners) {
  const PolyhedralMesh mesh = makeTetBox({0, 0, 0}, {2, 3, 2}, {2, 3, 2});
  int num_central = 0;
  for (const CellId id : mesh.cells()) {
    const double cell_volume = volume(makeCellSurface(mesh, id, mesh.restPositions()));
    if (std::abs(cell_volume - 1.0 / 3) > 1e-12) {
      EXPECT_NEAR(cell_volume, 1.0 / 6, 1e-15);
      continue;
    }
    ++num_central;
    for (const VertexId vertex : mesh.cell(id).vertices) {
      EXPECT_EQ(std::lround(mesh.restPosition(vertex).sum()) % 2, 0);
    }
  }
  EXPECT_EQ(num_central, 12);
}

TEST(MakeTetBall, PositiveCellsInsideTheBall) {
  const Eigen::Vector3d centre(1, -2, 3);
  for (const int half_count : {1, 2, 3, 6, 12}) {
    const PolyhedralMesh mesh = makeTetBall(centre, 0.5, half_count);
    EXPECT_EQ(mesh.numCells(), 5 * 8 * half_count * half_count * half_count);
    EXPECT_EQ(findPieces(mesh).count, 1);
    EXPECT_EQ(checkMesh(mesh), std::vector<std::string>());
    for (const CellId cell : mesh.cells()) {
      EXPECT_GT(volume(makeCellSurface(mesh, cell, mesh.restPositions())), 0);
    }
    int num_on_sphere = 0;
    for (int v = 0; v < mesh.numVertices(); ++v) {
      const double distance = (mesh.restPosition(VertexId(v)) - centre).norm();
      EXPECT_LE(distance, 0.5 + 1e-14);
      num_on_sphere += distance > 0.5 - 1e-14;
    }
    const int n = 2 * half_count;
    EXPECT_EQ(num_on_sphere, (n + 1) * (n + 1) * (n + 1) - (n - 1) * (n - 1) * (n - 1));
  }
}

TEST(MakeTetBall, VolumeConvergesWithTheSquareOfTheCellSize) {
  const double exact = 4 * kPi / 3 * 0.125;
  double former_error = 0;
  for (const int half_count : {2, 4, 8, 16}) {
    const PolyhedralMesh mesh = makeTetBall({0, 0, 0}, 0.5, half_count);
    const double error = exact - volume(mesh, mesh.restPositions());
    EXPECT_GT(error, 0) << "an inscribed polyhedron is smaller than the ball";
    if (former_error > 0) {
      EXPECT_NEAR(former_error / error, 4, 0.5) << half_count;
    }
    former_error = error;
  }
  EXPECT_LT(former_error, 0.01 * exact);
}

TEST(MeshGeneration, RefusesBadSizesAndCounts) {
  const Eigen::Vector3d zero(0, 0, 0);
  const Eigen::Vector3d one(1, 1, 1);
  const Eigen::Vector3i two(2, 2, 2);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(makeHexBox(zero, {1, 0, 1}, two), std::invalid_argument);
  EXPECT_THROW(makeHexBox(zero, {1, -1, 1}, two), std::invalid_argument);
  EXPECT_THROW(makeHexBox(zero, {1, nan, 1}, two), std::invalid_argument);
  EXPECT_THROW(makeHexBox({nan, 0, 0}, one, two), std::invalid_argument);
  EXPECT_THROW(makeHexBox(zero, one, {2, 0, 2}), std::invalid_argument);
  EXPECT_THROW(makeTetBox(zero, one, {2, 2, -1}), std::invalid_argument);
  EXPECT_THROW(makeTetBox(zero, one, {2000, 2000, 2000}), std::invalid_argument);
  EXPECT_THROW(makeTetBall(zero, 0, 2), std::invalid_argument);
  EXPECT_THROW(makeTetBall(zero, nan, 2), std::invalid_argument);
  EXPECT_THROW(makeTetBall(zero, 1, 0), std::invalid_argument);
  EXPECT_NO_THROW(makeHexBox(zero, one, {1, 1, 1}));
  EXPECT_NO_THROW(makeTetBall(zero, 1, 1));
  try {
    makeHexBox(zero, {1, -2, 1}, two);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "size(1) = -2: must be finite and in (0, inf)");
  }
}

TEST(MeshGeneration, RefusesABoxTooSmallForItsCoordinates) {
  EXPECT_THROW(makeHexBox({1e9, 0, 0}, {1e-9, 1, 1}, {2, 1, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace polyscalpel
