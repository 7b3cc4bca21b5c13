// SPDX-License-Identifier: BSD-3-Clause
#include "support/study_meshes.hpp"

#include <set>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

const Eigen::Vector3d kLowest(0.1, -0.2, 0.3), kSize(1, 0.8, 0.6);
const Eigen::Vector3i kCounts(5, 4, 3);

class StudyMesh : public testing::TestWithParam<BodyKind> {};

TEST_P(StudyMesh, FillsItsBoxSoundly) {
  const PolyhedralMesh mesh = makeStudyMesh(GetParam(), kLowest, kSize, kCounts, 4);
  const std::vector<std::string> violations = checkMesh(mesh);
  EXPECT_TRUE(violations.empty()) << violations.size() << ", " << violations.front();
  EXPECT_TRUE(fillsBox(mesh, kLowest, kSize));
  EXPECT_NEAR(volume(mesh, mesh.restPositions()), kSize.prod(), 1e-12 * kSize.prod());
  const Eigen::Vector3d lowest = mesh.restPositions().rowwise().minCoeff();
  const Eigen::Vector3d highest = mesh.restPositions().rowwise().maxCoeff();
  EXPECT_LT((lowest - kLowest).norm(), 1e-15);
  EXPECT_LT((highest - kLowest - kSize).norm(), 1e-15);
}

TEST_P(StudyMesh, ComesOutTheSameAgain) {
  const PolyhedralMesh first = makeStudyMesh(GetParam(), kLowest, kSize, kCounts, 4);
  const PolyhedralMesh second = makeStudyMesh(GetParam(), kLowest, kSize, kCounts, 4);
  EXPECT_EQ(first.restPositions(), second.restPositions());
  EXPECT_EQ(first.numCells(), second.numCells());
}

INSTANTIATE_TEST_SUITE_P(Kinds, StudyMesh,
                         testing::Values(BodyKind::kHexahedra, BodyKind::kTetrahedra, BodyKind::kVoronoi,
                                         BodyKind::kSlicedHexahedra, BodyKind::kSlicedTetrahedra));

TEST(VoronoiBox, HasACellForEverySeedAndNoShortEdges) {
  const PolyhedralMesh mesh = makeVoronoiBox(kLowest, kSize, kCounts);
  EXPECT_EQ(mesh.numCells(), kCounts.prod());
  std::set<std::size_t> numbers_of_faces;
  for (const CellId cell : mesh.cells()) {
    numbers_of_faces.insert(mesh.cell(cell).faces.size());
    for (const auto& [a, b] : mesh.edges(cell))
      EXPECT_GT((mesh.restPosition(a) - mesh.restPosition(b)).norm(),
                0.99 * VoronoiCells::kShortestEdge * 0.2);
  }
  EXPECT_GT(numbers_of_faces.size(), 5u);
}

TEST(Glued, JoinsWhatACutHasParted) {
  const PolyhedralMesh mesh = makeHexBox(kLowest, kSize, kCounts);
  const PolyhedralMesh open = slicedOpen(mesh, makeRandomPlanes(kLowest, kSize, 3));
  const PolyhedralMesh closed = glued(open);
  EXPECT_GT(findPieces(open).count, 1);
  EXPECT_FALSE(fillsBox(open, kLowest, kSize));
  EXPECT_EQ(findPieces(closed).count, 1);
  EXPECT_EQ(closed.numCells(), open.numCells());
  EXPECT_LT(closed.numVertices(), open.numVertices());
  EXPECT_GT(closed.numCells(), mesh.numCells());
}

}  // namespace
}  // namespace polyscalpel
