// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/surface.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

/// A pentagon in the plane z = 0 whose fourth loop entry (point 3) hangs in the edge between points 2 and 4.
Face makePentagon() {
  Face face;
  for (int v = 0; v < 5; ++v) face.loop.emplace_back(v);
  face.is_corner = {1, 1, 1, 0, 1};
  face.cells[0] = CellId(0);
  return face;
}

Eigen::Matrix3Xd makePentagonPoints() {
  Eigen::Matrix3Xd points(3, 5);
  points << 0, 2, 2, 1, 0,  //
      0, 0, 2, 2, 2,        //
      0, 0, 0, 0, 0;
  return points;
}

/// A mesh of hexahedra with every vertex moved at random, so that no face is planar.
PolyhedralMesh makeBox() {
  return makeHexBox({-1, 0, 2}, {2, 1, 1}, {4, 2, 2});
}

Eigen::Matrix3Xd moveAtRandom(const PolyhedralMesh& mesh, double amplitude, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-amplitude, amplitude);
  Eigen::Matrix3Xd positions = mesh.restPositions();
  for (double& coordinate : positions.reshaped()) coordinate += shift(random);
  return positions;
}

TEST(Surface, VirtualVertexIsTheMeanOfTheCornersAlone) {
  EXPECT_TRUE(virtualVertex(makePentagon(), makePentagonPoints()).isApprox(Eigen::Vector3d(1, 1, 0), 1e-15));
}

TEST(Surface, TrianglesOfAFanCoverThePolygon) {
  const Face face = makePentagon();
  ASSERT_EQ(numTriangles(face), 5);
  double area = 0;
  for (int i = 0; i < numTriangles(face); ++i) {
    const Eigen::Matrix3d corners = triangleCorners(face, i, makePentagonPoints());
    const Eigen::Vector3d normal = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
    EXPECT_GT(normal.z(), 0) << "counter-clockwise as the loop is";
    area += normal.norm() / 2;
  }
  EXPECT_NEAR(area, 4, 1e-14);
}

TEST(Surface, ATriangleStaysAsItIs) {
  const PolyhedralMesh mesh = makeTetBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  const Face& face = mesh.face(FaceId(0));
  ASSERT_EQ(numTriangles(face), 1);
  const Eigen::Matrix3d corners = triangleCorners(face, 0, mesh.restPositions());
  for (int i = 0; i < 3; ++i) EXPECT_EQ(corners.col(i), mesh.restPosition(face.loop[i]));
  const auto weights = vertexWeights(face, 0, {0.2, 0.3, 0.5});
  ASSERT_EQ(weights.size(), 3u);
  EXPECT_EQ(weights[1].vertex, face.loop[1]);
  EXPECT_EQ(weights[1].weight, 0.3);
}

TEST(Surface, WeightsReproduceThePointAndNameEachVertexOnce) {
  const Face face = makePentagon();
  const Eigen::Matrix3Xd points = makePentagonPoints();
  const Eigen::Vector3d barycentric(0.5, 0.2, 0.3);
  for (int i = 0; i < numTriangles(face); ++i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double total = 0;
    std::vector<VertexId> vertices;
    for (const WeightedVertex& weighted : vertexWeights(face, i, barycentric)) {
      sum += weighted.weight * points.col(weighted.vertex.index());
      total += weighted.weight;
      vertices.push_back(weighted.vertex);
    }
    EXPECT_NEAR(total, 1, 1e-15);
    EXPECT_TRUE(sum.isApprox(triangleCorners(face, i, points) * barycentric, 1e-14));
    std::sort(vertices.begin(), vertices.end());
    EXPECT_EQ(std::adjacent_find(vertices.begin(), vertices.end()), vertices.end());
  }
  // The hanging vertex bears a share only where it is a triangle's own corner.
  EXPECT_EQ(vertexWeights(face, 0, barycentric).size(), 4u);
  EXPECT_EQ(vertexWeights(face, 2, barycentric).size(), 5u);
}

TEST(Surface, CellSurfaceIsClosedAndMatchesTheFaces) {
  const PolyhedralMesh mesh = makeBox();
  const Eigen::Matrix3Xd positions = moveAtRandom(mesh, 0.05, 1);
  for (const CellId id : mesh.cells()) {
    const CellSurface surface = makeCellSurface(mesh, id, positions);
    EXPECT_EQ(surface.num_vertices, 8);
    EXPECT_EQ(surface.points.cols(), 14);
    EXPECT_EQ(surface.triangles.size(), 24u);
    ASSERT_EQ(surface.parents.size(), 6u);
    EXPECT_FALSE(surface.isTetrahedron());
    std::vector<std::pair<int, int>> edges;
    Eigen::Vector3d area_vector = Eigen::Vector3d::Zero();
    for (const auto& t : surface.triangles) {
      for (int i = 0; i < 3; ++i) edges.emplace_back(t[i], t[(i + 1) % 3]);
      area_vector += (surface.points.col(t[1]) - surface.points.col(t[0]))
                         .cross(surface.points.col(t[2]) - surface.points.col(t[0]));
    }
    std::sort(edges.begin(), edges.end());
    EXPECT_EQ(std::adjacent_find(edges.begin(), edges.end()), edges.end());
    for (const auto& [a, b] : edges)
      EXPECT_TRUE(std::binary_search(edges.begin(), edges.end(), std::pair(b, a)));
    EXPECT_LT(area_vector.norm(), 1e-14);
    for (int f = 0; f < 6; ++f) {
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (const int parent : surface.parents[f]) mean += surface.points.col(parent) / 4;
      EXPECT_TRUE(mean.isApprox(surface.points.col(8 + f), 1e-14));
    }
  }
  EXPECT_TRUE(makeCellSurface(makeTetBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1}), CellId(0),
                              makeTetBox({0, 0, 0}, {1, 1, 1}, {1, 1, 1}).restPositions())
                  .isTetrahedron());
}

TEST(Surface, VolumesOfCellsSumToTheWholeHoweverTheInnerFacesBend) {
  const PolyhedralMesh mesh = makeBox();
  Eigen::Matrix3Xd positions = moveAtRandom(mesh, 0.08, 2);
  std::vector<char> is_outer(mesh.numVertices(), 0);
  for (int f = 0; f < mesh.faceCapacity(); ++f) {
    if (!mesh.face(FaceId(f)).isBoundary()) continue;
    for (const VertexId vertex : mesh.face(FaceId(f)).loop) is_outer[vertex.index()] = 1;
  }
  for (int v = 0; v < mesh.numVertices(); ++v) {
    if (is_outer[v]) positions.col(v) = mesh.restPosition(VertexId(v));
  }
  EXPECT_NEAR(volume(mesh, positions), 2, 1e-14);
  double sum = 0;
  for (const CellId cell : mesh.cells()) sum += volume(makeCellSurface(mesh, cell, positions));
  EXPECT_NEAR(sum, 2, 1e-14);
}

TEST(Surface, VolumeIsInvariantUnderRigidMotionAndScalesWithTheDeterminant) {
  const PolyhedralMesh mesh = makeBox();
  const Eigen::Matrix3Xd positions = moveAtRandom(mesh, 0.05, 3);
  const double original = volume(mesh, positions);
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Matrix3Xd moved = (rotation * positions).colwise() + Eigen::Vector3d(10, -20, 30);
  EXPECT_NEAR(volume(mesh, moved), original, 1e-12 * original);
  Eigen::Matrix3d stretch;
  stretch << 2, 0.3, 0, 0, 1.5, 0, 0.1, 0, 0.5;
  EXPECT_NEAR(volume(mesh, stretch * positions), stretch.determinant() * original, 1e-13);
  const Eigen::Matrix3Xd mirrored = -positions;
  EXPECT_NEAR(volume(mesh, mirrored), -original, 1e-13);
}

TEST(Surface, SubTetsOfACube) {
  const PolyhedralMesh mesh = makeHexBox({5, 5, 5}, {1, 1, 1}, {1, 1, 1});
  const CellSurface surface = makeCellSurface(mesh, CellId(0), mesh.restPositions());
  EXPECT_TRUE(starCentre(surface).isApprox(Eigen::Vector3d(5.5, 5.5, 5.5), 1e-15));
  EXPECT_NEAR(smallestSubTetVolume(surface), 1.0 / 24, 1e-15);
}

TEST(Surface, StarCentreSeesADentedCellWholeButNoFoldedOne) {
  const PolyhedralMesh mesh = makeHexBox({5, 5, 5}, {1, 1, 1}, {1, 1, 1});
  for (const double corner : {5.9, 5.5, 5.3, 5.1}) {
    Eigen::Matrix3Xd dented = mesh.restPositions();
    dented.col(7).setConstant(corner);
    EXPECT_GT(smallestSubTetVolume(makeCellSurface(mesh, CellId(0), dented)), 1e-3) << corner;
  }
  Eigen::Matrix3Xd folded = mesh.restPositions();
  folded.col(7).setConstant(4.7);
  const CellSurface surface = makeCellSurface(mesh, CellId(0), folded);
  EXPECT_GT(volume(surface), 0);
  EXPECT_LT(smallestSubTetVolume(surface), 0);
}

}  // namespace
}  // namespace polyscalpel
