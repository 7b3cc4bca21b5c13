// SPDX-License-Identifier: BSD-3-Clause
//
// Where the slit of a flat blade ends whose border lies within the tissue.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "support/slit_distance.hpp"
#include "support/unit_cube.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Random = std::mt19937;

constexpr double kH = 0.2;  // of the meshes below [m]

double uniform(Random& random, double lowest, double highest) {
  return std::uniform_real_distribution<double>(lowest, highest)(random);
}

/// A plane with a frame of its own: points in it are origin + x * axes.col(0) + y * axes.col(1).
struct Sheet {
  Vector3d origin = Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();

  PolygonCut polygon(const std::vector<Vector2d>& corners) const {
    PolygonCut cut;
    cut.corners_world.resize(3, corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i)
      cut.corners_world.col(i) = origin + axes.leftCols(2) * corners[i];
    return cut;
  }
  PlaneCut plane() const { return {origin, axes.col(2)}; }
};

Eigen::Matrix3d someAxes(Random& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized()
      .toRotationMatrix();
}

/// Through the middle of the cube, more or less.
Sheet someSheet(Random& random) {
  const auto part = [&] { return uniform(random, 0.4, 0.6); };
  return {{part(), part(), part()}, someAxes(random)};
}

/// A star-shaped outline of 3 to 8 corners, no two of them nearer than a local size.
std::vector<Vector2d> someOutline(Random& random, double reach) {
  const int n = std::uniform_int_distribution<int>(3, 8)(random);
  std::vector<Vector2d> corners;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * (i + uniform(random, 0, 0.4)) / n;
    corners.push_back(reach * uniform(random, 0.5, 1) * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return corners;
}

std::vector<Vector2d> rectangle(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

bool isWithinCube(const Vector3d& point) {
  return point.minCoeff() > 0 && point.maxCoeff() < 1;
}

struct Lag {
  double along = 0;  ///< [m], largest, further than a local size from every corner
  double at_corners = 0;
};

/// Distance of the border, where it is within the unit cube, to the slit.
Lag lagOf(const PolyhedralMesh& mesh, const PolygonCut& polygon) {
  Lag lag;
  const auto& corners = polygon.corners_world;
  for (Eigen::Index i = 0; i < corners.cols(); ++i) {
    const Vector3d a = corners.col(i), b = corners.col((i + 1) % corners.cols());
    for (int k = 0; k < 60; ++k) {
      const Vector3d point = a + k / 60.0 * (b - a);
      if (!isWithinCube(point)) continue;
      const double distance = distanceToSlit(mesh, point);
      const bool is_at_corner = (corners.colwise() - point).colwise().norm().minCoeff() < 0.2 * kH;
      double& largest = is_at_corner ? lag.at_corners : lag.along;
      largest = std::max(largest, distance);
    }
  }
  return lag;
}

/// Area of the sides of all slits in rest shape [m^2]; they are planar.
double slitArea(const PolyhedralMesh& mesh) {
  double sum = 0;
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    const Face& face = mesh.face(FaceId(i));
    if (!face.isAlive() || !face.isBoundary() || face.cut == 0) continue;
    sum += planeOf(face, mesh.restPositions()).second.norm();
  }
  return sum;
}

double perimeter(const PolygonCut& polygon) {
  const auto& corners = polygon.corners_world;
  double sum = 0;
  for (Eigen::Index i = 0; i < corners.cols(); ++i)
    sum += (corners.col((i + 1) % corners.cols()) - corners.col(i)).norm();
  return sum;
}

void expectSound(const PolyhedralMesh& mesh, const std::string& what) {
  const auto violations = checkMesh(mesh);
  EXPECT_TRUE(violations.empty()) << what << ": " << violations.front();
  EXPECT_NEAR(volume(mesh, mesh.restPositions()), 1, 1e-12) << what;
}

class FlatBlade : public testing::TestWithParam<bool> {
 protected:
  PolyhedralMesh mesh() const { return GetParam() ? unitTets(5) : unitHexes(5); }
  double largestLag() const { return (GetParam() ? 0.05 : 0.1) * kH; }

  CutResult cut(PolyhedralMesh& body, const std::vector<CutOperation>& operations) const {
    return cutMesh(body, body.restPositions(), operations, CuttingConfig{}, 1);
  }
};

TEST_P(FlatBlade, HasTheSlitReachItsBorder) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const Sheet sheet = someSheet(random);
    const PolygonCut polygon = sheet.polygon(someOutline(random, uniform(random, 0.2, 0.7)));
    PolyhedralMesh body = mesh();
    const CutResult result = cut(body, {polygon});
    const std::string what = "seed " + std::to_string(seed);
    ASSERT_EQ(result.status, CutStatus::kCut) << what;
    expectSound(body, what);
    EXPECT_EQ(result.cells_left_whole, 0) << what;
    const Lag lag = lagOf(body, polygon);
    EXPECT_LT(lag.along, largestLag()) << what;
    EXPECT_LT(lag.at_corners, 0.2 * kH) << what;
  }
}

TEST_P(FlatBlade, HasTheSlitEndThere) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    // All of it within the cube.
    const Sheet sheet = someSheet(random);
    const PolygonCut polygon = sheet.polygon(someOutline(random, uniform(random, 0.1, 0.35)));
    PolyhedralMesh body = mesh();
    const CutResult result = cut(body, {polygon});
    const std::string what = "seed " + std::to_string(seed);
    ASSERT_EQ(result.status, CutStatus::kCut) << what;
    expectSound(body, what);
    EXPECT_EQ(result.pieces_after, 1) << what;
    // Neither side of the border is off it by more than the lag, all along.
    EXPECT_NEAR(result.cut_area_m2, polygon.areaVector().norm(), largestLag() * perimeter(polygon)) << what;
    EXPECT_NEAR(slitArea(body), 2 * result.cut_area_m2, 1e-12) << what;
  }
}

TEST_P(FlatBlade, IsAPlaneWhereItCoversTheBody) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const Sheet sheet = someSheet(random);
    std::vector<Vector2d> corners = someOutline(random, 1);
    for (Vector2d& corner : corners) corner *= 5;
    PolyhedralMesh body = mesh(), other = mesh();
    cut(body, {sheet.polygon(corners)});
    cut(other, {sheet.plane()});
    EXPECT_EQ(body.restPositions().cols(), other.restPositions().cols());
    ASSERT_EQ(body.faceCapacity(), other.faceCapacity());
    for (int i = 0; i < body.faceCapacity(); ++i)
      ASSERT_EQ(body.face(FaceId(i)).loop, other.face(FaceId(i)).loop) << "seed " << seed;
    EXPECT_LT((body.restPositions() - other.restPositions()).cwiseAbs().maxCoeff(), 1e-12) << "seed " << seed;
  }
}

TEST_P(FlatBlade, MayHaveItsBorderOnVerticesEdgesAndFaces) {
  const std::vector<std::vector<Vector2d>> outlines = {
      rectangle(0.2, 0.2, 0.8, 0.6),         // along edges and faces
      rectangle(0.2, 0.3, 0.6, 0.7),         // two sides along them
      rectangle(0, 0, 0.6, 1),               // three sides on the surface
      rectangle(0, 0, 1, 1),                 // all of them: as a plane
      {{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.8}},  // through vertices, askew
      {{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.4}, {0.4, 0.4}, {0.4, 0.8}, {0.2, 0.8}}};  // an L
  for (const double height : {0.4, 0.5}) {  // along faces, and through cells
    for (int axis = 0; axis < 3; ++axis) {
      for (const auto& outline : outlines) {
        Sheet sheet;
        sheet.origin[axis] = height;
        for (int i = 0; i < 3; ++i) sheet.axes.col(i) = Vector3d::Unit((axis + 1 + i) % 3);
        const PolygonCut polygon = sheet.polygon(outline);
        PolyhedralMesh body = mesh();
        const CutResult result = cut(body, {polygon});
        const std::string what = std::to_string(axis) + ", " + std::to_string(height) + ", outline " +
                                 std::to_string(&outline - outlines.data());
        expectSound(body, what);
        EXPECT_NEAR(result.cut_area_m2, polygon.areaVector().norm(), 1e-12) << what;
        EXPECT_EQ(result.pieces_after, polygon.areaVector().norm() == 1 ? 2 : 1) << what;
        EXPECT_EQ(result.cells_left_whole, 0) << what;
      }
    }
  }
}

TEST_P(FlatBlade, LeavesTheTissueAroundItWhole) {
  // Its border lies just within the surface, and then by less than the snap distance.
  for (const double margin : {0.3, 0.1, 0.06, 0.02, 1e-3, 1e-6}) {
    Sheet sheet;
    sheet.origin.z() = 0.47;
    PolyhedralMesh body = mesh();
    const double near = margin * kH, far = 1 - near;
    const CutResult result = cut(body, {sheet.polygon(rectangle(near, near, far, far))});
    expectSound(body, std::to_string(margin));
    EXPECT_EQ(result.cells_left_whole, 0);
    EXPECT_EQ(result.pieces_after, margin > CuttingConfig().snap_tolerance ? 1 : 2) << margin;
  }
}

TEST_P(FlatBlade, MayBeSmallerThanACell) {
  for (const double size : {0.8, 0.4, 0.2, 0.1}) {
    Sheet sheet;
    sheet.origin = Vector3d(0.507, 0.511, 0.503);
    sheet.axes = Eigen::AngleAxisd(0.4, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const double half = 0.5 * size * kH;
    PolyhedralMesh body = mesh();
    const PolygonCut polygon = sheet.polygon(rectangle(-half, -half, half, half));
    const CutResult result = cut(body, {polygon});
    ASSERT_EQ(result.status, CutStatus::kCut) << size;
    expectSound(body, std::to_string(size));
    EXPECT_EQ(result.pieces_after, 1) << size;
    EXPECT_LT(lagOf(body, polygon).at_corners, 0.2 * kH) << size;
  }
}

TEST_P(FlatBlade, DividesNothingMoreWhenItCutsAgain) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const Sheet sheet = someSheet(random);
    const PolygonCut polygon = sheet.polygon(someOutline(random, uniform(random, 0.2, 0.7)));
    PolyhedralMesh body = mesh();
    cut(body, {polygon});
    const int cells = body.numCells(), vertices = body.numVertices();
    const CutResult again = cut(body, {polygon});
    EXPECT_NE(again.status, CutStatus::kCut) << "seed " << seed << ": " << again.message;
    EXPECT_EQ(body.numCells(), cells) << "seed " << seed;
    EXPECT_EQ(body.numVertices(), vertices) << "seed " << seed;
  }
}

TEST_P(FlatBlade, PartsTheBodyWithOthersThatMeetItsBorder) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const Sheet sheet = someSheet(random);
    // Sectors around a point within: each alone leaves the body in one piece, all of them part it.
    const int n = std::uniform_int_distribution<int>(3, 6)(random);
    const double turn = uniform(random, 0, 2 * M_PI);
    const auto corner = [&](int i) {
      const double angle = turn + 2 * M_PI * i / n;
      return Vector2d(5 * std::cos(angle), 5 * std::sin(angle));
    };
    std::vector<CutOperation> sectors;
    for (int i = 0; i < n; ++i) sectors.push_back(sheet.polygon({{0, 0}, corner(i), corner(i + 1)}));
    PolyhedralMesh body = mesh();
    const CutResult all_but_one = cut(body, std::vector<CutOperation>(sectors.begin(), sectors.end() - 1));
    EXPECT_EQ(all_but_one.pieces_after, 1) << "seed " << seed;
    body = mesh();
    const CutResult result = cut(body, sectors);
    expectSound(body, "seed " + std::to_string(seed));
    EXPECT_EQ(result.pieces_after, 2) << "seed " << seed << ", " << n << " sectors: " << result.message;
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, FlatBlade, testing::Bool(),
                         [](const auto& info) { return info.param ? "Tetrahedra" : "Hexahedra"; });

}  // namespace
}  // namespace polyscalpel
