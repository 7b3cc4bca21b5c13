// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/static_solution.hpp"

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/stage_timer.hpp"
#include "polyscalpel/simulation/loose_piece.hpp"

namespace polyscalpel {

StaticSolution solveStatic(const PolyhedralMesh& mesh, Assembly& assembly, const std::vector<bool>& fixed,
                           const Eigen::Ref<const Eigen::Matrix3Xd>& forces) {
  POLYSCALPEL_ASSERT(forces.cols() == mesh.numVertices() && assembly.numVertices() == mesh.numVertices());
  POLYSCALPEL_ASSERT(static_cast<int>(fixed.size()) == mesh.numVertices());
  StaticSolution solution;
  solution.displacements.setZero(3, mesh.numVertices());
  Blocks matrix;
  {
    const StageTimer timer(solution.assembly_s);
    solution.message = findLoosePiece(mesh, fixed);
    if (!solution.message.empty()) {
      solution.status = SolveStatus::kNotPositiveDefinite;
      return solution;
    }
    assembly.lineariseAtRest();
    assembly.assemble(0, 1, matrix);
  }
  const StageTimer timer(solution.solve_s);
  DirectSolver solver;
  solution.status = solver.analyse(assembly.pattern(), fixed);
  if (solution.status == SolveStatus::kSolved) solution.status = solver.factorise(assembly.pattern(), matrix);
  if (solution.status == SolveStatus::kSolved) {
    const SolveResult result = solver.solve(forces, solution.displacements);
    solution.status = result.status;
    solution.relative_residual = result.relative_residual;
  }
  if (solution.status != SolveStatus::kSolved) solution.message = toString(solution.status);
  return solution;
}

}  // namespace polyscalpel
