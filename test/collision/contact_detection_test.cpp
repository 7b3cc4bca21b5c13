// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/collision/contact_detection.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "collision/tool_files.hpp"
#include "polyscalpel/collision/triangle_contact.hpp"
#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/geometry/triangle.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

constexpr double kMargin = 1e-3;

std::vector<ShapeConfig> allShapes() {
  std::vector<ShapeConfig> shapes(4);
  shapes[0].kind = ShapeKind::kSphere;
  shapes[1].kind = ShapeKind::kCapsule;
  shapes[2].kind = ShapeKind::kBox;
  shapes[2].size_m = {0.02, 0.0004, 0.03};
  shapes[3].kind = ShapeKind::kCylinder;
  for (ShapeConfig& shape : shapes) {
    shape.T_tool_shape.translation() = Eigen::Vector3d(0, 0.002, 0.01);
    shape.T_tool_shape.linear() = Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  }
  return shapes;
}

Eigen::Isometry3d randomPose(std::mt19937& generator) {
  std::uniform_real_distribution<double> number(-1, 1);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d axis(number(generator), number(generator), number(generator));
  pose.linear() = Eigen::AngleAxisd(3 * number(generator), axis.normalized()).matrix();
  pose.translation() = 0.05 * Eigen::Vector3d(number(generator), number(generator), number(generator));
  return pose;
}

/// A smooth bend of everything, without inversions.
Eigen::Matrix3Xd bend(const Eigen::Matrix3Xd& points, double amount) {
  Eigen::Matrix3Xd result = points;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    result(0, i) += amount * std::sin(40 * points(1, i));
    result(2, i) += amount * std::cos(30 * points(0, i)) + 0.01;
  }
  return result;
}

void expectSame(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].face, b[i].face);
    EXPECT_EQ(a[i].gap_m, b[i].gap_m);
    EXPECT_EQ(a[i].area_m2, b[i].area_m2);
    EXPECT_EQ(a[i].point_world, b[i].point_world);
    EXPECT_EQ(a[i].normal_world, b[i].normal_world);
  }
}

/// Compares two surfaces of the same mesh by what they find for all shapes in random poses; returns the
/// contacts found.
std::size_t compare(const PolyhedralMesh& mesh, const Eigen::Matrix3Xd& positions, const TissueSurface& a,
                    const TissueSurface& b, unsigned seed) {
  std::mt19937 generator(seed);
  std::size_t found = 0;
  for (const ShapeConfig& config : allShapes()) {
    const ToolShape shape(config);
    for (int trial = 0; trial < 30; ++trial) {
      const Eigen::Isometry3d pose = randomPose(generator);
      const std::vector<Contact> contacts = a.findContacts(mesh, positions, shape, pose, kMargin);
      expectSame(contacts, b.findContacts(mesh, positions, shape, pose, kMargin));
      found += contacts.size();
    }
  }
  return found;
}

TEST(ContactDetectionTest, TreesMissNoTriangleThatATestOfAllOfThemFinds) {
  const PolyhedralMesh mesh = makeTetBall(Eigen::Vector3d::Zero(), 0.05, 4);
  const Eigen::Matrix3Xd positions = mesh.restPositions();
  const TissueSurface surface(mesh, positions);
  std::mt19937 generator(5);
  std::size_t found = 0;
  for (const ShapeConfig& config : allShapes()) {
    const ToolShape shape(config);
    const ConvexShape convex(config);
    for (int trial = 0; trial < 40; ++trial) {
      const Eigen::Isometry3d pose = randomPose(generator);
      const Eigen::Isometry3d T_shape_world = (pose * config.T_tool_shape).inverse();
      std::vector<TriangleContact> all;
      for (int i = 0; i < mesh.faceCapacity(); ++i) {
        const Face& face = mesh.face(FaceId(i));
        if (!face.isAlive() || !face.isBoundary()) continue;
        for (int k = 0; k < numTriangles(face); ++k) {
          appendContacts(convex, T_shape_world * triangleCorners(face, k, positions), kMargin, all);
        }
      }
      const std::vector<Contact> contacts = surface.findContacts(mesh, positions, shape, pose, kMargin);
      ASSERT_EQ(contacts.size(), all.size());
      for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_DOUBLE_EQ(contacts[i].gap_m, all[i].gap);
        EXPECT_DOUBLE_EQ(contacts[i].area_m2, all[i].area);
        // The weights give the contact point back.
        Eigen::Vector3d point = Eigen::Vector3d::Zero();
        double sum = 0;
        for (const WeightedVertex& weighted : contacts[i].weights) {
          point += weighted.weight * positions.col(weighted.vertex.index());
          sum += weighted.weight;
        }
        EXPECT_NEAR(sum, 1, 1e-12);
        EXPECT_LT((point - contacts[i].point_world).norm(), 1e-12);
        EXPECT_NEAR(contacts[i].normal_world.norm(), 1, 1e-12);
        EXPECT_TRUE(i == 0 || !(contacts[i].face < contacts[i - 1].face));
      }
      found += all.size();
    }
  }
  EXPECT_GT(found, 500u);
}

TEST(ContactDetectionTest, RefitAfterMotionEqualsAFreshSurface) {
  const PolyhedralMesh mesh = makeTetBall(Eigen::Vector3d::Zero(), 0.05, 5);
  TissueSurface surface(mesh, mesh.restPositions());
  for (const double amount : {0.005, -0.02, 0.0}) {
    const Eigen::Matrix3Xd positions = bend(mesh.restPositions(), amount);
    surface.refit(mesh, positions);
    EXPECT_GT(compare(mesh, positions, surface, TissueSurface(mesh, positions), 11), 200u);
  }
}

/// A plane through the middle of the ball, another one for each number of the cut.
CutResult cutAcross(PolyhedralMesh& mesh, int cut) {
  const PlaneCut plane{{0.003, 0.001 * cut, -0.002}, {std::cos(cut), std::sin(cut), 0.3 * cut}};
  return cutMesh(mesh, mesh.restPositions(), plane, CuttingConfig(), cut);
}

TEST(ContactDetectionTest, UpdateAfterCutsEqualsAFreshSurface) {
  PolyhedralMesh mesh = makeTetBall(Eigen::Vector3d::Zero(), 0.05, 4);
  TissueSurface surface(mesh, mesh.restPositions());
  for (int cut = 1; cut <= 4; ++cut) {
    const CutResult result = cutAcross(mesh, cut);
    ASSERT_EQ(result.status, CutStatus::kCut);
    surface.update(mesh, result.change, mesh.restPositions());
    EXPECT_GT(compare(mesh, mesh.restPositions(), surface, TissueSurface(mesh, mesh.restPositions()), cut),
              200u);
  }
}

TEST(ContactDetectionTest, UpdateAfterCutsOfAMovedBodyAndARefitEqualsAFreshSurface) {
  PolyhedralMesh mesh = makeTetBall(Eigen::Vector3d::Zero(), 0.05, 4);
  TissueSurface surface(mesh, mesh.restPositions());
  for (int cut = 1; cut <= 4; ++cut) {
    const CutResult result = cutAcross(mesh, cut);
    ASSERT_EQ(result.status, CutStatus::kCut);
    const Eigen::Matrix3Xd positions = bend(mesh.restPositions(), 0.002 * cut);
    surface.update(mesh, result.change, positions);
    surface.refit(mesh, positions);
    EXPECT_GT(compare(mesh, positions, surface, TissueSurface(mesh, positions), 20 + cut), 200u);
  }
}

/// Sum of area * overlap * normal: the force per stiffness on the tissue.
Eigen::Vector3d overlapOf(const PolyhedralMesh& mesh, const ShapeConfig& config,
                          const Eigen::Isometry3d& pose) {
  const TissueSurface surface(mesh, mesh.restPositions());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Contact& contact :
       surface.findContacts(mesh, mesh.restPositions(), ToolShape(config), pose, kMargin)) {
    if (contact.gap_m < 0) sum -= contact.area_m2 * contact.gap_m * contact.normal_world;
  }
  return sum;
}

/// A block of 6 x 6 x 2 cm under z = 0.
PolyhedralMesh block(int n, bool tetrahedra) {
  const Eigen::Vector3d lowest(-0.03, -0.03, -0.02), size(0.06, 0.06, 0.02);
  const Eigen::Vector3i counts(n, n, 1 + n / 24);
  return tetrahedra ? makeTetBox(lowest, size, counts) : makeHexBox(lowest, size, counts);
}

TEST(ContactDetectionTest, ForceOfAFlatToolDoesNotDependOnTheMesh) {
  ShapeConfig config;
  config.kind = ShapeKind::kBox;
  config.size_m = {0.02, 0.0135, 0.01};
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0.0012, -0.0023, 0.005 - 2e-4);
  const Eigen::Vector3d expected(0, 0, -0.02 * 0.0135 * 2e-4);
  for (const int n : {1, 4, 9, 20, 40}) {
    for (const bool tetrahedra : {false, true}) {
      const Eigen::Vector3d overlap = overlapOf(block(n, tetrahedra), config, pose);
      // Beneath the tool's border triangles of less than the depth can be pushed aside instead of down.
      EXPECT_LT((overlap - expected).norm(), 0.02 * expected.norm()) << n;
    }
  }
}

/// Limit of overlapOf() for a sphere of radius r, its centre d above a plane of ever smaller triangles: each
/// is pushed along its radius rho by r - rho and seen under the cosine d / rho, so the part along z is int (r
/// - rho) (d / rho)^2 dA = 2 pi d^2 int_d^r (r - rho) / rho d rho.
double sphereLimit(double r, double d) {
  return 2 * M_PI * d * d * (r * std::log(r / d) - (r - d));
}

TEST(ContactDetectionTest, ForceOfASphereConvergesUnderRefinement) {
  ShapeConfig config;
  config.kind = ShapeKind::kSphere;
  config.radius_m = 0.01;
  for (const double depth : {0.001, 0.002}) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = Eigen::Vector3d(0.0012, -0.0023, config.radius_m - depth);
    const double limit = sphereLimit(config.radius_m, config.radius_m - depth);
    double last_error = 1;
    for (const int n : {4, 8, 16, 32, 64}) {
      const Eigen::Vector3d overlap = overlapOf(block(n, true), config, pose);
      const double error = std::abs(-overlap.z() / limit - 1);
      EXPECT_LT(error, 0.25);  // triangles five times the patch: no more than the overlapped cap
      EXPECT_LE(error, last_error);
      last_error = error;
    }
    EXPECT_LT(last_error, 0.05);
  }
}

TEST(ContactDetectionTest, MeshToolFeelsLikeThePrimitiveItWasMadeFrom) {
  ShapeConfig primitive;
  primitive.kind = ShapeKind::kSphere;
  primitive.radius_m = 0.01;
  const ToolFile file(".stl", ToolShape(primitive).triangles());
  ShapeConfig mesh_tool;
  mesh_tool.kind = ShapeKind::kMesh;
  mesh_tool.path = file.path();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0.0012, -0.0023, 0.008);
  // The inscribed polyhedron lacks up to 0.5 % of the radius, 2.4 % of the depth; the force grows with its
  // square.
  const double limit = sphereLimit(0.01, 0.008);
  for (const int n : {4, 16, 48}) {
    EXPECT_NEAR(-overlapOf(block(n, true), mesh_tool, pose).z(), limit, 0.06 * limit) << n;
  }
}

TEST(ContactDetectionTest, ToolAwayFromTheTissueFindsNothing) {
  const PolyhedralMesh mesh = block(4, false);
  const TissueSurface surface(mesh, mesh.restPositions());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (const double z : {0.1, 0.0063, -0.01}) {  // far, just beyond the margin, inside the body
    pose.translation().z() = z;
    ShapeConfig config;
    config.radius_m = 0.005;
    EXPECT_TRUE(surface.findContacts(mesh, mesh.restPositions(), ToolShape(config), pose, kMargin).empty());
  }
}

TEST(ContactDetectionTest, EmptyMeshHasNoContacts) {
  const PolyhedralMesh mesh;
  const Eigen::Matrix3Xd positions(3, 0);
  TissueSurface surface(mesh, positions);
  surface.refit(mesh, positions);
  EXPECT_TRUE(
      surface.findContacts(mesh, positions, ToolShape(ShapeConfig()), Eigen::Isometry3d::Identity(), kMargin)
          .empty());
}

}  // namespace
}  // namespace polyscalpel
