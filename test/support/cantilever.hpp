// SPDX-License-Identifier: BSD-3-Clause
//
// A beam of 1 x 0.2 x 0.2 m, clamped at x = 0, that bends under a body force of 98.1 N/m^3 across it.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/Dense>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"
#include "polyscalpel/simulation/static_solution.hpp"
#include "support/study_meshes.hpp"

namespace polyscalpel {

inline const Eigen::Vector3d kCantileverSize(1, 0.2, 0.2);

/// Deflection of the end face's centre [m] for E = 1e5 Pa, body force 98.1 N/m^3.
///
/// By an independent program: tensor-product Lagrange elements on Gauss-Lobatto points on a quarter of the
/// section (symmetric across the load, antisymmetric along it), graded towards the clamp's edges by 0.15.
/// Orders 5, 6 and 7 agree to REFDIGITS.
inline double cantileverReference_m(double poisson_ratio) {
  constexpr std::pair<double, double> kDeflections[] = {{0, 0.0379566},   {0.2, 0.0379101}, {0.3, 0.0376668},
                                                        {0.4, 0.0372475}, {0.45, 0.036956}, {0.49, 0.036674},
                                                        {0.499, 0.036602}};
  for (const auto& [nu, deflection] : kDeflections) {
    if (nu == poisson_ratio) return deflection;
  }
  throw std::invalid_argument("no reference for this Poisson's ratio");
}

struct CantileverResult {
  int cells = 0;
  int unknowns = 0;         ///< 3 for each free vertex
  double deflection_m = 0;  ///< of the end face's centre
  double error = 0;         ///< deflection / reference - 1; negative where too stiff
};

/// The beam in 5n x n x n cells; a sliced one is cut by `planes` planes.
inline PolyhedralMesh makeCantileverMesh(BodyKind kind, int n, int planes) {
  return makeStudyMesh(kind, Eigen::Vector3d::Zero(), kCantileverSize, {5 * n, n, n}, planes);
}

/// Value at a point of the boundary of a field at the vertices (3 x n), interpolated as the surface model
/// does.
inline Eigen::Vector3d valueOnBoundary(const PolyhedralMesh& mesh, const Eigen::Vector3d& point,
                                       const Eigen::Matrix3Xd& field) {
  for (int f = 0; f < mesh.faceCapacity(); ++f) {
    const Face& face = mesh.face(FaceId(f));
    if (!face.isAlive() || !face.isBoundary()) continue;
    for (int i = 0; i < numTriangles(face); ++i) {
      const Eigen::Matrix3d corners = triangleCorners(face, i, mesh.restPositions());
      // Barycentric coordinates of the nearest point of the triangle's plane.
      Eigen::Matrix<double, 3, 2> edges;
      edges << corners.col(1) - corners.col(0), corners.col(2) - corners.col(0);
      const Eigen::Vector3d from_first = point - corners.col(0);
      const Eigen::Vector2d s =
          (edges.transpose() * edges).ldlt().solve(Eigen::Vector2d(edges.transpose() * from_first));
      const Eigen::Vector3d barycentric(1 - s.sum(), s[0], s[1]);
      if ((edges * s - from_first).norm() > 1e-9 || barycentric.minCoeff() < -1e-9) continue;
      Eigen::Vector3d value = Eigen::Vector3d::Zero();
      for (const WeightedVertex& w : vertexWeights(face, i, barycentric))
        value += w.weight * field.col(w.vertex.index());
      return value;
    }
  }
  throw std::invalid_argument("the point is not on the boundary");
}

/// Small-strain statics of the beam. Throws std::runtime_error where the solver fails.
inline CantileverResult bendCantilever(const PolyhedralMesh& mesh, double poisson_ratio,
                                       ElementConfig config) {
  config.strain = Strain::kLinear;
  Assembly assembly(mesh, {1e5, poisson_ratio, 10}, config, 0);
  const SimulationState state = makeRestState(mesh, {FixedBox{{0, -1, -1}, {0, 1, 1}}});
  const Eigen::Matrix3Xd forces = Eigen::Vector3d(0, 0, -9.81) * assembly.vertexMasses().transpose();
  const StaticSolution solution = solveStatic(mesh, assembly, state.fixed, forces);
  if (solution.status != SolveStatus::kSolved) throw std::runtime_error(solution.message);
  CantileverResult result;
  result.cells = mesh.numCells();
  result.unknowns = 3 * static_cast<int>(std::count(state.fixed.begin(), state.fixed.end(), false));
  const Eigen::Vector3d centre(kCantileverSize.x(), kCantileverSize.y() / 2, kCantileverSize.z() / 2);
  result.deflection_m = -valueOnBoundary(mesh, centre, solution.displacements).z();
  result.error = result.deflection_m / cantileverReference_m(poisson_ratio) - 1;
  return result;
}

/// Size of the error that a series of ascending numbers of unknowns would have at a given one: the straight
/// line in logarithms through the two results around it, or through the two at the end beyond which it lies.
inline double errorAt(const std::vector<CantileverResult>& series, int unknowns) {
  if (series.size() < 2) throw std::invalid_argument("a line takes two results");
  std::size_t i = 1;
  while (i + 1 < series.size() && series[i].unknowns < unknowns) ++i;
  const auto logUnknowns = [&](std::size_t k) { return std::log(static_cast<double>(series[k].unknowns)); };
  const auto logError = [&](std::size_t k) { return std::log(std::abs(series[k].error)); };
  const double t =
      (std::log(static_cast<double>(unknowns)) - logUnknowns(i - 1)) / (logUnknowns(i) - logUnknowns(i - 1));
  return std::exp((1 - t) * logError(i - 1) + t * logError(i));
}

/// The linear tetrahedra to compare with: five a cube, of these sizes.
inline std::vector<CantileverResult> bendTetrahedra(double poisson_ratio, const std::vector<int>& sizes) {
  std::vector<CantileverResult> series;
  for (const int n : sizes)
    series.push_back(
        bendCantilever(makeCantileverMesh(BodyKind::kTetrahedra, n, 0), poisson_ratio, ElementConfig()));
  return series;
}

/// Error of a result over that of the linear tetrahedra with as many unknowns.
inline double ratioToTetrahedra(const CantileverResult& result,
                                const std::vector<CantileverResult>& tetrahedra) {
  return std::abs(result.error) / errorAt(tetrahedra, result.unknowns);
}

}  // namespace polyscalpel
