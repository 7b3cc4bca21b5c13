// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/mesh_editing.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

PolyhedralMesh twoCubes() {
  return makeHexBox(Vector3d::Zero(), Vector3d(2, 1, 1), Vector3i(2, 1, 1));
}

/// Everything that can be seen of a mesh, to compare two states of it.
std::vector<int> snapshot(const PolyhedralMesh& mesh) {
  std::vector<int> all{mesh.numVertices(), mesh.numCells(), mesh.cellCapacity(), mesh.faceCapacity()};
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    const Face& face = mesh.face(FaceId(i));
    for (const VertexId v : face.loop) all.push_back(v.index());
    for (const char corner : face.is_corner) all.push_back(corner);
    all.insert(all.end(), {face.cells[0].index(), face.cells[1].index(), face.cut});
  }
  for (int i = 0; i < mesh.cellCapacity(); ++i) {
    for (const FaceId f : mesh.cell(CellId(i)).faces) all.push_back(f.index());
    for (const VertexId v : mesh.cell(CellId(i)).vertices) all.push_back(v.index());
  }
  for (int i = 0; i < mesh.numVertices(); ++i) {
    for (const FaceId f : mesh.facesAround(VertexId(i))) all.push_back(f.index());
    all.push_back(mesh.isRetired(VertexId(i)));
  }
  return all;
}

FaceId sharedFace(const PolyhedralMesh& mesh) {
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    if (!mesh.face(FaceId(i)).isBoundary()) return FaceId(i);
  }
  return FaceId();
}

TEST(MeshEditor, WithoutACommitEveryEditIsUndoneToTheBit) {
  PolyhedralMesh mesh = twoCubes();
  const auto before = snapshot(mesh);
  {
    MeshEditor editor(mesh);
    const Face shared = mesh.face(sharedFace(mesh));
    const VertexId a = editor.splitEdge(shared.loop[0], shared.loop[1], 0.5);
    const VertexId b = editor.splitEdge(shared.loop[2], shared.loop[3], 0.25);
    const auto parts = editor.splitFace(sharedFace(mesh), a, b);
    editor.openFace(parts.first, 1);
    for (const VertexId v : {a, b}) editor.separateVertex(v);
    EXPECT_NE(snapshot(mesh), before);
  }
  EXPECT_EQ(snapshot(mesh), before);
  EXPECT_TRUE(checkMesh(mesh).empty());
}

TEST(MeshEditor, OpeningTheSharedFaceMakesTwoPiecesWithVerticesOfTheirOwn) {
  PolyhedralMesh mesh = twoCubes();
  MeshEditor editor(mesh);
  const auto loop = mesh.face(sharedFace(mesh)).loop;
  editor.openFace(sharedFace(mesh), 3);
  for (const VertexId v : loop) editor.separateVertex(v);
  const MeshChange change = editor.commit();
  EXPECT_EQ(findPieces(mesh).count, 2);
  EXPECT_EQ(change.new_vertices.size(), 4u);
  EXPECT_EQ(change.changed_cells.size(), 2u);
  EXPECT_TRUE(change.new_cells.empty());
  for (const NewVertex& origin : change.new_vertices) {
    EXPECT_EQ(mesh.restPosition(origin.vertex), mesh.restPosition(origin.parents[0]));
  }
  EXPECT_TRUE(checkMesh(mesh).empty());
  EXPECT_EQ(volume(mesh, mesh.restPositions()), 2);
}

TEST(MeshEditor, AnEdgeWithinASlitOpensThoughBothItsEndsLieOnTheSlitsFront) {
  PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d(2, 2, 3), Vector3i(2, 2, 3));
  const auto vertexAt = [&](const Vector3d& point) {
    for (int i = 0; i < mesh.numVertices(); ++i) {
      if ((mesh.restPosition(VertexId(i)) - point).norm() < 1e-9) return VertexId(i);
    }
    return VertexId();
  };
  // The two faces in the plane x = 1 at the middle of the edge, which are all of a slit within the body.
  const VertexId a = vertexAt({1, 1, 1}), b = vertexAt({1, 1, 2});
  std::vector<FaceId> slit;
  for (const FaceId id : mesh.facesAround(a)) {
    const auto& loop = mesh.face(id).loop;
    const bool is_in_plane =
        std::all_of(loop.begin(), loop.end(), [&](VertexId v) { return mesh.restPosition(v).x() == 1; });
    if (is_in_plane && hasEdge(mesh.face(id), a, b)) slit.push_back(id);
  }
  ASSERT_EQ(slit.size(), 2u);

  MeshEditor editor(mesh);
  EXPECT_FALSE(editor.separateEdge(a, b)) << "all is closed as yet";
  std::vector<VertexId> opened;
  for (const FaceId id : slit) {
    opened.insert(opened.end(), mesh.face(id).loop.begin(), mesh.face(id).loop.end());
    editor.openFace(id, 1);
  }
  for (const VertexId v : opened) editor.separateVertex(v);
  EXPECT_EQ(numFansAroundEdge(mesh, a, b), 2);
  EXPECT_TRUE(editor.separateEdge(a, b));
  EXPECT_EQ(numFansAroundEdge(mesh, a, b), 0);
  const MeshChange change = editor.commit();
  ASSERT_GE(change.new_vertices.size(), 2u);
  const NewVertex& copy = change.new_vertices.back();
  EXPECT_EQ(copy.parents[0], copy.parents[1]);
  for (const VertexId middle : {copy.vertex, copy.parents[0]}) {
    EXPECT_EQ(mesh.restPosition(middle), Vector3d(1, 1, 1.5));
    EXPECT_EQ(numFansAroundEdge(mesh, a, middle), 1);
    EXPECT_EQ(cellsAroundEdge(mesh, a, middle).size(), 2u) << "one side of the slit";
  }
  EXPECT_TRUE(checkMesh(mesh).empty());
}

TEST(MeshEditor, AVertexHungIntoAnEdgeChangesNoVolumeAndCarriesNoVirtualVertex) {
  PolyhedralMesh mesh = twoCubes();
  MeshEditor editor(mesh);
  const Face shared = mesh.face(sharedFace(mesh));
  const VertexId middle = editor.splitEdge(shared.loop[0], shared.loop[1], 0.3);
  const MeshChange change = editor.commit();
  EXPECT_EQ(change.changed_cells.size(), 2u);
  EXPECT_DOUBLE_EQ(volume(mesh, mesh.restPositions()), 2);
  const Face& face = mesh.face(sharedFace(mesh));
  ASSERT_EQ(face.loop.size(), 5u);
  EXPECT_FALSE(face.is_corner[findInLoop(face, middle)]);
  EXPECT_NEAR((virtualVertex(face, mesh.restPositions()) - Vector3d(1, 0.5, 0.5)).norm(), 0, 1e-15);
  EXPECT_TRUE(checkMesh(mesh).empty());
}

/// Two cubes apart, cell 0 and cell 1.
PolyhedralMesh openedCubes() {
  PolyhedralMesh mesh = twoCubes();
  MeshEditor editor(mesh);
  const Face shared = mesh.face(sharedFace(mesh));
  editor.openFace(sharedFace(mesh), 1);
  for (const VertexId v : shared.loop) editor.separateVertex(v);
  editor.commit();
  return mesh;
}

TEST(MeshEditor, APieceTakenOutRetiresItsVerticesAndLeavesTheOtherAsItIs) {
  PolyhedralMesh mesh = openedCubes();
  ASSERT_EQ(findPieces(mesh).count, 2);
  const int num_vertices = mesh.numVertices(), num_faces = mesh.faceCapacity();
  const Cell kept = mesh.cell(CellId(0)), gone = mesh.cell(CellId(1));
  MeshEditor editor(mesh);
  editor.removeCells({CellId(1)});
  const MeshChange change = editor.commit();
  EXPECT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();
  EXPECT_EQ(mesh.numCells(), 1);
  EXPECT_EQ(mesh.numVertices(), num_vertices) << "ids are given for life";
  EXPECT_EQ(mesh.faceCapacity(), num_faces);
  EXPECT_FALSE(mesh.cell(CellId(1)).isAlive());
  EXPECT_EQ(mesh.cell(CellId(0)).vertices, kept.vertices);
  for (int i = 0; i < num_vertices; ++i) {
    const bool is_gone =
        std::find(gone.vertices.begin(), gone.vertices.end(), VertexId(i)) != gone.vertices.end();
    EXPECT_EQ(mesh.isRetired(VertexId(i)), is_gone);
    EXPECT_EQ(mesh.facesAround(VertexId(i)).empty(), is_gone);
  }
  EXPECT_EQ(change.retired_vertices, gone.vertices);
  EXPECT_EQ(change.removed_cells, std::vector<CellId>{CellId(1)});
  EXPECT_TRUE(change.new_cells.empty() && change.changed_cells.empty() && change.new_vertices.empty());
  std::vector<FaceId> faces = gone.faces;
  std::sort(faces.begin(), faces.end());
  EXPECT_EQ(change.changed_faces, faces);
  EXPECT_DOUBLE_EQ(volume(mesh, mesh.restPositions()), 1);
}

TEST(MeshEditor, ARemovalWithoutACommitIsUndoneToTheBit) {
  PolyhedralMesh mesh = openedCubes();
  const auto before = snapshot(mesh);
  {
    MeshEditor editor(mesh);
    editor.removeCells({CellId(0)});
    EXPECT_NE(snapshot(mesh), before);
  }
  EXPECT_EQ(snapshot(mesh), before);
  EXPECT_TRUE(checkMesh(mesh).empty());
}

TEST(MeshChange, ValuesAtNewVerticesFollowTheirParentsInOrder) {
  Eigen::Matrix3Xd values(3, 2);
  values << 0, 8, 0, 0, 0, 4;
  extendByNewVertices(
      {{VertexId(2), {VertexId(0), VertexId(1)}, 0.25}, {VertexId(3), {VertexId(2), VertexId(2)}, 0}},
      values);
  EXPECT_EQ(values.col(2), Vector3d(2, 0, 1));
  EXPECT_EQ(values.col(3), values.col(2));
}

}  // namespace
}  // namespace polyscalpel
