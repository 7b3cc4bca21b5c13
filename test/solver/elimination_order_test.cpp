// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/elimination_order.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/solver/single_factor.hpp"
#include "support/body_system.hpp"
#include "support/small_bodies.hpp"

namespace polyscalpel {
namespace {

TEST(EliminationOrder, AddedVerticesFollowTheParentThatComesFirst) {
  const std::vector<int> order = {4, 0, 2, 1};  // 3 is fixed
  const std::vector<AddedVertex> added = {
      {5, {2, 0}, 0.5},                                      // 0 comes before 2
      {6, {1, 1}, 0},   {7, {3, 2}, 0.5}, {8, {5, 1}, 0.5},  // of an added vertex
      {9, {3, 3}, 0},                                        // of one that is not there
      {10, {4, 2}, 1},                                       // of 2 alone
  };
  EXPECT_EQ(followCuts(order, added), (std::vector<int>{9, 4, 0, 8, 5, 2, 10, 7, 1, 6}));
  EXPECT_EQ(followCuts(order, {}), order);
}

// Little worse than an order found anew, also after several cuts.
TEST(EliminationOrder, AFactorOfACutBodyStaysSparse) {
  PolyhedralMesh mesh = makeTetBeam(6);
  BodySystem system(mesh);
  std::vector<int> order;
  std::vector<AddedVertex> added;
  for (int cut = 0; cut <= 4; ++cut) {
    if (cut > 0) {
      const Eigen::Vector3d normal(1, 0.2 * cut, -0.3), point(0.1 * cut - 0.04, 0.05, 0.05);
      const CutResult result =
          cutMesh(mesh, mesh.restPositions(), PlaneCut{point, normal}, CuttingConfig(), cut);
      ASSERT_EQ(result.status, CutStatus::kCut) << result.message;
      system.follow(mesh, result.change);
      for (const AddedVertex& vertex : addedBy(result.change)) added.push_back(vertex);
    }
    DifferenceMatrix<double> matrix;
    system.assembleAtRest(matrix);
    const BlockPattern pattern = toBlockPattern(system.pattern());
    Blocks blocks;
    convert(system.pattern(), matrix, pattern, blocks);
    const std::vector<bool> fixed = system.fixed();
    SingleFactor anew;
    ASSERT_EQ(anew.factorise(pattern, blocks, fixed), SolveStatus::kSolved);
    if (cut == 0) {
      order = anew.order();
      continue;
    }
    std::vector<int> followed = followCuts(order, added);
    followed.erase(std::remove_if(followed.begin(), followed.end(), [&](int i) { return fixed[i]; }),
                   followed.end());
    std::vector<int> sorted = followed;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, system.active());
    SingleFactor inherited;
    ASSERT_EQ(inherited.factorise(pattern, blocks, fixed, SingleFactor::kAnySize, followed),
              SolveStatus::kSolved);
    EXPECT_LT(inherited.numValues(), 1.25 * anew.numValues()) << cut;

    const Eigen::Matrix3Xd b = someLoad(system, 3);
    Eigen::Matrix3Xf x = b.cast<float>(), expected = x;
    inherited.solve(x.data());
    anew.solve(expected.data());
    EXPECT_LT((x - expected).norm(), 1e-3F * expected.norm());
  }
}

}  // namespace
}  // namespace polyscalpel
