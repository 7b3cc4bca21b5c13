// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/field_colours.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

PolyhedralMesh block() {
  return makeHexBox({0, 0, 0}, {3, 3, 3}, {3, 3, 3});
}

/// A block of 27 hexahedra, cut into two pieces of polyhedra.
PolyhedralMesh cutBlock() {
  PolyhedralMesh mesh = block();
  const Eigen::Matrix3Xd positions = mesh.restPositions();
  const CutResult result = cutMesh(mesh, positions, PlaneCut{{1.4, 0, 0}, {1, 0.3, 0.1}}, CuttingConfig(), 1);
  EXPECT_EQ(result.status, CutStatus::kCut);
  return mesh;
}

/// L* of CIE 1976 of a colour in sRGB (IEC 61966-2-1).
double lightness(const Eigen::Vector3d& rgb) {
  const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  const double y = 0.2126 * linear(rgb(0)) + 0.7152 * linear(rgb(1)) + 0.0722 * linear(rgb(2));
  return y > 0.008856 ? 116 * std::cbrt(y) - 16 : 903.3 * y;
}

visualization_msgs::Marker colouredMarker(const PolyhedralMesh& mesh, const SurfaceTriangles& triangles,
                                          const Eigen::VectorXd& values, const Eigen::Vector2d& range_pa) {
  visualization_msgs::Marker marker = makeTriangleMarker(triangles, Eigen::Vector4d(1, 0, 0, 0.5));
  colourByValues(marker, mesh, triangles, values, range_pa);
  return marker;
}

TEST(FieldColours, LargerValuesAreLighter) {
  double before = lightness(mapColour(0));
  EXPECT_NEAR(before, 17, 1);
  for (int i = 1; i <= 100; ++i) {
    const double now = lightness(mapColour(i / 100.0));
    // Equal steps would be (96 - 17) / 100.
    EXPECT_GT(now - before, 0.4) << i;
    EXPECT_LT(now - before, 1.3) << i;
    before = now;
  }
  EXPECT_NEAR(before, 96, 1);
}

TEST(FieldColours, TheMapIsContinuousAndEndsAtItsEnds) {
  for (int i = 0; i < 1000; ++i)
    EXPECT_LT((mapColour((i + 1) / 1000.0) - mapColour(i / 1000.0)).norm(), 0.005) << i;
  EXPECT_EQ(mapColour(-1), mapColour(0));
  EXPECT_EQ(mapColour(2), mapColour(1));
  EXPECT_NE(mapColour(0), mapColour(1));
}

TEST(FieldColours, ValuesAtVerticesAreThoseOfTheStress) {
  const PolyhedralMesh mesh = block();
  StressField field;
  field.vertex_stresses = SymmetricTensors::Zero(6, mesh.numVertices());
  field.vertex_stresses.row(2).setConstant(-3);  // pressure along z
  field.vertex_stresses(0, 5) = 7;               // and tension along x at one vertex
  const Eigen::VectorXd equivalent = vertexValues(mesh, field, ColourBy::kVonMises);
  const Eigen::VectorXd principal = vertexValues(mesh, field, ColourBy::kMaxPrincipal);
  ASSERT_EQ(equivalent.size(), mesh.numVertices());
  EXPECT_NEAR(equivalent(4), 3, 1e-12);
  EXPECT_NEAR(principal(4), 0, 1e-12);
  EXPECT_NEAR(equivalent(5), std::sqrt(7 * 7 + 3 * 3 + 7 * 3), 1e-12);
  EXPECT_NEAR(principal(5), 7, 1e-12);
}

TEST(FieldColours, ErrorsAreEnergyOverVolume) {
  // Cells of the same energy density d: error^2 = d V, whatever their shape and size.
  const PolyhedralMesh mesh = cutBlock();
  StressField field;
  field.cells = mesh.cells();
  field.cell_errors.resize(static_cast<Eigen::Index>(field.cells.size()));
  for (std::size_t i = 0; i < field.cells.size(); ++i)
    field.cell_errors[static_cast<Eigen::Index>(i)] =
        std::sqrt(2.5 * volume(makeCellSurface(mesh, field.cells[i], mesh.restPositions())));
  const Eigen::VectorXd same = vertexValues(mesh, field, ColourBy::kError);
  ASSERT_EQ(same.size(), mesh.numVertices());
  EXPECT_LT((same.array() - 2.5).abs().maxCoeff(), 1e-12);

  // A single cell with an error: the mean over the cells around each of its vertices.
  const PolyhedralMesh whole = block();
  field.cells = whole.cells();
  field.cell_errors = Eigen::VectorXd::Zero(27);
  field.cell_errors(0) = 2;  // unit cube at the corner of the block
  const Eigen::VectorXd one = vertexValues(whole, field, ColourBy::kError);
  EXPECT_NEAR(one.maxCoeff(), 4, 1e-12) << "the block's own corner: one cell";
  EXPECT_NEAR(one.sum(), 4 * (1 + 3.0 / 2 + 3.0 / 4 + 1.0 / 8), 1e-12);
}

TEST(FieldColours, RangeIsAsAskedForOrThatOfTheValues) {
  const Eigen::VectorXd values = Eigen::Vector4d(3, -1, 8, 2);
  EXPECT_EQ(colourRange(values, {0, 0}), Eigen::Vector2d(-1, 8));
  EXPECT_EQ(colourRange(values, {0, 5}), Eigen::Vector2d(0, 5));
  EXPECT_EQ(describeColours(ColourBy::kVonMises, {0, 1234.4}), "von Mises stress 0 to 1234 Pa");
  EXPECT_EQ(describeColours(ColourBy::kMaxPrincipal, {-20, 5}), "largest principal stress -20 to 5 Pa");
  EXPECT_EQ(describeColours(ColourBy::kError, {0, 0.5}), "error energy density 0 to 0.5 Pa");
}

TEST(FieldColours, CornersShowTheirOwnValues) {
  // A field that is linear in space takes its own value at each corner, virtual vertices too, but for the
  // shade.
  const PolyhedralMesh mesh = cutBlock();
  const Eigen::Vector3d slope(0.2, 0.1, -0.15);
  const Eigen::VectorXd values = mesh.restPositions().transpose() * slope;
  const Eigen::Vector2d range(-0.5, 1);
  for (const bool cut_faces : {false, true}) {
    const SurfaceTriangles triangles = makeSurfaceTriangles(mesh, mesh.restPositions(), cut_faces);
    ASSERT_FALSE(triangles.corners.empty());
    const visualization_msgs::Marker marker = colouredMarker(mesh, triangles, values, range);
    ASSERT_EQ(marker.colors.size(), marker.points.size());
    for (std::size_t i = 0; i < marker.points.size(); ++i) {
      const Eigen::Vector3d point(marker.points[i].x, marker.points[i].y, marker.points[i].z);
      const Eigen::Vector3d expected = mapColour((point.dot(slope) - range(0)) / (range(1) - range(0)));
      const Eigen::Vector3d shown(marker.colors[i].r, marker.colors[i].g, marker.colors[i].b);
      const double shade = shown.norm() / expected.norm();
      EXPECT_GE(shade, 0.7 - 1e-6);
      EXPECT_LE(shade, 1 + 1e-6);
      EXPECT_LT((shown - shade * expected).norm(), 1e-6);
      EXPECT_EQ(marker.colors[i].a, 0.5f);
    }
  }
}

TEST(FieldColours, EqualValuesTakeTheFirstColour) {
  const PolyhedralMesh mesh = block();
  const SurfaceTriangles triangles = makeSurfaceTriangles(mesh, mesh.restPositions(), false);
  const Eigen::VectorXd values = Eigen::VectorXd::Zero(mesh.numVertices());
  const visualization_msgs::Marker marker =
      colouredMarker(mesh, triangles, values, colourRange(values, {0, 0}));
  for (const std_msgs::ColorRGBA& colour : marker.colors) {
    EXPECT_LE(colour.r, mapColour(0)(0) + 1e-6);
    EXPECT_GT(colour.b, colour.r);
  }
}

}  // namespace
}  // namespace polyscalpel
