// SPDX-License-Identifier: BSD-3-Clause
//
// Random cuts of every kind, accumulating on one body, and what holds after each.
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/torture.hpp"

namespace polyscalpel {
namespace {

const std::vector<std::string> kPlanes = {"plane",
                                          "plane through a vertex",
                                          "plane through 2 vertices",
                                          "plane through 3 vertices",
                                          "plane along a face",
                                          "plane 1e-3 to 1e-15 h off",
                                          "plane hardly tilted against a face",
                                          "plane that snaps a whole face"};

/// Prints what failed: enough to do it again.
void expectNone(const std::vector<TortureFailure>& failures, const std::string& with) {
  for (const TortureFailure& failure : failures) {
    if (failure.what.find(with) == std::string::npos) continue;
    ADD_FAILURE() << failure.mesh << ", seed " << failure.seed << ", cut " << failure.cut << " ("
                  << failure.kind << "): " << failure.what;
  }
}

TEST(Torture, EveryCutOfEveryKindLeavesAValidMesh) {
  for (const TortureSubject& subject : tortureSubjects(TortureSize::kSmall)) {
    TorturePlan plan;
    plan.bodies = 2;
    std::vector<TortureFailure> failures;
    int splits = 0, left_whole = 0;
    for (const TortureRow& row : torture(subject, plan, failures)) {
      EXPECT_EQ(row.invalid, 0) << row.mesh << ": " << row.kind;
      // The plane that divides a cell whose cap would bend too much snaps within a tenth of the distance.
      EXPECT_GE(row.shortest_part, 0.1 * CuttingConfig().snap_tolerance * (1 - 1e-9))
          << row.mesh << ": " << row.kind
          << ": what is left of a divided edge is no shorter than the snap distance allows";
      EXPECT_LT(row.volume_error, 1e-12) << row.mesh << ": " << row.kind;
      splits += row.splits;
      left_whole += row.left_whole;
    }
    EXPECT_LE(left_whole, 1e-2 * splits) << "of " << splits << " splits";
    expectNone(failures, "violations");
  }
}

TEST(Torture, PolygonsWithinOneBodyLeaveItValid) {
  // Their borders divide cells that others have divided before: the hardest for the planes that close them.
  for (const TortureSubject& subject : tortureSubjects(TortureSize::kSmall)) {
    TorturePlan plan;
    plan.bodies = 20;
    plan.cuts_per_body = 10;
    plan.kinds = {"polygon"};
    std::vector<TortureFailure> failures;
    for (const TortureRow& row : torture(subject, plan, failures)) {
      EXPECT_EQ(row.invalid, 0) << row.mesh;
      EXPECT_EQ(row.pieces_missing, 0) << row.mesh;
      EXPECT_LT(row.volume_error, 1e-12) << row.mesh;
      EXPECT_LE(row.left_whole, 2e-3 * row.splits) << row.mesh << ": of " << row.splits << " splits";
    }
    expectNone(failures, "violations");
  }
}

TEST(Torture, WhatIsCutAgainIsNotTornWhereItWas) {
  // The last cut of each: planes among walls of earlier ones, where a component within the snap distance was
  // split off; a blade that turns at coarse steps, whose surface was not the one of finer steps.
  const std::pair<unsigned, int> kTorn[] = {{11, 18}, {33, 6}, {35, 11}, {83, 11}};
  for (const auto& [seed, num_cuts] : kTorn) {
    std::vector<TortureFailure> failures;
    torture(TortureSize::kUsual, "block", seed, num_cuts, failures);
    expectNone(failures, "torn");
  }
}

TEST(Torture, WedgesDrawnAgainAreNotCutAcross) {
  // In, out by another way, and once more: corners of both walls hold apart what lies between them.
  for (const unsigned seed : {4u, 27u, 35u}) {
    TorturePlan plan;
    plan.first_seed = seed;
    plan.cuts_per_body = 2;
    plan.kinds = {"stroke in and out by another way", "the last cut again, at other steps"};
    plan.may_deform = false;
    std::vector<TortureFailure> failures;
    const TortureSubject block = tortureSubjects(TortureSize::kUsual).front();
    torture(block, plan, failures);
    expectNone(failures, "");
  }
}

TEST(Torture, ABodyOfManyTetrahedraStaysValid) {
  const char* const folder = std::getenv("POLYSCALPEL_TEST_MESHES");
  if (!folder) GTEST_SKIP() << "POLYSCALPEL_TEST_MESHES is not set: bunny8k is not cut";
  const auto subjects = tortureSubjects(TortureSize::kUsual, std::string(folder) + "/bunny8k.msh");
  TorturePlan plan;
  plan.cuts_per_body = 4;
  std::vector<TortureFailure> failures;
  for (const TortureRow& row : torture(subjects.back(), plan, failures))
    EXPECT_EQ(row.invalid, 0) << row.kind;
  expectNone(failures, "violations");
}

TEST(Torture, TheFirstPlaneMakesThePiecesOfExactClipping) {
  for (const TortureSubject& subject : tortureSubjects(TortureSize::kSmall)) {
    for (const std::string& kind : kPlanes) {
      TorturePlan plan;
      plan.bodies = 6;
      plan.cuts_per_body = 1;
      plan.first_seed = 1000;
      plan.kinds = {kind};
      plan.may_deform = false;
      std::vector<TortureFailure> failures;
      for (const TortureRow& row : torture(subject, plan, failures)) {
        EXPECT_EQ(row.cuts, plan.bodies);
        EXPECT_EQ(row.left_whole, 0) << row.mesh << ": " << row.kind;
        EXPECT_LE(row.piece_volume_error, 1)
            << row.mesh << ": " << row.kind << ": volumes within the snap distance times the cut area";
        EXPECT_LT(row.volume_error, 1e-12) << row.mesh << ": " << row.kind;
      }
      expectNone(failures, "");
    }
  }
}

TEST(Torture, AClosedListOfKindsIsHeldTo) {
  TorturePlan plan;
  plan.kinds = {"plane", "no such kind"};
  EXPECT_THROW(TortureSequence(plan, 1), std::invalid_argument);
}

}  // namespace
}  // namespace polyscalpel
