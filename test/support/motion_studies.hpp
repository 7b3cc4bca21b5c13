// SPDX-License-Identifier: BSD-3-Clause
//
// What motion keeps: energy of a pendulum, momentum and angular momentum of a body that flies.
#pragma once

#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/simulation/simulation.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"
#include "polyscalpel/simulation/time_integration.hpp"
#include "support/study_meshes.hpp"

namespace polyscalpel {

/// A soft bar of 0.2 x 0.04 x 0.04 m that lies level, hinged at an edge of one end, and is let go: it swings
/// through and bends. No damping but that of the time integration.
struct PendulumResult {
  /// Largest total energy above that at the start, over the energy scale; the lasting loss does not hide it.
  double largest_rise = 0;
  /// Largest rise from one step to the next, over the energy scale.
  double largest_rise_in_a_step = 0;
  double lowest_energy = 0;    ///< smallest total energy less that at the start, over the energy scale
  double energy_scale_j = 0;   ///< weight times half the length: what the swing turns from height into motion
  double largest_swing_m = 0;  ///< farthest way of the free end's lowest point below its start
};

inline SimulationConfig pendulumScene(bool tetrahedra, const ElementConfig& element, double time_step_s) {
  SimulationConfig config;
  BoxMeshConfig box;
  box.size_m = {0.2, 0.04, 0.04};
  box.counts = {10, 2, 2};
  box.tetrahedra = tetrahedra;
  config.mesh = box;
  config.material = {5e4, 0.4, 1000};
  config.element = element;
  config.fixed = {FixedBox{{0, 0, 0.04}, {0, 0.04, 0.04}}};
  config.integration.time_step_s = time_step_s;
  config.integration.mass_damping_per_s = 0;
  config.integration.stiffness_damping_s = 0;
  return config;
}

/// Swings for duration_s. Throws std::runtime_error where a step fails.
inline PendulumResult swingPendulum(const SimulationConfig& config, double duration_s) {
  Simulation simulation(config);
  PendulumResult result;
  const double length = std::get<BoxMeshConfig>(config.mesh).size_m.x();
  const double mass = config.material.density_kg_m3 * simulation.restVolume_m3();
  result.energy_scale_j = mass * config.integration.gravity_m_s2.norm() * length / 2;
  const double start = simulation.totalEnergy_j();
  double last = start;
  while (simulation.time_s() < duration_s) {
    const StepReport report = simulation.step({});
    if (!report.converged) throw std::runtime_error(report.message);
    const double energy = simulation.totalEnergy_j();
    result.largest_rise = std::max(result.largest_rise, (energy - start) / result.energy_scale_j);
    result.largest_rise_in_a_step =
        std::max(result.largest_rise_in_a_step, (energy - last) / result.energy_scale_j);
    result.lowest_energy = std::min(result.lowest_energy, (energy - start) / result.energy_scale_j);
    result.largest_swing_m = std::max(result.largest_swing_m, -simulation.positions().row(2).minCoeff());
    last = energy;
  }
  return result;
}

/// A free block of 0.2 x 0.1 x 0.05 m, cut into pieces, that flies and turns without gravity or damping.
struct TumblingResult {
  double largest_momentum_error = 0;  ///< |p(t) - p(0)| / |p(0)|, largest over all steps
  double angular_momentum_loss = 0;   ///< 1 - |L| / |L(0)| after one turn
  double angular_momentum_error = 0;  ///< |L - L(0)| / |L(0)| after one turn
  int pieces = 0;
};

/// One turn in the given number of steps, of the body open after two cuts. The turn strains it by some 160 Pa
/// over its modulus. Throws std::runtime_error where a step fails.
inline TumblingResult tumble(const ElementConfig& element, bool tetrahedra, int steps_a_turn,
                             double youngs_modulus_pa = 1e5) {
  const Eigen::Vector3d size(0.2, 0.1, 0.05);
  const Eigen::Vector3i counts(8, 4, 2);
  const PolyhedralMesh whole = tetrahedra ? makeTetBox(Eigen::Vector3d::Zero(), size, counts)
                                          : makeHexBox(Eigen::Vector3d::Zero(), size, counts);
  const PolyhedralMesh mesh = slicedOpen(whole, makeRandomPlanes(Eigen::Vector3d::Zero(), size, 2));
  constexpr double kTurnRate = 4;  // [rad/s]
  IntegrationConfig config;
  config.gravity_m_s2.setZero();
  config.mass_damping_per_s = 0;
  config.stiffness_damping_s = 0;
  config.time_step_s = 2 * EIGEN_PI / kTurnRate / steps_a_turn;
  Assembly assembly(mesh, {youngs_modulus_pa, 0.4, 1000}, element, 0);
  ImplicitEuler integrator(config);
  SimulationState state = makeRestState(mesh, {});
  const Eigen::Vector3d spin = kTurnRate * Eigen::Vector3d(0.2, 0.3, 1).normalized();
  const Eigen::Vector3d centre = size / 2;
  for (int i = 0; i < mesh.numVertices(); ++i) {
    state.velocities.col(i) =
        Eigen::Vector3d(0.3, -0.2, 0.1) + spin.cross(mesh.restPosition(VertexId(i)) - centre);
  }

  const auto momenta = [&](Eigen::Vector3d& angular) {
    Eigen::Matrix3Xd momentum;
    assembly.multiplyMass(state.velocities, momentum);
    angular.setZero();
    for (int i = 0; i < mesh.numVertices(); ++i)
      angular += Eigen::Vector3d(state.positions.col(i) - centre).cross(momentum.col(i));
    return Eigen::Vector3d(momentum.rowwise().sum());
  };
  TumblingResult result;
  result.pieces = findPieces(mesh).count;
  Eigen::Vector3d angular_start, angular;
  const Eigen::Vector3d linear_start = momenta(angular_start);
  for (int step = 0; step < steps_a_turn; ++step) {
    if (integrator.step(state, assembly, {}).status != SolveStatus::kSolved)
      throw std::runtime_error("a step of the tumbling body failed");
    const double error = (momenta(angular) - linear_start).norm() / linear_start.norm();
    result.largest_momentum_error = std::max(result.largest_momentum_error, error);
  }
  result.angular_momentum_loss = 1 - angular.norm() / angular_start.norm();
  result.angular_momentum_error = (angular - angular_start).norm() / angular_start.norm();
  return result;
}

}  // namespace polyscalpel
