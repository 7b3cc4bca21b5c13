// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/mesh_checks.hpp"

#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

// A PolyhedralMesh cannot be broken through its interface; these tests reach behind it.
Face& face(PolyhedralMesh& mesh, int id) {
  return const_cast<Face&>(mesh.face(FaceId(id)));
}
Cell& cell(PolyhedralMesh& mesh, int id) {
  return const_cast<Cell&>(mesh.cell(CellId(id)));
}
std::vector<FaceId>& facesAround(PolyhedralMesh& mesh, int id) {
  return const_cast<std::vector<FaceId>&>(mesh.facesAround(VertexId(id)));
}
double* coordinates(PolyhedralMesh& mesh, int id) {
  return const_cast<double*>(mesh.restPositions().col(id).data());
}

PolyhedralMesh makeBlock() {
  return makeHexBox({0, 0, 0}, {2, 2, 2}, {2, 2, 2});
}

/// Whether one of the violations after the damage has the text in it.
testing::AssertionResult isReported(const std::string& text,
                                    const std::function<void(PolyhedralMesh&)>& damage) {
  PolyhedralMesh mesh = makeBlock();
  if (!checkMesh(mesh).empty()) return testing::AssertionFailure() << "violations before the damage";
  damage(mesh);
  std::string all;
  for (const std::string& violation : checkMesh(mesh)) {
    if (violation.find(text) != std::string::npos) return testing::AssertionSuccess();
    all += violation + "\n";
  }
  return testing::AssertionFailure() << "\"" << text << "\" is not among:\n" << all;
}

TEST(CheckMesh, ReportsBrokenLoops) {
  EXPECT_TRUE(
      isReported("face 3: a vertex occurs twice", [](auto& m) { face(m, 3).loop[1] = face(m, 3).loop[0]; }));
  EXPECT_TRUE(isReported("face 3: 2 vertices", [](auto& m) { face(m, 3).loop.resize(2); }));
  EXPECT_TRUE(
      isReported("face 3: vertex 99 does not exist", [](auto& m) { face(m, 3).loop[1] = VertexId(99); }));
  EXPECT_TRUE(isReported("face 3: 3 corner flags for 4", [](auto& m) { face(m, 3).is_corner.pop_back(); }));
  EXPECT_TRUE(isReported("face 3: fewer than 3 corners", [](auto& m) {
    face(m, 3).is_corner = {1, 0, 1, 0};
  }));
  EXPECT_TRUE(isReported("face 3: negative cut", [](auto& m) { face(m, 3).cut = -1; }));
}

TEST(CheckMesh, ReportsOpenAndWronglyOrientedCells) {
  EXPECT_TRUE(isReported("twice in the same direction",
                         [](auto& m) { std::reverse(face(m, 3).loop.begin(), face(m, 3).loop.end()); }));
  EXPECT_TRUE(isReported("cell 0: open at edge", [](auto& m) { cell(m, 0).faces.pop_back(); }));
  EXPECT_TRUE(
      isReported("cell 0: open at edge", [](auto& m) { std::swap(face(m, 3).loop[1], face(m, 3).loop[2]); }));
}

TEST(CheckMesh, ReportsListsThatDisagree) {
  EXPECT_TRUE(isReported("not listed by its cell 0", [](auto& m) { cell(m, 0).faces.pop_back(); }));
  EXPECT_TRUE(
      isReported("cell 0: lists a face twice", [](auto& m) { cell(m, 0).faces[0] = cell(m, 0).faces[1]; }));
  EXPECT_TRUE(
      isReported("cell 0: its vertices are not those", [](auto& m) { cell(m, 0).vertices.pop_back(); }));
  EXPECT_TRUE(isReported("cell 0: its vertices are not those",
                         [](auto& m) { std::swap(cell(m, 0).vertices[0], cell(m, 0).vertices[1]); }));
  EXPECT_TRUE(isReported("does not list it", [](auto& m) { face(m, 3).cells[0] = CellId(7); }));
  EXPECT_TRUE(isReported("cell 99 does not exist", [](auto& m) { face(m, 3).cells[1] = CellId(99); }));
  EXPECT_TRUE(
      isReported("the same cell on both sides", [](auto& m) { face(m, 3).cells[1] = face(m, 3).cells[0]; }));
  EXPECT_TRUE(isReported("not listed by its vertex 0", [](auto& m) { facesAround(m, 0).pop_back(); }));
  EXPECT_TRUE(isReported("vertex 0: lists a face twice",
                         [](auto& m) { facesAround(m, 0)[0] = facesAround(m, 0)[1]; }));
  EXPECT_TRUE(isReported("vertex 0: not used", [](auto& m) { facesAround(m, 0).clear(); }));
  EXPECT_TRUE(isReported("whose loop is without it",
                         [](auto& m) { facesAround(m, 0).push_back(facesAround(m, 26)[0]); }));
  EXPECT_TRUE(isReported("which does not exist", [](auto& m) { facesAround(m, 0).emplace_back(999); }));
  EXPECT_TRUE(isReported("mesh: counts 8 cells, but has 7", [](auto& m) { cell(m, 0).faces.clear(); }));
  EXPECT_TRUE(isReported("removed, but has vertices", [](auto& m) { cell(m, 0).faces.clear(); }));
}

TEST(CheckMesh, ReportsBadShapes) {
  EXPECT_TRUE(isReported("position is not finite", [](auto& m) { coordinates(m, 13)[1] = kInfinity; }));
  // The vertex in the middle drawn beyond a corner folds cells; onto one, it flattens them.
  EXPECT_TRUE(isReported("smallest sub-tet -", [](auto& m) { std::fill_n(coordinates(m, 13), 3, -1.0); }));
  EXPECT_TRUE(isReported("smallest sub-tet", [](auto& m) { std::fill_n(coordinates(m, 13), 3, 0.0); }));
}

TEST(CheckMesh, ReportsBodiesThatHangTogetherByAVertexAlone) {
  // Two tetrahedra apart, whose vertices 1 and 4 then become one, as a cut might do that forgets to copy a
  // vertex.
  Eigen::Matrix3Xd points(3, 8);
  points << 0, 1, 0, 0, 3, 4, 3, 3,  //
      0, 0, 1, 0, 0, 0, 1, 0,        //
      0, 0, 0, 1, 0, 0, 0, 1;
  const auto tet = [](int a, int b, int c, int d) {
    return PolyhedralMesh::CellLoops{{a, c, b}, {a, b, d}, {b, c, d}, {a, d, c}};
  };
  PolyhedralMesh mesh(points, {tet(0, 1, 2, 3), tet(4, 5, 6, 7)});
  ASSERT_TRUE(checkMesh(mesh).empty());
  const VertexId shared(1);
  const VertexId replaced(4);
  for (const FaceId id : facesAround(mesh, 4)) {
    FaceLoop& loop = face(mesh, id.index()).loop;
    std::replace(loop.begin(), loop.end(), replaced, shared);
    facesAround(mesh, 1).push_back(id);
  }
  cell(mesh, 1).vertices = {shared, VertexId(5), VertexId(6), VertexId(7)};
  // Vertex 4 has become free: hung into the edge (0, 2), it leaves nothing else to complain about.
  facesAround(mesh, 4).clear();
  std::fill_n(coordinates(mesh, 4), 3, 0.0);
  coordinates(mesh, 4)[1] = 0.5;
  for (const FaceId id : mesh.cell(CellId(0)).faces) {
    Face& changed = face(mesh, id.index());
    for (std::size_t i = 0; i < changed.loop.size(); ++i) {
      const VertexId start = changed.loop[i];
      const VertexId end = changed.loop[(i + 1) % changed.loop.size()];
      if (std::min(start, end) != VertexId(0) || std::max(start, end) != VertexId(2)) continue;
      changed.loop.insert(changed.loop.begin() + i + 1, replaced);
      changed.is_corner.insert(changed.is_corner.begin() + i + 1, 0);
      facesAround(mesh, 4).push_back(id);
      break;
    }
  }
  cell(mesh, 0).vertices = {VertexId(0), shared, VertexId(2), VertexId(3), replaced};
  const std::vector<std::string> violations = checkMesh(mesh);
  ASSERT_EQ(violations.size(), 1u) << violations.front();
  EXPECT_EQ(violations[0],
            "vertex 1: its cells are not all joined through faces (1 of 2 reached from cell 0)");
}

}  // namespace
}  // namespace polyscalpel
