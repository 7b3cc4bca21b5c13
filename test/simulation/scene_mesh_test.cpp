// SPDX-License-Identifier: BSD-3-Clause
//
// A scene whose mesh is not sound is refused when the simulation is made.
#include <gtest/gtest.h>

#include "mesh/mesh_io_testing.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "scenes.hpp"

namespace polyscalpel {
namespace {

/// A tetrahedron of the given height over a triangle with sides of 1 m.
std::string tetrahedron(const std::string& height_m) {
  return "MeshVersionFormatted 2\nDimension\n3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0.3 0.3 " + height_m +
         " 0\nTetrahedra\n1\n1 2 3 4 1\nEnd\n";
}

using SceneMesh = MeshIo;

TEST_F(SceneMesh, ACellThatDrownsInRoundingIsRefused) {
  SimulationConfig config;
  MeshFileConfig file;
  file.path = write("flat.mesh", tetrahedron("2e-9"));
  config.mesh = file;
  try {
    Simulation simulation(config);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(contains(error.what(), "flat.mesh"));
  }
  file.path = write("high.mesh", tetrahedron("0.5"));
  config.mesh = file;
  EXPECT_EQ(Simulation(config).mesh().numCells(), 1);
  EXPECT_TRUE(checkMesh(Simulation(config).mesh()).empty());
}

}  // namespace
}  // namespace polyscalpel
