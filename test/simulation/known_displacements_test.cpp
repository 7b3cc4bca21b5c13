// SPDX-License-Identifier: BSD-3-Clause
//
// The meshes with known answers by every kind of solver. Their folder is named by POLYSCALPEL_TEST_MESHES.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "support/reference_scenes.hpp"

namespace polyscalpel {
namespace {

struct Case {
  const char* mesh;
  SolverKind kind;
};
std::string nameOf(const testing::TestParamInfo<Case>& info) {
  return info.param.mesh + std::string("_") + toString(info.param.kind);
}

class KnownDisplacements : public testing::TestWithParam<Case> {};

TEST_P(KnownDisplacements, AreReached) {
  const char* const folder = std::getenv("POLYSCALPEL_TEST_MESHES");
  if (!folder) GTEST_SKIP() << "POLYSCALPEL_TEST_MESHES is not set: " << GetParam().mesh << " is not checked";
  const bool is_direct = GetParam().kind == SolverKind::kDirect;
  SimulationConfig config = referenceScene(folder, GetParam().mesh);
  config.solver.kind = GetParam().kind;
  Simulation simulation(config);
  const DisplacementsByStep expected =
      GetParam().mesh == std::string("bunny8k") ? bunnyDisplacements() : beamDisplacements();
  // reference_test.cpp has the other steps of a factor.
  const int num_steps = is_direct ? 10 : 60;
  const double largest_error = is_direct ? 1e-6 : 1e-4;
  for (int step = 1; step <= num_steps; ++step) {
    const StepReport report = simulation.step({});
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_EQ(report.solver.fallbacks, 0);
    if (GetParam().kind != SolverKind::kAuto) {
      EXPECT_EQ(report.solver.kind, GetParam().kind);
    }
    const auto found = expected.find(step);
    if (found == expected.end()) continue;
    const double largest =
        (simulation.positions() - simulation.mesh().restPositions()).colwise().norm().maxCoeff();
    EXPECT_NEAR(largest, found->second, largest_error * found->second) << "step " << step;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Solvers, KnownDisplacements,
    testing::Values(Case{"bunny8k", SolverKind::kDirect}, Case{"bunny8k", SolverKind::kFactor},
                    Case{"bunny8k", SolverKind::kAggregates}, Case{"bunny8k", SolverKind::kAuto},
                    Case{"beam10k", SolverKind::kDirect}, Case{"beam10k", SolverKind::kFactor},
                    Case{"beam10k", SolverKind::kAggregates}, Case{"beam10k", SolverKind::kAuto}),
    nameOf);

}  // namespace
}  // namespace polyscalpel
