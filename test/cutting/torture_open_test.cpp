// SPDX-License-Identifier: BSD-3-Clause
//
// What random cuts of every kind, accumulating on one body, must not do besides leaving it valid.
#include <string>

#include <gtest/gtest.h>

#include "support/torture.hpp"

namespace polyscalpel {
namespace {

TEST(TortureCompleteness, NothingIsLeftWholeOrHangsTogetherAndTheVolumeIsKept) {
  for (const TortureSubject& subject : tortureSubjects(TortureSize::kSmall)) {
    TorturePlan plan;
    plan.bodies = 3;
    std::vector<TortureFailure> failures;
    for (const TortureRow& row : torture(subject, plan, failures)) {
      EXPECT_EQ(row.left_whole, 0) << row.mesh << ": " << row.kind;
      EXPECT_EQ(row.pieces_missing, 0) << row.mesh << ": " << row.kind;
      EXPECT_EQ(row.pieces_torn, 0) << row.mesh << ": " << row.kind;
      EXPECT_LT(row.volume_error, 1e-12) << row.mesh << ": " << row.kind;
    }
    for (const TortureFailure& failure : failures)
      ADD_FAILURE() << failure.mesh << ", seed " << failure.seed << ", cut " << failure.cut << " ("
                    << failure.kind << "): " << failure.what;
  }
}

TEST(TortureCompleteness, PlanesAloneDivideConvexBodiesAsTheyDivideSpace) {
  for (const TortureSubject& subject : tortureSubjects(TortureSize::kSmall)) {
    TorturePlan plan;
    plan.bodies = 4;
    plan.cuts_per_body = 12;
    plan.kinds = {"plane",
                  "plane through a vertex",
                  "plane through 2 vertices",
                  "plane through 3 vertices",
                  "plane along a face",
                  "plane 1e-3 to 1e-15 h off",
                  "plane hardly tilted against a face",
                  "plane that snaps a whole face"};
    plan.may_deform = false;
    std::vector<TortureFailure> failures;
    torture(subject, plan, failures);
    for (const TortureFailure& failure : failures)
      ADD_FAILURE() << failure.mesh << ", seed " << failure.seed << ", cut " << failure.cut << " ("
                    << failure.kind << "): " << failure.what;
  }
}

}  // namespace
}  // namespace polyscalpel
