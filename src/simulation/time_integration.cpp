// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/time_integration.hpp"

#include "contact_terms.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/stage_timer.hpp"

namespace polyscalpel {

// f_int(x) + (h + b) K v is the force at x + (h + b) v by the same linearisation: K v costs nothing of its
// own.
void ImplicitEuler::prepareSystem(const SimulationState& state, Assembly& assembly, bool matrix_stands) {
  const double h = config_.time_step_s, a = config_.mass_damping_per_s, b = config_.stiffness_damping_s;
  assembly.linearise(state.positions);
  if (!matrix_stands) assembly.assemble(1 + h * a, h * (h + b), matrix_);
  work_ = state.positions + (h + b) * state.velocities;
  assembly.internalForces(work_, forces_);
  work_ = (-a * state.velocities).colwise() + config_.gravity_m_s2;
  assembly.multiplyMass(work_, rhs_);
  rhs_ = h * (rhs_ - forces_);
}

IntegrationResult ImplicitEuler::step(SimulationState& state, Assembly& assembly,
                                      const std::vector<LinearisedContact>& contacts) {
  POLYSCALPEL_ASSERT(state.positions.cols() == assembly.numVertices());
  IntegrationResult result;
  result.contact_forces.assign(contacts.size(), Eigen::Vector3d::Zero());
  {
    const StageTimer timer(result.solve_s);
    if (!is_analysed_) {
      factor_is_plain_ = false;
      result.status = solver_.analyse(assembly.pattern(), state.fixed);
      if (result.status != SolveStatus::kSolved) return result;
      is_analysed_ = true;
    }
  }
  const bool matrix_stands = assembly.hasConstantStiffness() && factor_is_plain_;
  {
    const StageTimer timer(result.assembly_s);
    prepareSystem(state, assembly, matrix_stands && contacts.empty());
  }
  std::vector<bool> acts(contacts.size(), true);
  while (true) {
    if (!contacts.empty()) {
      const StageTimer timer(result.contact_s);
      contact_matrix_ = matrix_;
      contact_rhs_ = rhs_;
      for (std::size_t c = 0; c < contacts.size(); ++c) {
        if (!acts[c]) continue;
        const Contact& contact = contacts[c].contact;
        const double h = config_.time_step_s;
        addContactMatrix(contacts[c], h, assembly.pattern(), contact_matrix_);
        addAtContact(contact, h * contactForce(contacts[c], atContact(contact, state.velocities)),
                     contact_rhs_);
      }
    }
    {
      const StageTimer timer(result.solve_s);
      if (!(matrix_stands && contacts.empty())) {
        factor_is_plain_ = false;
        result.status = solver_.factorise(assembly.pattern(), contacts.empty() ? matrix_ : contact_matrix_);
        if (result.status != SolveStatus::kSolved) return result;
        factor_is_plain_ = contacts.empty();
      }
      const SolveResult solved = solver_.solve(contacts.empty() ? rhs_ : contact_rhs_, dv_);
      ++result.solves;
      result.status = solved.status;
      result.relative_residual = solved.relative_residual;
      if (result.status != SolveStatus::kSolved) return result;
    }
    work_ = state.velocities + dv_;
    if (contacts.empty()) break;
    const StageTimer timer(result.contact_s);
    bool again = false;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      if (!acts[c]) continue;
      result.contact_forces[c] = contactForce(contacts[c], atContact(contacts[c].contact, work_));
      if (result.contact_forces[c].dot(contacts[c].contact.normal_world) >= 0) continue;
      if (result.solves >= config_.contact_iterations) continue;
      acts[c] = false;
      result.contact_forces[c].setZero();
      again = true;
    }
    if (!again) break;
  }
  forces_ = state.positions + config_.time_step_s * work_;
  if (!work_.allFinite() || !forces_.allFinite()) {
    result.status = SolveStatus::kNotFinite;
    return result;
  }
  state.velocities.swap(work_);
  state.positions.swap(forces_);
  return result;
}

}  // namespace polyscalpel
