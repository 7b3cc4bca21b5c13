// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/time_integration.hpp"

#include <algorithm>

#include "contact_terms.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/stage_timer.hpp"

namespace polyscalpel {

namespace {

using Clock = std::chrono::steady_clock;

/// A step's matrix as an iteration asks for it. Its assembly counts as such, though it happens within a
/// solve.
class BodySystem final : public StepSystem {
 public:
  BodySystem(Assembly& assembly, const Eigen::Matrix3Xd& positions, const IntegrationConfig& config,
             const std::vector<int>& movable, const std::vector<int>& active,
             const std::vector<LinearisedContact>& contacts, const std::vector<bool>& acts,
             double& assembly_s)
      : assembly_(assembly),
        positions_(positions),
        body_(*assembly.corotatedBody()),
        step_s_(config.time_step_s),
        mass_scale_(1 + step_s_ * config.mass_damping_per_s),
        stiffness_scale_(step_s_ * (step_s_ + config.stiffness_damping_s)),
        movable_(movable),
        active_(active),
        contacts_(contacts),
        acts_(acts),
        assembly_s_(assembly_s) {}

  const RowPattern& pattern() const override { return body_.pattern(); }
  const std::vector<int>& movable() const override { return movable_; }
  const std::vector<int>& active() const override { return active_; }
  const Eigen::Matrix3Xd& restPositions() const override { return assembly_.restPositions(); }
  void assemble(DifferenceMatrix<float>& matrix) override { assembleIn(matrix); }
  void assemble(DifferenceMatrix<double>& matrix) override { assembleIn(matrix); }
  void assembleAtRest(DifferenceMatrix<double>& matrix) override {
    body_.assembleAtRest(assembly_.vertexMasses(), mass_scale_, stiffness_scale_, immovable(), matrix);
  }
  void assembleBody(DifferenceMatrix<double>& matrix, std::vector<float>& rotations) override {
    body_.assembleAt(positions_, assembly_.vertexMasses(), mass_scale_, stiffness_scale_, immovable(), matrix,
                     rotations);
  }
  void vertexRotations(std::vector<float>& rotations) override {
    const StageTimer timer(assembly_s_);
    body_.vertexRotations(rotations);
  }

 private:
  std::vector<char> immovable() const {
    std::vector<char> flags(pattern().numVertices(), 1);
    for (const int i : movable_) flags[i] = 0;
    return flags;
  }
  template <class Scalar>
  void assembleIn(DifferenceMatrix<Scalar>& matrix) {
    const StageTimer timer(assembly_s_);
    body_.assemble(assembly_.vertexMasses(), mass_scale_, stiffness_scale_, matrix);
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
      if (acts_[c]) addHold(body_.pattern(), holdOf(contacts_[c], step_s_), matrix);
    }
  }

  Assembly& assembly_;
  const Eigen::Matrix3Xd& positions_;
  CorotatedBody& body_;
  double step_s_, mass_scale_, stiffness_scale_;
  const std::vector<int>& movable_;
  const std::vector<int>& active_;
  const std::vector<LinearisedContact>& contacts_;
  const std::vector<bool>& acts_;
  double& assembly_s_;
};

}  // namespace

ImplicitEuler::ImplicitEuler(const IntegrationConfig& config, const SolverConfig& solver)
    : config_(config), solver_config_(solver), iteration_(solver) {}

void ImplicitEuler::restart() {
  is_analysed_ = false;
  iteration_.restart();
}

void ImplicitEuler::follow(const PolyhedralMesh& mesh, const MeshChange& change) {
  is_analysed_ = false;
  std::vector<AddedVertex> added;
  for (const NewVertex& vertex : change.new_vertices) {
    added.push_back(
        {vertex.vertex.index(), {vertex.parents[0].index(), vertex.parents[1].index()}, vertex.weight});
  }
  std::vector<int> touched;
  const auto touch = [&](CellId cell) {
    for (const VertexId vertex : mesh.cell(cell).vertices) touched.push_back(vertex.index());
  };
  for (const CellId cell : change.changed_cells) touch(cell);
  for (const NewCell& cell : change.new_cells) touch(cell.cell);
  iteration_.follow(added, touched);
}

bool ImplicitEuler::iterates(Assembly& assembly) const {
  return solver_config_.kind != SolverKind::kDirect && assembly.corotatedBody() != nullptr;
}

// One flag a vertex, or empty where all move.
const std::vector<char>& ImplicitEuler::stillVertices(const SimulationState& state, bool may_sleep) {
  still_.assign(state.fixed.begin(), state.fixed.end());
  if (may_sleep && !state.asleep.empty()) {
    for (std::size_t i = 0; i < still_.size(); ++i) still_[i] = still_[i] != 0 || state.asleep[i] != 0;
  }
  if (std::find(still_.begin(), still_.end(), 1) == still_.end()) still_.clear();
  return still_;
}

// f_int(x) + (h + b) K v is the force at x + (h + b) v by the same linearisation: K v costs nothing of its
// own.
void ImplicitEuler::prepareRightSide(const SimulationState& state, Assembly& assembly) {
  const double h = config_.time_step_s, a = config_.mass_damping_per_s, b = config_.stiffness_damping_s;
  if (assembly.corotatedBody()) assembly.corotatedBody()->setStill(stillVertices(state, iterates(assembly)));
  work_ = state.positions + (h + b) * state.velocities;
  assembly.lineariseWithForces(state.positions, work_, forces_);
  rhs_ = config_.gravity_m_s2 * assembly.vertexMasses().transpose();
  if (a != 0) {
    assembly.multiplyMass(state.velocities, work_);
    rhs_ -= a * work_;
  }
  rhs_ = h * (rhs_ - forces_);
}

SolveResult ImplicitEuler::solveByIteration(const SimulationState& state, Assembly& assembly,
                                            const std::vector<LinearisedContact>& contacts,
                                            const std::vector<bool>& acts, Clock::time_point step_start,
                                            IntegrationResult& result) {
  double assembly_s = 0, both_s = 0;
  SolveResult solved;
  {
    const StageTimer timer(both_s);
    movable_.clear();
    active_.clear();
    for (int i = 0; i < static_cast<int>(state.fixed.size()); ++i) {
      if (state.fixed[i]) continue;
      movable_.push_back(i);
      if (!state.isAsleep(i)) active_.push_back(i);
    }
    BodySystem system(assembly, state.positions, config_, movable_, active_, contacts, acts, assembly_s);
    solved = iteration_.solve(system, contacts.empty() ? rhs_ : contact_rhs_, result.solves == 0, step_start,
                              dv_, result.solver);
  }
  result.assembly_s += assembly_s;
  result.solve_s += both_s - assembly_s;
  return solved;
}

SolveResult ImplicitEuler::solveDirectly(const SimulationState& state, Assembly& assembly,
                                         const std::vector<LinearisedContact>& contacts,
                                         const std::vector<bool>& acts, IntegrationResult& result) {
  SolveResult solved;
  result.solver.kind = SolverKind::kDirect;
  result.solver.reason = solver_config_.kind == SolverKind::kDirect
                             ? "the scene asks for it"
                             : "conjugate gradients need corotated strain";
  if (!is_analysed_) {
    const StageTimer timer(result.solve_s);
    factor_is_plain_ = false;
    solved.status = direct_.analyse(assembly.pattern(), state.fixed);
    if (solved.status != SolveStatus::kSolved) return solved;
    is_analysed_ = true;
  }
  // Where the stiffness is constant and nothing touches, the matrix stays the same.
  const bool factor_stands = contacts.empty() && assembly.hasConstantStiffness() && factor_is_plain_;
  if (!factor_stands) {
    {
      const StageTimer timer(result.assembly_s);
      const double h = config_.time_step_s;
      assembly.assemble(1 + h * config_.mass_damping_per_s, h * (h + config_.stiffness_damping_s), matrix_);
    }
    {
      const StageTimer timer(result.contact_s);
      for (std::size_t c = 0; c < contacts.size(); ++c) {
        if (acts[c]) addContactMatrix(contacts[c], config_.time_step_s, assembly.pattern(), matrix_);
      }
    }
    const StageTimer timer(result.solve_s);
    factor_is_plain_ = false;
    solved.status = direct_.factorise(assembly.pattern(), matrix_);
    if (solved.status != SolveStatus::kSolved) return solved;
    factor_is_plain_ = contacts.empty();
  }
  const StageTimer timer(result.solve_s);
  return direct_.solve(contacts.empty() ? rhs_ : contact_rhs_, dv_);
}

IntegrationResult ImplicitEuler::step(SimulationState& state, Assembly& assembly,
                                      const std::vector<LinearisedContact>& contacts) {
  POLYSCALPEL_ASSERT(state.positions.cols() == assembly.numVertices());
  IntegrationResult result = stepOnce(state, assembly, contacts);
  constexpr int kMostParts = 8;
  for (int parts = 2; parts <= kMostParts && result.status != SolveStatus::kSolved; parts *= 2) {
    // Shorter steps mend neither what is not finite from the start nor a lack of memory.
    if (result.status == SolveStatus::kOutOfMemory || !state.positions.allFinite() ||
        !state.velocities.allFinite()) {
      break;
    }
    const IntegrationResult in_parts = stepInParts(state, assembly, contacts, parts);
    if (in_parts.status == SolveStatus::kSolved) result = in_parts;
  }
  return result;
}

IntegrationResult ImplicitEuler::stepInParts(SimulationState& state, Assembly& assembly,
                                             const std::vector<LinearisedContact>& contacts,
                                             int parts) const {
  IntegrationConfig config = config_;
  config.time_step_s /= parts;
  ImplicitEuler shorter(config);
  SimulationState trial = state;
  IntegrationResult result;
  result.contact_forces.assign(contacts.size(), Eigen::Vector3d::Zero());
  for (int part = 0; part < parts; ++part) {
    const IntegrationResult once = shorter.stepOnce(trial, assembly, contacts);
    result.status = once.status;
    result.relative_residual = once.relative_residual;
    result.solver = once.solver;
    result.solves += once.solves;
    result.assembly_s += once.assembly_s;
    result.contact_s += once.contact_s;
    result.solve_s += once.solve_s;
    if (result.status != SolveStatus::kSolved) return result;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      result.contact_forces[c] += once.contact_forces[c] / static_cast<double>(parts);
    }
  }
  result.solver.reason = "the step as a whole failed";
  result.half_steps = parts;
  for (int i = 0; i < static_cast<int>(state.fixed.size()); ++i) {
    if (!state.isAsleep(i)) continue;
    trial.positions.col(i) = state.positions.col(i);
    trial.velocities.col(i) = state.velocities.col(i);
  }
  state.positions.swap(trial.positions);
  state.velocities.swap(trial.velocities);
  return result;
}

IntegrationResult ImplicitEuler::stepOnce(SimulationState& state, Assembly& assembly,
                                          const std::vector<LinearisedContact>& contacts) {
  const Clock::time_point start = Clock::now();
  if (assembly.corotatedBody()) assembly.corotatedBody()->setThreads(solver_config_.threads);
  IntegrationResult result;
  result.contact_forces.assign(contacts.size(), Eigen::Vector3d::Zero());
  {
    const StageTimer timer(result.assembly_s);
    prepareRightSide(state, assembly);
  }
  std::vector<bool> acts(contacts.size(), true);
  while (true) {
    if (!contacts.empty()) {
      const StageTimer timer(result.contact_s);
      contact_rhs_ = rhs_;
      for (std::size_t c = 0; c < contacts.size(); ++c) {
        if (!acts[c]) continue;
        const Contact& contact = contacts[c].contact;
        addAtContact(contact,
                     config_.time_step_s * contactForce(contacts[c], atContact(contact, state.velocities)),
                     contact_rhs_);
      }
    }
    const SolveResult solved = iterates(assembly)
                                   ? solveByIteration(state, assembly, contacts, acts, start, result)
                                   : solveDirectly(state, assembly, contacts, acts, result);
    ++result.solves;
    result.status = solved.status;
    result.relative_residual = solved.relative_residual;
    if (result.status != SolveStatus::kSolved) return result;
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
