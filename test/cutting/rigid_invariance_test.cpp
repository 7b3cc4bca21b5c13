// SPDX-License-Identifier: BSD-3-Clause
//
// Away from ties a cut depends on the body and the blade alone, not on where both lie.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "support/placement.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::Vector3i;

/// Three of the cuts of these kinds, none of which is aimed at a tie.
std::vector<CutOperation> someCuts(const PolyhedralMesh& mesh, const std::vector<std::string>& names,
                                   TortureRandom& random) {
  const TortureBody body("body", mesh, true);
  std::vector<CutOperation> cuts;
  while (cuts.size() < 3) {
    const std::string& name = names[std::uniform_int_distribution<std::size_t>(0, names.size() - 1)(random)];
    for (const TortureKind& kind : tortureKinds()) {
      if (kind.name == name) cuts.push_back(makeTortureCut(kind, body, nullptr, random).operation);
    }
  }
  return cuts;
}

const std::vector<std::string> kAtOnce = {"plane", "polygon"};
const std::vector<std::string> kStrokes = {"stroke straight through", "stroke curved through",
                                           "stroke twisted at coarse steps", "stroke that stops inside",
                                           "stroke in and out by another way"};

std::vector<double> pieceVolumes(const PolyhedralMesh& mesh) {
  const Pieces pieces = findPieces(mesh);
  std::vector<double> volumes(pieces.count, 0);
  for (const CellId id : mesh.cells())
    volumes[pieces.piece_of_cell[id.index()]] += volume(makeCellSurface(mesh, id, mesh.restPositions()));
  std::sort(volumes.begin(), volumes.end());
  return volumes;
}

CutResult cut(PolyhedralMesh& mesh, const CutOperation& operation, int number) {
  const Matrix3Xd positions = mesh.restPositions();
  const CutResult result = cutMesh(mesh, positions, operation, CuttingConfig(), number);
  EXPECT_TRUE(checkMesh(mesh).empty());
  return result;
}

std::vector<PolyhedralMesh> bodies() {
  std::vector<PolyhedralMesh> all;
  all.push_back(Placement()(makeTetBall(Vector3d::Zero(), 1, 2)));
  all.push_back(Placement()(makeHexBox(Vector3d::Zero(), Vector3d::Ones(), Vector3i::Constant(3))));
  return all;
}

/// Turns bodies and cuts of these kinds together and expects the same mesh loop by loop, its vertices within
/// a distance [m].
void expectSameMeshTurned(const std::vector<std::string>& kinds, double largest_difference) {
  for (const PolyhedralMesh& body : bodies()) {
    for (unsigned seed = 1; seed <= 12; ++seed) {
      TortureRandom random(seed);
      const std::vector<CutOperation> cuts = someCuts(body, kinds, random);
      const Placement placement = somePlacement(random, false);
      PolyhedralMesh here = body, there = placement(body);
      for (std::size_t i = 0; i < cuts.size(); ++i) {
        const CutResult result_here = cut(here, cuts[i], static_cast<int>(i) + 1);
        const CutResult result_there = cut(there, placement(cuts[i]), static_cast<int>(i) + 1);
        ASSERT_EQ(result_here.cells_split, result_there.cells_split) << "seed " << seed << ", cut " << i;
        ASSERT_EQ(here.numVertices(), there.numVertices());
        ASSERT_EQ(here.cellCapacity(), there.cellCapacity());
        ASSERT_EQ(here.faceCapacity(), there.faceCapacity());
        for (int f = 0; f < here.faceCapacity(); ++f) {
          ASSERT_EQ(here.face(FaceId(f)).loop, there.face(FaceId(f)).loop)
              << "seed " << seed << ", face " << f;
          ASSERT_EQ(here.face(FaceId(f)).cells, there.face(FaceId(f)).cells) << "seed " << seed;
        }
      }
      const Matrix3Xd placed = (placement.linear * here.restPositions()).colwise() + placement.shift;
      EXPECT_LT((placed - there.restPositions()).cwiseAbs().maxCoeff(), largest_difference)
          << "seed " << seed;
    }
  }
}

TEST(RigidInvariance, MeshAndFlatBladeTurnedTogetherGiveTheSameMeshLoopByLoop) {
  expectSameMeshTurned(kAtOnce, 1e-12);
}

TEST(RigidInvariance, MeshAndStrokeTurnedTogetherGiveTheSameMeshLoopByLoop) {
  // A long blade that turns has sub-steps a thousand times shorter than it is long: by so much less are the
  // planes of its triangles known, whose edges rounding moves by 1e-16 m.
  expectSameMeshTurned(kStrokes, 1e-11);
}

/// Cuts a body and its image by the same cuts and expects as many of everything, and pieces of the same
/// volumes but for a difference [m^3].
void expectSameCounts(const PolyhedralMesh& body, const std::vector<CutOperation>& cuts,
                      const Placement& placement, double largest_difference) {
  PolyhedralMesh here = body, there = placement(body);
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const CutResult result_here = cut(here, cuts[i], static_cast<int>(i) + 1);
    const CutResult result_there = cut(there, placement(cuts[i]), static_cast<int>(i) + 1);
    EXPECT_EQ(result_here.cells_split, result_there.cells_split) << "cut " << i;
    EXPECT_EQ(result_here.cells_left_whole, result_there.cells_left_whole) << "cut " << i;
    EXPECT_EQ(here.numVertices(), there.numVertices()) << "cut " << i;
    EXPECT_EQ(here.numCells(), there.numCells()) << "cut " << i;
    const std::vector<double> volumes_here = pieceVolumes(here), volumes_there = pieceVolumes(there);
    ASSERT_EQ(volumes_here.size(), volumes_there.size()) << "cut " << i;
    for (std::size_t p = 0; p < volumes_here.size(); ++p)
      EXPECT_NEAR(volumes_here[p], volumes_there[p], largest_difference) << "cut " << i;
  }
}

TEST(RigidInvariance, MirroredMeshAndBladeGiveAsManyOfEverything) {
  // A bent cap of a cell that is nearly flat may be divided into facets in several ways that are as good as
  // each other, of which one is found first when the loop runs the other way round.
  for (const auto& [kinds, largest_difference] :
       {std::make_pair(kAtOnce, 1e-12), std::make_pair(kStrokes, 1e-4)}) {
    for (const PolyhedralMesh& body : bodies()) {
      for (unsigned seed = 1; seed <= 12; ++seed) {
        SCOPED_TRACE(kinds.front() + ", seed " + std::to_string(seed));
        TortureRandom random(seed);
        const std::vector<CutOperation> cuts = someCuts(body, kinds, random);
        expectSameCounts(body, cuts, somePlacement(random, true), largest_difference);
      }
    }
  }
}

TEST(RigidInvariance, AtTiesThePiecesAreTheSame) {
  const PolyhedralMesh block =
      Placement()(makeHexBox(Vector3d::Zero(), Vector3d::Constant(3), Vector3i::Constant(3)));
  const std::vector<PlaneCut> ties = {{{1, 1, 1}, {1, 0, 0}},
                                      {{1, 1, 1}, {1, 1, 0}},
                                      {{1, 1, 1}, {1, 1, 1}},
                                      {{2, 1, 1}, {1, -1, 0}},
                                      {{1.5, 1.5, 1.5}, {0, 1, 1}}};
  TortureRandom random(5);
  for (const PlaneCut& first : ties) {
    for (const PlaneCut& second : ties) {
      PolyhedralMesh here = block;
      cut(here, first, 1);
      const double area = cut(here, second, 2).cut_area_m2;
      const std::vector<double> expected = pieceVolumes(here);
      for (const bool is_mirrored : {false, true}) {
        const Placement placement = somePlacement(random, is_mirrored);
        PolyhedralMesh there = placement(block);
        cut(there, placement(first), 1);
        cut(there, placement(second), 2);
        const std::vector<double> volumes = pieceVolumes(there);
        ASSERT_EQ(volumes.size(), expected.size())
            << first.normal_world.transpose() << " and " << second.normal_world.transpose();
        for (std::size_t p = 0; p < volumes.size(); ++p)
          EXPECT_NEAR(volumes[p], expected[p], CuttingConfig().snap_tolerance * (area + 9));
      }
    }
  }
}

}  // namespace
}  // namespace polyscalpel
