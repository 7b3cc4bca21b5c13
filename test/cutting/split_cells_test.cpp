// SPDX-License-Identifier: BSD-3-Clause
//
// Cells of every shape that earlier cuts leave are split by what passes them.
#include "polyscalpel/cutting/split_cells.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "support/torture.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Vertex at a point, which must be there.
VertexId vertexAt(const PolyhedralMesh& mesh, const Vector3d& point) {
  for (int i = 0; i < mesh.numVertices(); ++i) {
    if (mesh.restPosition(VertexId(i)) == point) return VertexId(i);
  }
  throw std::logic_error("no vertex there");
}

TEST(SplitCells, AVertexBetweenTwoCornersOfTheCutInOneEdgeJoinsIt) {
  // A cube with a vertex in its edge along z and a chord from there, as a cut through a neighbour leaves
  // them. A plane that passes the edge within the snap distance crosses other edges at the edge's ends, and
  // none at that vertex.
  for (const double off : {0.001, 0.02, 0.04}) {
    PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d::Ones(), {1, 1, 1});
    MeshEditor editor(mesh);
    const VertexId from = vertexAt(mesh, {0, 0, 0}), to = vertexAt(mesh, {0, 0, 1});
    const VertexId between = editor.splitEdge(from, to, 0.5);
    const VertexId beyond = editor.splitEdge(vertexAt(mesh, {1, 0, 0}), vertexAt(mesh, {1, 0, 1}), 0.5);
    for (const FaceId id : std::vector<FaceId>(mesh.facesAround(between))) {
      const auto& around = mesh.facesAround(beyond);
      if (std::find(around.begin(), around.end(), id) != around.end()) editor.splitFace(id, between, beyond);
    }
    editor.commit();
    ASSERT_TRUE(checkMesh(mesh).empty()) << checkMesh(mesh).front();

    const Matrix3Xd positions = mesh.restPositions();
    const PlaneCut plane{Vector3d(0, off, 0), Vector3d(1, -1, 0)};
    const CutResult result = cutMesh(mesh, positions, plane, CuttingConfig(), 1);
    EXPECT_EQ(result.cells_left_whole, 0) << off;
    EXPECT_EQ(result.pieces_after, 2) << off;
    EXPECT_TRUE(checkMesh(mesh).empty()) << off;
  }
}

TEST(SplitCells, WhatRandomCutsPassComesApart) {
  // Bodies in which caps had facets in the plane of a part's own faces, and in which parts up to twice as
  // thick as the snap distance joined the cut although a division would have had them come apart.
  const std::vector<TortureSubject> subjects = tortureSubjects(TortureSize::kSmall);
  struct Body {
    std::string name;
    unsigned seed;
    int cuts;
  };
  for (const Body& body : std::vector<Body>{
           {"block", 3, 25}, {"block", 13, 25}, {"block", 31, 17}, {"block", 37, 18}, {"ball", 6, 17}}) {
    for (const TortureSubject& subject : subjects) {
      if (subject.name != body.name) continue;
      TorturePlan plan;
      plan.first_seed = body.seed;
      plan.cuts_per_body = body.cuts;
      std::vector<TortureFailure> failures;
      for (const TortureRow& row : torture(subject, plan, failures)) {
        EXPECT_EQ(row.left_whole, 0) << body.name << ", seed " << body.seed << ": " << row.kind;
        EXPECT_EQ(row.pieces_missing, 0) << body.name << ", seed " << body.seed << ": " << row.kind;
        EXPECT_EQ(row.invalid, 0) << body.name << ", seed " << body.seed << ": " << row.kind;
      }
    }
  }
}

}  // namespace
}  // namespace polyscalpel
