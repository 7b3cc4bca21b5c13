// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/collision/tool_shape.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "collision/tool_files.hpp"

namespace polyscalpel {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Properties {
  double volume = 0;
  double area = 0;
  Eigen::Vector3d area_vector = Eigen::Vector3d::Zero();
};

Properties propertiesOf(const Eigen::Matrix3Xd& triangles) {
  Properties result;
  for (Eigen::Index i = 0; i + 2 < triangles.cols(); i += 3) {
    const Eigen::Matrix3d corners = triangles.middleCols<3>(i);
    const Eigen::Vector3d a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(0);
    const Eigen::Vector3d vector = 0.5 * a.cross(b);
    EXPECT_GT(vector.norm(), 0);
    result.volume += corners.determinant() / 6;
    result.area += vector.norm();
    result.area_vector += vector;
  }
  return result;
}

ShapeConfig makeConfig(ShapeKind kind) {
  ShapeConfig config;
  config.kind = kind;
  config.radius_m = 0.003;
  config.length_m = 0.02;
  config.size_m = {0.01, 0.02, 0.0004};
  return config;
}

TEST(ToolShapeTest, DisplayTrianglesAreClosedOutwardAndCloseToTheShape) {
  const double r = 0.003, l = 0.02;
  const double ball = 4.0 / 3 * M_PI * r * r * r, rod = M_PI * r * r * l;
  const std::vector<std::pair<ShapeKind, double>> volumes = {{ShapeKind::kSphere, ball},
                                                             {ShapeKind::kCapsule, ball + rod},
                                                             {ShapeKind::kCylinder, rod},
                                                             {ShapeKind::kBox, 0.01 * 0.02 * 0.0004}};
  for (const auto& [kind, volume] : volumes) {
    const Properties properties = propertiesOf(ToolShape(makeConfig(kind)).triangles());
    EXPECT_LE(properties.volume, volume * (1 + 1e-12));
    EXPECT_GT(properties.volume, 0.97 * volume);
    EXPECT_LT(properties.area_vector.norm(), 1e-12 * properties.area);
  }
}

TEST(ToolShapeTest, TrianglesAreGivenInTheToolsFrame) {
  ShapeConfig config = makeConfig(ShapeKind::kBox);
  config.T_tool_shape.translation() = Eigen::Vector3d(1, 2, 3);
  config.T_tool_shape.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).matrix();
  const Eigen::Matrix3Xd triangles = ToolShape(config).triangles();
  EXPECT_LT((triangles.rowwise().maxCoeff() - Eigen::Vector3d(1.01, 2.005, 3.0002)).norm(), 1e-12);
  EXPECT_LT((triangles.rowwise().minCoeff() - Eigen::Vector3d(0.99, 1.995, 2.9998)).norm(), 1e-12);
}

TEST(ToolShapeTest, MeshFilesOfEveryTypeGiveTheSameShape) {
  const Eigen::Matrix3Xd box = ToolShape(makeConfig(ShapeKind::kBox)).triangles();
  for (const std::string extension : {".obj", ".off", ".ply", ".stl"}) {
    const ToolFile file(extension, box / 0.001);
    ShapeConfig config;
    config.kind = ShapeKind::kMesh;
    config.path = file.path();
    config.scale = 0.001;
    const Eigen::Matrix3Xd triangles = ToolShape(config).triangles();
    ASSERT_EQ(triangles.cols(), box.cols()) << extension;
    EXPECT_LT((triangles - box).cwiseAbs().maxCoeff(), 1e-9) << extension;
  }
}

void expectRefused(const ShapeConfig& config, const std::string& word) {
  try {
    const ToolShape shape(config);
    FAIL() << "accepted: " << word;
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    if (!config.path.empty()) {
      EXPECT_NE(std::string(error.what()).find(config.path), std::string::npos) << error.what();
    }
  }
}

TEST(ToolShapeTest, BadMeshFilesAreRefusedWithFileAndReason) {
  const Eigen::Matrix3Xd box = ToolShape(makeConfig(ShapeKind::kBox)).triangles();
  ShapeConfig config;
  config.kind = ShapeKind::kMesh;
  config.path = "/no/such/tool.stl";
  expectRefused(config, "no such file");
  {
    const ToolFile file(".off", box.leftCols(box.cols() - 3));
    config.path = file.path();
    expectRefused(config, "not closed");
  }
  {
    Eigen::Matrix3Xd inside_out = box;
    for (Eigen::Index i = 0; i < box.cols(); i += 3) inside_out.col(i).swap(inside_out.col(i + 1));
    const ToolFile file(".off", inside_out);
    config.path = file.path();
    expectRefused(config, "inside out");
  }
  {
    Eigen::Matrix3Xd mixed = box;
    mixed.col(0).swap(mixed.col(1));
    const ToolFile file(".off", mixed);
    config.path = file.path();
    expectRefused(config, "same direction");
  }
  {
    Eigen::Matrix3Xd flat(3, 6);
    flat.leftCols<3>().setIdentity();
    flat.rightCols<3>().setIdentity();
    flat.col(3).swap(flat.col(4));
    const ToolFile file(".off", flat);
    config.path = file.path();
    expectRefused(config, "inside out");  // closed, but of no volume
  }
  const std::vector<std::array<std::string, 3>> texts = {
      {".stl", "", "no triangles"},
      {".off", "OFF\n4 4 0\n0 0 0\n1 0 0\n", "cannot be read"},
      {".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "cannot be read"},
      {".off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", "no triangle"},
      {".xyz", "0 0 0\n", "unknown type"},
  };
  for (const auto& [extension, text, word] : texts) {
    const ToolFile file(extension, text);
    config.path = file.path();
    expectRefused(config, word);
  }
}

struct Bound {
  ShapeKind kind;
  std::string name;
  std::function<void(ShapeConfig&, double)> set;
};

TEST(ShapeConfigTest, EveryBoundIsHeld) {
  const std::vector<Bound> bounds = {
      {ShapeKind::kSphere, "radius_m", [](ShapeConfig& c, double v) { c.radius_m = v; }},
      {ShapeKind::kCapsule, "radius_m", [](ShapeConfig& c, double v) { c.radius_m = v; }},
      {ShapeKind::kCylinder, "radius_m", [](ShapeConfig& c, double v) { c.radius_m = v; }},
      {ShapeKind::kCapsule, "length_m", [](ShapeConfig& c, double v) { c.length_m = v; }},
      {ShapeKind::kCylinder, "length_m", [](ShapeConfig& c, double v) { c.length_m = v; }},
      {ShapeKind::kBox, "size_m[0]", [](ShapeConfig& c, double v) { c.size_m(0) = v; }},
      {ShapeKind::kBox, "size_m[1]", [](ShapeConfig& c, double v) { c.size_m(1) = v; }},
      {ShapeKind::kBox, "size_m[2]", [](ShapeConfig& c, double v) { c.size_m(2) = v; }},
      {ShapeKind::kMesh, "scale", [](ShapeConfig& c, double v) { c.scale = v; }},
  };
  for (const Bound& bound : bounds) {
    ShapeConfig config = makeConfig(bound.kind);
    if (bound.kind == ShapeKind::kMesh) config.path = "tool.stl";
    EXPECT_NO_THROW(validate(config));
    for (const double good : {1e-9, 1.0}) {
      bound.set(config, good);
      EXPECT_NO_THROW(validate(config)) << bound.name;
    }
    for (const double bad : {0.0, -1.0, kNaN, std::numeric_limits<double>::infinity()}) {
      bound.set(config, bad);
      try {
        validate(config);
        FAIL() << bound.name << " " << bad;
      } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find(bound.name), std::string::npos);
      }
    }
  }
  ShapeConfig config = makeConfig(ShapeKind::kMesh);
  EXPECT_THROW(validate(config), std::invalid_argument);  // no path
  config = makeConfig(ShapeKind::kSphere);
  config.kind = static_cast<ShapeKind>(17);
  EXPECT_THROW(validate(config), std::invalid_argument);
  config = makeConfig(ShapeKind::kSphere);
  config.T_tool_shape.translation().y() = kNaN;
  EXPECT_THROW(validate(config), std::invalid_argument);
  config.T_tool_shape = Eigen::Isometry3d::Identity();
  config.T_tool_shape.linear() *= 2;
  EXPECT_THROW(validate(config), std::invalid_argument);
  config.T_tool_shape.linear() = -Eigen::Matrix3d::Identity();
  EXPECT_THROW(validate(config), std::invalid_argument);
}

}  // namespace
}  // namespace polyscalpel
