// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/crack_growth.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "polyscalpel/cutting/crack_front.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kStrength = 1e4, kYoung = 1e6;

/// A plate of 8 x 2 x 8 cubes of 1 m edge, with a slit from its edge at x = 0 to x = 3, level with height.
PolyhedralMesh plate(bool tetrahedra, double height) {
  const Vector3d size(8, 2, 8);
  const Eigen::Vector3i counts(8, 2, 8);
  PolyhedralMesh mesh =
      tetrahedra ? makeTetBox(Vector3d::Zero(), size, counts) : makeHexBox(Vector3d::Zero(), size, counts);
  PolygonCut notch;
  notch.corners_world.resize(3, 4);
  notch.corners_world << -1, 3, 3, -1, -1, -1, 3, 3, height, height, height, height;
  EXPECT_EQ(cutMesh(mesh, Matrix3Xd(mesh.restPositions()), notch, {}, 1).status, CutStatus::kCut);
  return mesh;
}

/// Uniaxial tension in every cell.
std::vector<CellLoad> makeLoads(const PolyhedralMesh& mesh, const Vector3d& direction,
                                const std::function<double(CellId)>& stress, double toughness_j_m2 = 0) {
  std::vector<CellLoad> loads;
  for (const CellId cell : mesh.cells()) {
    const Matrix3d unit = direction.normalized() * direction.normalized().transpose();
    loads.push_back({cell, stress(cell) * unit, stress(cell) * unit, stress(cell) / kYoung * unit, kStrength,
                     toughness_j_m2});
  }
  return loads;
}

bool touchesFront(const PolyhedralMesh& mesh, CellId cell) {
  const auto& vertices = mesh.cell(cell).vertices;
  return std::any_of(vertices.begin(), vertices.end(), [&](VertexId v) { return isOnCrackFront(mesh, v); });
}

/// Lets the cracks grow under a stress that passes the strength at their fronts alone. Returns the number of
/// splits in each step.
std::vector<int> growToTheEnd(PolyhedralMesh& mesh, const Vector3d& direction) {
  MeshIndex index(mesh);
  CrackGrowth cracks({1000}, 0.05);
  std::vector<int> splits;
  const double volume_before = volume(mesh, mesh.restPositions());
  for (int step = 0; step < 60; ++step) {
    const std::vector<CellLoad> loads = makeLoads(mesh, direction, [&](CellId cell) {
      return touchesFront(mesh, cell) ? 2 * kStrength : 0.5 * kStrength;
    });
    const CrackPlan plan = cracks.plan(mesh, mesh.restPositions(), loads);
    EXPECT_FALSE(plan.is_limited);
    int count = 0;
    for (const CrackAdvance& advance : plan.advances) {
      const CutResult result =
          cracks.grow(mesh, Matrix3Xd(mesh.restPositions()), advance, loads, 2 + step, index);
      EXPECT_EQ(result.cells_left_whole, 0) << result.message;
      EXPECT_EQ(result.cut, 2) << "a crack keeps its number";
      EXPECT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();
      EXPECT_EQ(result.pieces_after, findPieces(mesh).count);
      cracks.update(result.change);
      count += result.cells_split;
    }
    if (plan.advances.empty()) break;
    splits.push_back(count);
  }
  EXPECT_NEAR(volume(mesh, mesh.restPositions()), volume_before, 1e-12 * volume_before);
  return splits;
}

/// Largest distance of the crack's vertices beyond x = begin from the plane.
double distanceFrom(const PolyhedralMesh& mesh, int crack, double begin, const Vector3d& point,
                    const Vector3d& normal) {
  double largest = 0;
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    const Face& face = mesh.face(FaceId(i));
    if (!face.isAlive() || face.cut != crack) continue;
    for (const VertexId v : face.loop) {
      const Vector3d x = mesh.restPosition(v);
      if (x.x() >= begin) largest = std::max(largest, std::abs(normal.normalized().dot(x - point)));
    }
  }
  return largest;
}

TEST(CrackGrowth, TensionAcrossASlitPartsThePlateInItsPlane) {
  for (const bool tetrahedra : {false, true}) {
    for (const double height : {4.37, 4.0}) {  // through cells, and along faces
      SCOPED_TRACE(std::to_string(tetrahedra) + " " + std::to_string(height));
      PolyhedralMesh mesh = plate(tetrahedra, height);
      const std::vector<int> splits = growToTheEnd(mesh, Vector3d::UnitZ());
      EXPECT_EQ(findPieces(mesh).count, 2);
      EXPECT_LT(distanceFrom(mesh, 2, 0, {0, 0, height}, Vector3d::UnitZ()), 1e-9);
      EXPECT_GE(splits.size(), 5u) << "one cell ahead a step, five to go";
    }
  }
}

TEST(CrackGrowth, ATurnedTensionTurnsTheCrack) {
  for (const bool tetrahedra : {false, true}) {
    for (const double degrees : {-35.0, -10.0, 10.0, 20.0, 35.0}) {
      SCOPED_TRACE(std::to_string(tetrahedra) + " " + std::to_string(degrees));
      PolyhedralMesh mesh = plate(tetrahedra, 4.37);
      const Vector3d normal = Eigen::AngleAxisd(degrees * M_PI / 180, Vector3d::UnitY()) * Vector3d::UnitZ();
      growToTheEnd(mesh, normal);
      EXPECT_EQ(findPieces(mesh).count, 2);
      // Up to the snap distance at each of the cells on its way.
      EXPECT_LT(distanceFrom(mesh, 2, 0, {3, 0, 4.37}, normal), 0.5);
    }
  }
}

TEST(CrackGrowth, NothingBelowTheStrengthOrTheToughness) {
  for (const bool tetrahedra : {false, true}) {
    const PolyhedralMesh mesh = plate(tetrahedra, 4.37);
    const CrackGrowth cracks({1000}, 0.05);
    const auto numAdvances = [&](double stress, double toughness) {
      const auto loads = makeLoads(
          mesh, Vector3d::UnitZ(), [&](CellId) { return stress; }, toughness);
      return cracks.plan(mesh, mesh.restPositions(), loads).advances.size();
    };
    EXPECT_EQ(numAdvances(kStrength, 0), 0u);
    EXPECT_GT(numAdvances(std::nextafter(kStrength, kInfinity), 0), 0u);
    // Irwin's G of cells that reach 1 m ahead of the front.
    const double release = M_PI / 2 * 4 * kStrength * kStrength / kYoung;
    EXPECT_GT(numAdvances(2 * kStrength, 0.999 * release), 0u);
    EXPECT_EQ(numAdvances(2 * kStrength, 1.001 * release), 0u);
  }
}

TEST(CrackGrowth, CompressionOpensNothing) {
  const PolyhedralMesh mesh = plate(true, 4.37);
  const CrackGrowth cracks({1000}, 0.05);
  const auto loads = makeLoads(mesh, Vector3d::UnitZ(), [](CellId) { return -10 * kStrength; });
  EXPECT_TRUE(cracks.plan(mesh, mesh.restPositions(), loads).advances.empty());
}

TEST(CrackGrowth, TheMostStrainedCellsComeFirstAndTheRateIsHeld) {
  const PolyhedralMesh mesh = plate(true, 4.37);
  const auto loads = makeLoads(mesh, Vector3d::UnitZ(), [&](CellId cell) {
    return touchesFront(mesh, cell) ? (2 + 1e-3 * cell.index()) * kStrength : 0;
  });
  const CrackPlan all = CrackGrowth({1000}, 0.05).plan(mesh, mesh.restPositions(), loads);
  ASSERT_EQ(all.advances.size(), 1u);
  EXPECT_EQ(all.advances[0].slit, 1);
  ASSERT_GT(all.advances[0].cells.size(), 3u);
  EXPECT_TRUE(std::is_sorted(all.advances[0].cells.rbegin(), all.advances[0].cells.rend()));
  EXPECT_FALSE(all.is_limited);
  const CrackPlan some = CrackGrowth({3}, 0.05).plan(mesh, mesh.restPositions(), loads);
  EXPECT_TRUE(some.is_limited);
  ASSERT_EQ(some.advances[0].cells.size(), 3u);
  EXPECT_TRUE(std::equal(some.advances[0].cells.begin(), some.advances[0].cells.end(),
                         all.advances[0].cells.begin()));
}

TEST(CrackGrowth, ANewCrackStartsInTheMostStrainedCellAwayFromFronts) {
  for (const bool tetrahedra : {false, true}) {
    const Vector3d size(4, 4, 4);
    PolyhedralMesh mesh = tetrahedra ? makeTetBox(Vector3d::Zero(), size, {4, 4, 4})
                                     : makeHexBox(Vector3d::Zero(), size, {4, 4, 4});
    const CellId weakest(mesh.cellCapacity() / 2);
    const Vector3d direction(0.2, -0.3, 1);
    const auto loads =
        makeLoads(mesh, direction, [&](CellId cell) { return (cell == weakest ? 2.1 : 2) * kStrength; });
    MeshIndex index(mesh);
    CrackGrowth cracks({1000}, 0.05);
    const CrackPlan plan = cracks.plan(mesh, mesh.restPositions(), loads);
    ASSERT_EQ(plan.advances.size(), 1u);
    EXPECT_EQ(plan.advances[0].slit, 0);
    EXPECT_EQ(plan.advances[0].cells, std::vector<CellId>{weakest});
    const CutResult result =
        cracks.grow(mesh, Matrix3Xd(mesh.restPositions()), plan.advances[0], loads, 1, index);
    ASSERT_EQ(result.status, CutStatus::kCut) << result.message;
    EXPECT_EQ(result.cells_split, 1);
    EXPECT_EQ(result.pieces_after, 1);
    EXPECT_TRUE(checkMesh(mesh).empty());
    for (int i = 0; i < mesh.faceCapacity(); ++i) {
      const Face& face = mesh.face(FaceId(i));
      if (!face.isAlive() || face.cut == 0) continue;
      const Vector3d normal = planeOf(face, mesh.restPositions()).second.normalized();
      EXPECT_GT(std::abs(normal.dot(direction.normalized())), 0.99);
    }
  }
}

TEST(CrackGrowth, TensionThatTurnsAtRandomLeavesASoundMesh) {
  for (int round = 0; round < 6; ++round) {
    SCOPED_TRACE(round);
    std::mt19937 generator(round);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    const auto randomVector = [&] {
      const double x = uniform(generator), y = uniform(generator), z = uniform(generator);
      return Vector3d(x, y, z);
    };
    PolyhedralMesh mesh = round % 3 == 0   ? makeHexBox(Vector3d::Zero(), {5, 4, 4}, {5, 4, 4})
                          : round % 3 == 1 ? makeTetBox(Vector3d::Zero(), {5, 4, 4}, {5, 4, 4})
                                           : makeTetBall(Vector3d::Zero(), 3, 3);
    const double volume_before = volume(mesh, mesh.restPositions());
    const Vector3d start = randomVector().normalized(), axis = randomVector().normalized();
    MeshIndex index(mesh);
    CrackGrowth cracks({30}, 0.05);
    int splits = 0, left_whole = 0, last_cut = 0;
    for (int step = 0; step < 35; ++step) {
      std::vector<CellLoad> loads;
      for (const CellId cell : mesh.cells()) {
        const Vector3d middle = mesh.restPosition(mesh.cell(cell).vertices.front());
        const Vector3d direction =
            (Eigen::AngleAxisd(0.25 * middle.dot(axis), axis) * start + 0.3 * randomVector()).normalized();
        const Matrix3d stress =
            (1.8 + 2 * uniform(generator)) * kStrength * direction * direction.transpose();
        loads.push_back({cell, stress, stress, stress / kYoung, kStrength, 0});
      }
      for (const CrackAdvance& advance : cracks.plan(mesh, mesh.restPositions(), loads).advances) {
        const CutResult result =
            cracks.grow(mesh, Matrix3Xd(mesh.restPositions()), advance, loads, last_cut + 1, index);
        left_whole += result.cells_left_whole;
        if (result.status != CutStatus::kCut) continue;
        splits += result.cells_split;
        last_cut = std::max(last_cut, result.cut);
        cracks.update(result.change);
        ASSERT_EQ(result.pieces_after, findPieces(mesh).count);
      }
      ASSERT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();
    }
    EXPECT_GT(splits, 100);
    EXPECT_LT(left_whole, 0.02 * splits);
    EXPECT_NEAR(volume(mesh, mesh.restPositions()), volume_before, 1e-12 * volume_before);
  }
}

TEST(CrackGrowth, AFrontIsWhereTheSidesOfASlitAreJoined) {
  for (const bool tetrahedra : {false, true}) {
    const PolyhedralMesh mesh = plate(tetrahedra, 4.37);
    int count = 0;
    for (int i = 0; i < mesh.numVertices(); ++i) {
      const Vector3d x = mesh.restPosition(VertexId(i));
      const bool expected = std::abs(x.x() - 3) < 1e-9 && std::abs(x.z() - 4.37) < 1e-9;
      EXPECT_EQ(isOnCrackFront(mesh, VertexId(i)), expected) << x.transpose();
      count += expected;
    }
    EXPECT_GE(count, 3);
    // A corner of two cuts is none: its sides are not back to back.
    PolyhedralMesh corner = makeHexBox(Vector3d::Zero(), Vector3d::Constant(3), {3, 3, 3});
    cutMesh(corner, Matrix3Xd(corner.restPositions()), PlaneCut{{1.4, 0, 0}, {1, 0, 0}}, {}, 1);
    cutMesh(corner, Matrix3Xd(corner.restPositions()), PlaneCut{{0, 1.4, 0}, {0.1, 1, 0}}, {}, 2);
    for (int i = 0; i < corner.numVertices(); ++i) EXPECT_FALSE(isOnCrackFront(corner, VertexId(i)));
  }
}

}  // namespace
}  // namespace polyscalpel
