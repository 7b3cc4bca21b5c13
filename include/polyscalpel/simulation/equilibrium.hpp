// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/collision/contact_forces.hpp"
#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/simulation/simulation_config.hpp"
#include "polyscalpel/solver/direct_solver.hpp"

namespace polyscalpel {

/// An equilibrium of the elastic forces with given ones.
struct EquilibriumResult {
  bool converged = false;
  std::string message;                        ///< why, when not converged
  SolveStatus status = SolveStatus::kSolved;  ///< of the last linear solve
  /// |f_int - f_ext - f_contact| over the free vertices, by the largest of |f_ext + f_contact| and the first
  /// residual. Where both vanish it may stay above IntegrationConfig::equilibrium_tolerance: Newton's step
  /// below the rounding of the positions then counts as convergence.
  double relative_residual = 0;
  int iterations = 0;  ///< Newton steps
  int fallbacks = 0;   ///< of these, with the positive semidefinite tangent
  /// Force on the tissue of each contact handed in [N]; zero for one that was let go.
  std::vector<Eigen::Vector3d> contact_forces;
  double assembly_s = 0;  ///< wall time, as in StageTimes
  double contact_s = 0;
  double solve_s = 0;
};

/// Newton's method on the potential E(x) - f.x with the exact tangent; where that is not positive definite,
/// with the positive semidefinite one; with a line search that lowers the potential (J. Nocedal, S. J.
/// Wright, "Numerical Optimization", 2006, algorithm 3.1). A linear strain measure takes one step.
///
/// Contacts act through springs as in ImplicitEuler, their velocities being (x - start) / time_step_s;
/// those whose force pulls at the solution are let go, IntegrationConfig::contact_iterations times at most.
///
/// positions: start, 3 x n [m], and result; left as they were unless converged. forces: f, 3 x n [N]. A piece
/// that its fixed vertices do not hold has no equilibrium: the message names it.
EquilibriumResult findEquilibrium(const PolyhedralMesh& mesh, Assembly& assembly,
                                  const std::vector<bool>& fixed,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                                  const std::vector<LinearisedContact>& contacts,
                                  const IntegrationConfig& config, Eigen::Matrix3Xd& positions);

}  // namespace polyscalpel
