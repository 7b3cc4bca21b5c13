// SPDX-License-Identifier: BSD-3-Clause
//
// Closed surfaces that readMesh() fills with tetrahedra.
#include <array>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "mesh_io_testing.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"

namespace polyscalpel {
namespace {

using SurfaceFill = MeshIo;

/// The box [0, size]^3 (or with its lowest corner elsewhere) as 12 triangles.
struct TriangleBox {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;

  void add(const Eigen::Vector3d& lowest, double size, bool inward) {
    const int first = static_cast<int>(points.size());
    for (int c = 0; c < 8; ++c) {
      points.push_back(lowest + size * Eigen::Vector3d(c & 1, c >> 1 & 1, c >> 2 & 1));
    }
    const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                             {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : quads) {
      triangles.push_back({first + q[0], first + q[1], first + q[2]});
      triangles.push_back({first + q[0], first + q[2], first + q[3]});
      if (!inward) continue;
      std::swap(triangles[triangles.size() - 1][1], triangles[triangles.size() - 1][2]);
      std::swap(triangles[triangles.size() - 2][1], triangles[triangles.size() - 2][2]);
    }
  }

  std::string toOff() const {
    std::ostringstream text;
    text << "OFF\n" << points.size() << " " << triangles.size() << " 0\n";
    for (const auto& p : points) text << p.transpose() << "\n";
    for (const auto& t : triangles) text << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
    return text.str();
  }

  std::string toObj() const {
    std::ostringstream text;
    for (const auto& p : points) text << "v " << p.transpose() << "\n";
    for (const auto& t : triangles) text << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    return text.str();
  }

  std::string toTextStl() const {
    std::ostringstream text;
    text << "solid box\n";
    for (const auto& t : triangles) {
      text << "facet normal 0 0 0\nouter loop\n";
      for (const int c : t) text << "vertex " << points[c].transpose() << "\n";
      text << "endloop\nendfacet\n";
    }
    text << "endsolid box\n";
    return text.str();
  }

  std::string toBinaryStl() const {
    std::string bytes = "solid is how this binary file begins";
    bytes.resize(80, '\0');
    const auto count = static_cast<std::uint32_t>(triangles.size());
    append(bytes, &count, 4);
    for (const auto& t : triangles) {
      float numbers[12] = {0, 0, 0};
      for (int c = 0; c < 9; ++c) numbers[3 + c] = static_cast<float>(points[t[c / 3]](c % 3));
      append(bytes, numbers, 48);
      bytes.append(2, '\0');
    }
    return bytes;
  }

  std::string plyHeader(const std::string& format) const {
    return "ply\nformat " + format + " 1.0\ncomment a box\nelement vertex " + std::to_string(points.size()) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
           std::to_string(triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  }

  std::string toTextPly() const {
    std::ostringstream text;
    text << plyHeader("ascii");
    for (const auto& p : points) text << p.transpose() << "\n";
    for (const auto& t : triangles) text << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
    return text.str();
  }

  std::string toBinaryPly() const {
    std::string bytes = plyHeader("binary_little_endian");
    for (const auto& p : points) {
      const Eigen::Vector3f single = p.cast<float>();
      append(bytes, single.data(), 12);
    }
    for (const auto& t : triangles) {
      bytes += '\3';
      const std::int32_t corners[3] = {t[0], t[1], t[2]};
      append(bytes, corners, 12);
    }
    return bytes;
  }
};

TriangleBox makeBox() {
  TriangleBox box;
  box.add({0, 0, 0}, 1, false);
  return box;
}

double meanEdgeLength(const PolyhedralMesh& mesh) {
  double sum = 0;
  int count = 0;
  for (const CellId cell : mesh.cells()) {
    for (const auto& [a, b] : mesh.edges(cell)) {
      sum += (mesh.restPosition(a) - mesh.restPosition(b)).norm();
      ++count;
    }
  }
  return sum / count;
}

TEST_F(SurfaceFill, FillsAClosedSurfaceOfAnyFormat) {
  const TriangleBox box = makeBox();
  const std::pair<const char*, std::string> kFiles[] = {
      {"box.off", box.toOff()},          {"box.obj", box.toObj()},      {"text.stl", box.toTextStl()},
      {"binary.stl", box.toBinaryStl()}, {"text.ply", box.toTextPly()}, {"binary.ply", box.toBinaryPly()}};
  for (const auto& [name, bytes] : kFiles) {
    const MeshFile file = read(name, bytes, 0.25);
    EXPECT_EQ(checkMesh(file.mesh), std::vector<std::string>()) << name;
    EXPECT_NEAR(totalVolume(file.mesh), 1, 1e-9) << name;
    EXPECT_EQ(findPieces(file.mesh).count, 1) << name;
    EXPECT_GT(file.mesh.numCells(), 100) << name;
    for (const CellId cell : file.mesh.cells()) EXPECT_EQ(file.mesh.cell(cell).faces.size(), 4u);
  }
}

TEST_F(SurfaceFill, CellsHaveTheGivenSize) {
  for (const double size : {0.4, 0.2, 0.1}) {
    const MeshFile file = read("box.off", makeBox().toOff(), size);
    // The surface's edges come from halving, so the mean is met within a factor of sqrt(2).
    EXPECT_GT(meanEdgeLength(file.mesh), size / std::sqrt(2.0));
    EXPECT_LT(meanEdgeLength(file.mesh), size * std::sqrt(2.0));
    EXPECT_TRUE(file.remarks.empty()) << joined(file.remarks);
  }
  // 12 triangles with edges 1, 1 and sqrt(2): the size when none is given.
  const MeshFile coarse = read("box.off", makeBox().toOff());
  EXPECT_LT(coarse.mesh.numCells(), 60);
  EXPECT_TRUE(contains(joined(read("box.off", makeBox().toOff(), 5).remarks), "the surface keeps its edges"));
  EXPECT_TRUE(contains(refusal("box.off", makeBox().toOff(), 1e-4), "cell_size_m = 0.0001"));
}

TEST_F(SurfaceFill, ShellsInsideOthersAreCavities) {
  TriangleBox box;
  box.add({0, 0, 0}, 3, false);
  box.add({1, 1, 1}, 1, true);
  EXPECT_NEAR(totalVolume(read("cavity.off", box.toOff(), 0.6).mesh), 26, 1e-8);
  // A body in the cavity, and one beside.
  box.add({1.25, 1.25, 1.25}, 0.5, false);
  box.add({4, 0, 0}, 1, false);
  const MeshFile three = read("three.off", box.toOff(), 0.6);
  EXPECT_NEAR(totalVolume(three.mesh), 26 + 0.125 + 1, 1e-8);
  EXPECT_EQ(findPieces(three.mesh).count, 3);
  EXPECT_TRUE(contains(joined(three.remarks), "3 unconnected bodies"));
  EXPECT_EQ(checkMesh(three.mesh), std::vector<std::string>());
}

TEST_F(SurfaceFill, TurnsOverASurfaceThatFacesInward) {
  TriangleBox box;
  box.add({0, 0, 0}, 1, true);
  const MeshFile file = read("inward.obj", box.toObj(), 0.5);
  EXPECT_NEAR(totalVolume(file.mesh), 1, 1e-9);
  EXPECT_TRUE(contains(joined(file.remarks), "faces inward"));
}

TEST_F(SurfaceFill, RefusesSurfacesThatEncloseNothing) {
  TriangleBox open = makeBox();
  open.triangles.pop_back();
  EXPECT_TRUE(contains(refusal("open.stl", open.toTextStl()), "not closed: 3 open edges"));
  EXPECT_TRUE(contains(refusal("open.obj", open.toObj()), "not closed"));
  TriangleBox turned = makeBox();
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_TRUE(contains(refusal("turned.off", turned.toOff()), "not oriented alike"));
  TriangleBox nested;
  nested.add({0, 0, 0}, 3, false);
  nested.add({1, 1, 1}, 1, false);
  EXPECT_TRUE(contains(refusal("nested.off", nested.toOff()), "oriented against the others"));
  TriangleBox crossing;
  crossing.add({0, 0, 0}, 1, false);
  crossing.add({0.5, 0.4, 0.3}, 1, false);
  EXPECT_NE(refusal("crossing.off", crossing.toOff(), 0.5), "");
  EXPECT_TRUE(
      contains(refusal("pillow.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n"), "no volume"));
  EXPECT_TRUE(contains(refusal("short.stl", makeBox().toBinaryStl().substr(0, 600)), "truncated"));
  EXPECT_TRUE(contains(refusal("short.ply", makeBox().toBinaryPly().substr(0, 340)), "short.ply"));
}

TEST_F(SurfaceFill, FillingIsReproducible) {
  const MeshFile a = read("box.off", makeBox().toOff(), 0.3);
  const MeshFile b = read("box.off", makeBox().toOff(), 0.3);
  ASSERT_EQ(a.mesh.numVertices(), b.mesh.numVertices());
  EXPECT_EQ(a.mesh.restPositions(), b.mesh.restPositions());
}

TEST_F(SurfaceFill, IsSilentAndLeavesSignalsAndLocaleAlone) {
  struct sigaction before;
  struct sigaction after;
  ASSERT_EQ(sigaction(SIGINT, nullptr, &before), 0);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  read("box.off", makeBox().toOff(), 0.5);
  refusal("bad.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n");
  refusal("bad.off", makeBox().toOff().substr(0, 100));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  ASSERT_EQ(sigaction(SIGINT, nullptr, &after), 0);
  EXPECT_EQ(before.sa_handler, after.sa_handler);
}

}  // namespace
}  // namespace polyscalpel
