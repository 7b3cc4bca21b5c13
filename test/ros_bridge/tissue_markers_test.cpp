// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/tissue_markers.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

PolyhedralMesh block() {
  return makeHexBox({0, 0, 0}, {3, 3, 3}, {3, 3, 3});
}

double area(const SurfaceTriangles& triangles) {
  double sum = 0;
  for (const Eigen::Matrix3d& p : triangles.corners)
    sum += (p.col(1) - p.col(0)).cross(p.col(2) - p.col(0)).norm() / 2;
  return sum;
}

TEST(TissueMarkers, CoverTheSurfaceOfABlock) {
  const PolyhedralMesh mesh = block();
  const SurfaceTriangles triangles = makeSurfaceTriangles(mesh, mesh.restPositions(), false);
  EXPECT_NEAR(area(triangles), 6 * 9, 1e-12);
  EXPECT_TRUE(makeSurfaceTriangles(mesh, mesh.restPositions(), true).corners.empty());
  const visualization_msgs::Marker marker = makeTriangleMarker(triangles, Eigen::Vector4d(1, 0.5, 0.2, 1));
  EXPECT_EQ(marker.points.size(), 3 * triangles.corners.size());
  EXPECT_EQ(marker.colors.size(), marker.points.size());
}

TEST(TissueMarkers, TrianglesKnowWhereTheyComeFrom) {
  for (const PolyhedralMesh& mesh : {block(), makeTetBall({0, 0, 0}, 1, 2)}) {
    const SurfaceTriangles triangles = makeSurfaceTriangles(mesh, mesh.restPositions(), false);
    ASSERT_EQ(triangles.origins.size(), triangles.corners.size());
    for (std::size_t i = 0; i < triangles.corners.size(); ++i) {
      const auto& [face, index] = triangles.origins[i];
      EXPECT_EQ(triangleCorners(mesh.face(face), index, mesh.restPositions()), triangles.corners[i]);
    }
  }
}

TEST(TissueMarkers, SharpEdgesStaySharp) {
  const PolyhedralMesh mesh = block();
  const SurfaceTriangles triangles = makeSurfaceTriangles(mesh, mesh.restPositions(), false);
  for (std::size_t i = 0; i < triangles.corners.size(); ++i) {
    const Eigen::Matrix3d& p = triangles.corners[i];
    const Eigen::Vector3d flat = (p.col(1) - p.col(0)).cross(p.col(2) - p.col(0)).normalized();
    for (int j = 0; j < 3; ++j) EXPECT_LT((triangles.normals[i].col(j) - flat).norm(), 1e-12);
  }
}

TEST(TissueMarkers, RoundSurfacesAreSmooth) {
  const PolyhedralMesh mesh = makeTetBall({0, 0, 0}, 1, 5);
  const SurfaceTriangles triangles = makeSurfaceTriangles(mesh, mesh.restPositions(), false);
  for (std::size_t i = 0; i < triangles.corners.size(); ++i)
    for (int j = 0; j < 3; ++j)
      EXPECT_GT(triangles.normals[i].col(j).dot(triangles.corners[i].col(j).normalized()), 0.97);
}

TEST(TissueMarkers, CutFacesAreApart) {
  PolyhedralMesh mesh = block();
  const Eigen::Matrix3Xd positions = mesh.restPositions();
  const CutResult result = cutMesh(mesh, positions, PlaneCut{{1.5, 0, 0}, {1, 0, 0}}, CuttingConfig(), 1);
  ASSERT_EQ(result.status, CutStatus::kCut);
  EXPECT_NEAR(area(makeSurfaceTriangles(mesh, mesh.restPositions(), true)), 2 * 9, 1e-12);
  EXPECT_NEAR(area(makeSurfaceTriangles(mesh, mesh.restPositions(), false)), 6 * 9, 1e-12);

  const Pieces pieces = findPieces(mesh);
  const std::vector<PieceSummary> summaries = summarisePieces(mesh, pieces, mesh.restPositions());
  ASSERT_EQ(summaries.size(), 2u);
  for (const PieceSummary& summary : summaries) {
    EXPECT_NEAR(summary.volume_m3, 13.5, 1e-12);
    EXPECT_EQ(summary.label_point.z(), 3);
    EXPECT_NEAR(std::abs(summary.label_point.x() - 1.5), 0.75, 1e-9);
  }
}

TEST(TissueMarkers, TrianglesWithoutAreaAreLeftOut) {
  Eigen::Matrix3Xd loose(3, 9);
  loose << 0, 1, 0, 0, 1, 2, 0, 0, 0,  //
      0, 0, 1, 0, 0, 0, 0, 0, 1,       //
      0, 0, 0, 0, 0, 0, 0, 0, 0;
  const SurfaceTriangles triangles = makeSurfaceTriangles(loose);
  ASSERT_EQ(triangles.corners.size(), 1u);
  EXPECT_TRUE(triangles.origins.empty()) << "of no face";
  EXPECT_EQ(triangles.normals[0].col(0), Eigen::Vector3d(0, 0, 1));
}

TEST(TissueMarkers, WireframeHasEachEdgeOnce) {
  const PolyhedralMesh mesh = block();
  // 4 x 4 points a side: 24 edges in each of 6 sides, those 36 on the 12 rims counted twice.
  EXPECT_EQ(makeWireframeMarker(mesh, mesh.restPositions()).points.size(), 2u * (6 * 24 - 36));
}

TEST(TissueMarkers, PointsAreSpheresOfTheGivenSize) {
  const Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Random(3, 7);
  const visualization_msgs::Marker marker = makePointMarker(points, 0.25);
  EXPECT_EQ(marker.type, visualization_msgs::Marker::SPHERE_LIST);
  EXPECT_EQ(marker.scale.x, 0.25);
  EXPECT_EQ(marker.scale.z, 0.25);
  ASSERT_EQ(marker.points.size(), 7u);
  for (int i = 0; i < 7; ++i) {
    const geometry_msgs::Point& point = marker.points[static_cast<std::size_t>(i)];
    EXPECT_EQ(Eigen::Vector3d(point.x, point.y, point.z), points.col(i));
  }
}

TEST(TissueMarkers, LightIsAPartOfOne) {
  for (int i = 0; i < 200; ++i) {
    const double z = -1 + i / 100.0, r = std::sqrt(std::max(0.0, 1 - z * z));
    const double light = lightOn({r * std::cos(i), r * std::sin(i), z});
    EXPECT_GE(light, 0);
    EXPECT_LE(light, 1);
  }
  EXPECT_GT(lightOn({0, 0, 1}), lightOn({0, 0, -1}));
}

}  // namespace
}  // namespace polyscalpel
