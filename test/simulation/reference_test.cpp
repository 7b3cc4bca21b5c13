// SPDX-License-Identifier: BSD-3-Clause
//
// Largest vertex displacement of bodies released under gravity, on which two independent codes agree to 6 to
// 7 digits: VegaFEM 4 with a direct solver, and SOFA's fast corotational tetrahedra. E = 1e5 Pa, nu = 0.45,
// rho = 1000 kg/m^3, g = 9.81 m/s^2 along -y, steps of 1/60 s, consistent mass, no damping.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel {
namespace {

SimulationConfig referenceScene(const MeshConfig& mesh, const FixedRegion& fixed) {
  SimulationConfig config;
  config.mesh = mesh;
  config.fixed = {fixed};
  config.material = {1e5, 0.45, 1000};
  config.element.consistent_mass = true;
  config.integration.time_step_s = 1.0 / 60;
  config.integration.mass_damping_per_s = 0;
  config.integration.stiffness_damping_s = 0;
  config.integration.gravity_m_s2 = {0, -9.81, 0};
  return config;
}

void expectDisplacements(Simulation& simulation, const std::map<int, double>& expected) {
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
  Simulation simulation(referenceScene(box, FixedBox{{0, 0, 0}, {0, 0.1, 0.1}}));
  EXPECT_EQ(simulation.mesh().numVertices(), 2673);
  EXPECT_EQ(simulation.mesh().numCells(), 10240);
  EXPECT_EQ(std::count(simulation.fixedVertices().begin(), simulation.fixedVertices().end(), true), 81);
  expectDisplacements(simulation, {{1, 2.792432e-3}, {5, 4.915587e-2}, {10, 1.898572e-1}, {60, 2.204128e-1}});
}

TEST(Reference, Bunny8k) {
  const char* const folder = std::getenv("POLYSCALPEL_TEST_MESHES");
  if (!folder) GTEST_SKIP() << "POLYSCALPEL_TEST_MESHES is not set: bunny8k is not checked";
  const std::string name = std::string(folder) + "/bunny8k";
  std::ifstream file(name + ".fix");
  ASSERT_TRUE(file) << name << ".fix";
  FixedVertices fixed;
  for (int vertex = 0; file >> vertex;) fixed.vertices.push_back(vertex);
  ASSERT_TRUE(file.eof() && !fixed.vertices.empty());
  Simulation simulation(referenceScene(MeshFileConfig{name + ".msh", 1, 0}, fixed));
  EXPECT_EQ(simulation.mesh().numVertices(), 2341);
  EXPECT_EQ(simulation.mesh().numCells(), 8275);
  expectDisplacements(simulation, {{1, 1.415654e-3}, {5, 2.485235e-3}, {10, 2.429002e-3}, {60, 2.411976e-3}});
}

}  // namespace
}  // namespace polyscalpel
