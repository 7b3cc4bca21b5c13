// SPDX-License-Identifier: BSD-3-Clause
//
//
// The whole of a simulation against other codes, every step factored: solvers that iterate are held against
// the same numbers in known_displacements_test.cpp.
#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

#include "support/reference_scenes.hpp"

namespace polyscalpel {
namespace {

void expectDisplacements(Simulation& simulation, const DisplacementsByStep& expected) {
  for (int step = 1; step <= expected.rbegin()->first; ++step) {
    const StepReport report = simulation.step({});
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_LT(report.relative_residual, 1e-10);
    const auto found = expected.find(step);
    if (found == expected.end()) continue;
    const double largest =
        (simulation.positions() - simulation.mesh().restPositions()).colwise().norm().maxCoeff();
    EXPECT_NEAR(largest, found->second, 1e-4 * found->second) << "step " << step;
  }
}

TEST(Reference, Beam10k) {
  BoxMeshConfig box;
  box.size_m = {0.4, 0.1, 0.1};
  box.counts = {32, 8, 8};
  box.tetrahedra = true;
  SimulationConfig config = referenceScene(box, FixedBox{{0, 0, 0}, {0, 0.1, 0.1}});
  config.solver.kind = SolverKind::kDirect;
  Simulation simulation(config);
  EXPECT_EQ(simulation.mesh().numVertices(), 2673);
  EXPECT_EQ(simulation.mesh().numCells(), 10240);
  EXPECT_EQ(std::count(simulation.fixedVertices().begin(), simulation.fixedVertices().end(), true), 81);
  expectDisplacements(simulation, beamDisplacements());
}

TEST(Reference, Bunny8k) {
  const char* const folder = std::getenv("POLYSCALPEL_TEST_MESHES");
  if (!folder) GTEST_SKIP() << "POLYSCALPEL_TEST_MESHES is not set: bunny8k is not checked";
  SimulationConfig config = referenceScene(folder, "bunny8k");
  config.solver.kind = SolverKind::kDirect;
  Simulation simulation(config);
  EXPECT_EQ(simulation.mesh().numVertices(), 2341);
  EXPECT_EQ(simulation.mesh().numCells(), 8275);
  expectDisplacements(simulation, bunnyDisplacements());
}

}  // namespace
}  // namespace polyscalpel
