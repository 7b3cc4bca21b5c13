// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/collision/contact_forces.hpp"
#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/simulation/simulation_config.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"
#include "polyscalpel/solver/direct_solver.hpp"
#include "polyscalpel/solver/step_solver.hpp"

namespace polyscalpel {

/// What one step did.
struct IntegrationResult {
  SolveStatus status = SolveStatus::kSolved;
  double relative_residual = 0;  ///< of the last solve
  int solves = 0;
  SolverReport solver;
  int half_steps = 0;  ///< > 0: the step as a whole failed, and was made of so many shorter ones
  /// Force on the tissue of each contact handed in [N]; zero for one that was let go.
  std::vector<Eigen::Vector3d> contact_forces;
  double assembly_s = 0;  ///< wall time, as in StageTimes
  double contact_s = 0;
  double solve_s = 0;
};

/// Linearly implicit Euler, the one-Newton-step backward Euler of D. Baraff, A. Witkin, "Large Steps in Cloth
/// Simulation", SIGGRAPH 1998, equation 6, with Rayleigh damping D = a M + b K and contacts:
///
///   (M + h D + h^2 K + sum h J^T B J) dv = h (f_ext - f_int(x) - D v - h K v + sum J^T (f_0 - B J v)),
///   v += dv,  x += h v,
///
/// J taking the vertices' velocities to a contact point's. Where the stiffness is constant and nothing
/// touches, the matrix stays the same and is factored once.
class ImplicitEuler {
 public:
  /// config, solver: valid. The object keeps what belongs to one pattern and one set of fixed vertices; see
  /// restart(). solver: SolverKind::kAuto factors directly where the strain is not corotated.
  explicit ImplicitEuler(const IntegrationConfig& config, const SolverConfig& solver = factorInEveryStep());

  /// To be called before the first step and whenever the pattern or the fixed vertices have changed.
  void restart();
  /// Instead of restart() after a cut. mesh: as it is after the change.
  void follow(const PolyhedralMesh& mesh, const MeshChange& change);

  static SolverConfig factorInEveryStep() {
    SolverConfig config;
    config.kind = SolverKind::kDirect;
    return config;
  }

  /// One step. Vertices of a contact belong to one face. Contacts whose solved force pulls (normal . force <
  /// 0) are let go and the step is solved again, IntegrationConfig::contact_iterations solves at most; one
  /// that still pulls then acts as solved. A step that fails is made of 2, 4 or 8 shorter ones, each factored
  /// directly; forces of contacts are then the mean of theirs. The state is as it was unless the status is
  /// kSolved. Changes the assembly's linearisation only.
  IntegrationResult step(SimulationState& state, Assembly& assembly,
                         const std::vector<LinearisedContact>& contacts);

 private:
  IntegrationResult stepOnce(SimulationState& state, Assembly& assembly,
                             const std::vector<LinearisedContact>& contacts);
  IntegrationResult stepInParts(SimulationState& state, Assembly& assembly,
                                const std::vector<LinearisedContact>& contacts, int parts) const;
  void prepareRightSide(const SimulationState& state, Assembly& assembly);
  bool iterates(Assembly& assembly) const;
  const std::vector<char>& stillVertices(const SimulationState& state, bool may_sleep);
  SolveResult solveByIteration(const SimulationState& state, Assembly& assembly,
                               const std::vector<LinearisedContact>& contacts, const std::vector<bool>& acts,
                               std::chrono::steady_clock::time_point step_start, IntegrationResult& result);
  SolveResult solveDirectly(const SimulationState& state, Assembly& assembly,
                            const std::vector<LinearisedContact>& contacts, const std::vector<bool>& acts,
                            IntegrationResult& result);

  IntegrationConfig config_;
  SolverConfig solver_config_;
  StepSolver iteration_;
  std::vector<int> movable_, active_;  // vertices that are not fixed; of these, those that do not sleep
  DirectSolver direct_;
  bool is_analysed_ = false;
  bool factor_is_plain_ = false;  // the factor is that of the matrix without contacts

  // Kept to allocate once.
  std::vector<char> still_;
  Blocks matrix_;
  Eigen::Matrix3Xd rhs_, contact_rhs_;
  Eigen::Matrix3Xd work_, forces_, dv_;
};

}  // namespace polyscalpel
