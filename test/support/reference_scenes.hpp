// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies released under gravity on whose largest vertex displacement two independent codes agree to 6 to 7
// digits: VegaFEM 4 with a direct solver, and SOFA's fast corotational tetrahedra. E = 1e5 Pa, nu = 0.45,
// rho = 1000 kg/m^3, g = 9.81 m/s^2 along -y, steps of 1/60 s, consistent mass, no damping.
#pragma once

#include <fstream>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel {

/// Largest displacement of a vertex [m] after some numbers of steps.
using DisplacementsByStep = std::map<int, double>;

inline DisplacementsByStep beamDisplacements() {
  return {{1, 2.792432e-3}, {5, 4.915587e-2}, {10, 1.898572e-1}, {60, 2.204128e-1}};
}
inline DisplacementsByStep bunnyDisplacements() {
  return {{1, 1.415654e-3}, {5, 2.485235e-3}, {10, 2.429002e-3}, {60, 2.411976e-3}};
}

inline SimulationConfig referenceScene(const MeshConfig& mesh, const FixedRegion& fixed) {
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

/// A mesh file `name`.msh of a folder, with the vertices of `name`.fix held.
inline SimulationConfig referenceScene(const std::string& folder, const std::string& name) {
  std::ifstream file(folder + "/" + name + ".fix");
  EXPECT_TRUE(file) << folder << "/" << name << ".fix";
  FixedVertices fixed;
  for (int vertex = 0; file >> vertex;) fixed.vertices.push_back(vertex);
  EXPECT_TRUE(file.eof() && !fixed.vertices.empty());
  return referenceScene(MeshFileConfig{folder + "/" + name + ".msh", 1, 0}, fixed);
}

}  // namespace polyscalpel
