// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/core/stage_timer.hpp"
#include "polyscalpel/simulation/equilibrium.hpp"
#include "simulation_impl.hpp"

namespace polyscalpel {

// Contacts at the current positions with the tools where they will be at the end of the step, linearised. The
// tool's material point under a contact moves with the rigid motion from the tool's start to its end.
std::vector<LinearisedContact> Simulation::Impl::findContacts(const ToolPoses& T_end, StepReport& report) {
  std::vector<LinearisedContact> linearised;
  if (!surface) return linearised;
  const double h = config.integration.time_step_s;
  bool is_refitted = false;
  for (std::size_t i = 0; i < tools.size(); ++i) {
    if (!tools[i].shape || !T_end[i] || report.tools[i].reseated) continue;
    std::vector<Contact> contacts;
    {
      const StageTimer timer(report.times.detection_s);
      if (!is_refitted) surface->refit(mesh, state.positions);
      is_refitted = true;
      contacts =
          surface->findContacts(mesh, state.positions, *tools[i].shape, *T_end[i], config.contact->margin_m);
    }
    const StageTimer timer(report.times.contact_s);
    for (const Contact& contact : contacts) {
      Eigen::Vector3d velocity_tissue = Eigen::Vector3d::Zero();
      for (const WeightedVertex& w : contact.weights) {
        velocity_tissue += w.weight * state.velocities.col(w.vertex.index());
      }
      const Eigen::Vector3d point_start =
          *tools[i].T_world_tool * (T_end[i]->inverse() * contact.point_world);
      const Eigen::Vector3d velocity_tool = (contact.point_world - point_start) / h;
      const LinearisedContact candidate =
          lineariseContact(contact, static_cast<int>(i), velocity_tissue, velocity_tool, h, *config.contact);
      if (candidate.force_0.isZero(0) && candidate.B.isZero(0)) continue;  // the gap stays open
      linearised.push_back(candidate);
    }
  }
  return linearised;
}

void Simulation::Impl::applyContactForces(const std::vector<LinearisedContact>& contacts,
                                          const std::vector<Eigen::Vector3d>& forces, const ToolPoses& T_end,
                                          StepReport& report) {
  if (contacts.empty()) return;
  const StageTimer timer(report.times.contact_s);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (forces[c].isZero(0)) continue;
    const Contact& contact = contacts[c].contact;
    const int tool = contacts[c].tool;
    report.contacts.push_back({tool, contact.face, contact.point_world, forces[c], contact.gap_m});
    addReaction(report.tools[tool].wrench_tool, forces[c], contact.point_world, *T_end[tool]);
  }
}

// After the tissue has moved: forces on the tools, blades, and the tools' own poses.
void Simulation::Impl::finishMotion(const std::vector<LinearisedContact>& contacts,
                                    const std::vector<Eigen::Vector3d>& forces, const ToolPoses& T_end,
                                    Eigen::Matrix3Xd& positions_start, StepReport& report) {
  applyContactForces(contacts, forces, T_end, report);
  if (hasBlade()) moveBlades(T_end, positions_start, report);
  for (std::size_t i = 0; i < tools.size(); ++i) tools[i].T_world_tool = T_end[i];
}

bool Simulation::Impl::stepDynamic(const ToolPoses& T_end, StepReport& report) {
  const std::vector<LinearisedContact> contacts = findContacts(T_end, report);
  Eigen::Matrix3Xd positions_start;
  if (hasBlade()) positions_start = state.positions;
  if (sleep) {
    for (const LinearisedContact& contact : contacts)
      sleep->wake(index.pieces.pieces(), mesh.face(contact.contact.face).cells[0], state);
  }
  const IntegrationResult result = integrator->step(state, *assembly, contacts);
  report.relative_residual = result.relative_residual;
  report.solves = result.solves;
  report.solver = result.solver;
  report.half_steps = result.half_steps;
  report.times.assembly_s = result.assembly_s;
  report.times.solve_s = result.solve_s;
  report.times.contact_s += result.contact_s;
  if (result.status != SolveStatus::kSolved) {
    report.message = toString(result.status);
    return false;
  }
  if (sleep) {
    sleep->track(state);
    report.sleeping_pieces = sleep->numAsleep();
  }
  finishMotion(contacts, result.contact_forces, T_end, positions_start, report);
  return true;
}

// Nothing moves in a static scene but by a cut, so the solution stands until the next one.
bool Simulation::Impl::stepStatic(const ToolPoses& T_end, StepReport& report) {
  if (config.integration.mode == AnalysisMode::kStatic && static_solution_stands) {
    report.relative_residual = static_residual;
    return true;
  }
  const std::vector<LinearisedContact> contacts = findContacts(T_end, report);
  Eigen::Matrix3Xd positions_start = state.positions;
  const Eigen::Matrix3Xd weights = config.integration.gravity_m_s2 * assembly->vertexMasses().transpose();
  const EquilibriumResult result =
      findEquilibrium(mesh, *assembly, state.fixed, weights, contacts, config.integration, state.positions);
  report.relative_residual = result.relative_residual;
  report.solves = result.iterations;
  report.iterations = result.iterations;
  report.times.assembly_s = result.assembly_s;
  report.times.solve_s = result.solve_s;
  report.times.contact_s += result.contact_s;
  if (!result.converged) {
    report.message = result.message;
    return false;
  }
  static_solution_stands = true;
  static_residual = result.relative_residual;
  if (config.integration.mode == AnalysisMode::kStatic) return true;
  state.velocities = (state.positions - positions_start) / config.integration.time_step_s;
  finishMotion(contacts, result.contact_forces, T_end, positions_start, report);
  return true;
}

void Simulation::Impl::recoverStressWhenDue(StepReport& report) {
  if (!config.stress || step_count % config.stress->interval_steps != 0) return;
  const StageTimer timer(report.times.stress_s);
  stress = recoverStress(mesh, *assembly, state.positions);
}

}  // namespace polyscalpel
