// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/solver/direct_solver.hpp"

namespace polyscalpel {

struct StaticSolution {
  SolveStatus status = SolveStatus::kSolved;
  std::string message;             ///< why, when not solved
  Eigen::Matrix3Xd displacements;  ///< u, 3 x n, one column per vertex [m]; zero when not solved
  double relative_residual = 0;    ///< |K u - F| / |F| over the free vertices
  double assembly_s = 0;           ///< wall time, as in StageTimes
  double solve_s = 0;
};

/// Small-strain linear statics K u = F around the rest shape, u = 0 at fixed vertices. forces: F, 3 x n, one
/// column per vertex [N]. A piece that its fixed vertices do not hold (none, or all on one line) has no
/// solution: the status is then kNotPositiveDefinite and the message names the piece. Linearises the
/// assembly around the rest shape.
StaticSolution solveStatic(const PolyhedralMesh& mesh, Assembly& assembly, const std::vector<bool>& fixed,
                           const Eigen::Ref<const Eigen::Matrix3Xd>& forces);

}  // namespace polyscalpel
