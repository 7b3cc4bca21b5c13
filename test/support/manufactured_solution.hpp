// SPDX-License-Identifier: BSD-3-Clause
//
// Convergence to a known solution, the method of P. J. Roache, "Code Verification by the Method of
// Manufactured Solutions", 2002: a smooth displacement field is chosen, and the body force that belongs to it
// is applied.
#pragma once

#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Dense>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/elements/mean_value_coordinates.hpp"
#include "polyscalpel/elements/quadrature.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/static_solution.hpp"
#include "support/study_meshes.hpp"

namespace polyscalpel {

/// u = a sin(pi x) sin(pi y) sin(pi z) on the unit cube, zero on its boundary, a body with Hooke's law.
struct ManufacturedSolution {
  IsotropicMaterial material{1.0, 0.3, 1.0};
  Eigen::Vector3d a{1.0, -0.6, 0.8};  ///< [m]

  /// u [m].
  Eigen::Vector3d displacement(const Eigen::Vector3d& x) const { return a * bump(x); }

  /// grad u.
  Eigen::Matrix3d gradient(const Eigen::Vector3d& x) const {
    const Eigen::Array3d s = (EIGEN_PI * x.array()).sin(), c = (EIGEN_PI * x.array()).cos();
    return EIGEN_PI * a * Eigen::RowVector3d(c[0] * s[1] * s[2], s[0] * c[1] * s[2], s[0] * s[1] * c[2]);
  }

  /// f = -div sigma(u) = -(lambda + mu) grad div u - mu laplace u [N/m^3].
  Eigen::Vector3d bodyForce(const Eigen::Vector3d& x) const {
    const Eigen::Array3d s = (EIGEN_PI * x.array()).sin(), c = (EIGEN_PI * x.array()).cos();
    constexpr double kPi2 = EIGEN_PI * EIGEN_PI;
    Eigen::Matrix3d hessian = -bump(x) * Eigen::Matrix3d::Identity();
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      hessian(i, j) = hessian(j, i) = c[i] * c[j] * s[k];
    }
    const double mu = shearModulus(material);
    return -(lameLambda(material) + mu) * kPi2 * hessian * a + 3 * mu * kPi2 * bump(x) * a;
  }

 private:
  static double bump(const Eigen::Vector3d& x) { return (EIGEN_PI * x.array()).sin().prod(); }
};

/// Errors of one solution.
struct ConvergencePoint {
  double h = 0;  ///< cube root of the mean cell volume [m]
  int cells = 0;
  int unknowns = 0;         ///< 3 for each free vertex
  double l2_error = 0;      ///< |u_h - u| / |u| in L2
  double energy_error = 0;  ///< the same in the energy norm
};

/// Solves for the manufactured solution on a mesh of the unit cube and integrates the error over every cell,
/// with mean value coordinates whatever the formulation. Throws std::runtime_error where the solver fails.
inline ConvergencePoint solveManufactured(const PolyhedralMesh& mesh, ElementConfig config) {
  const ManufacturedSolution exact;
  config.strain = Strain::kLinear;
  Assembly assembly(mesh, exact.material, config, 0);

  // The four points of a sub-tet see quadratic functions exactly; a tetrahedron as a cell is larger beside h.
  const auto quadratureOf = [](const CellSurface& surface) {
    return makeCellQuadrature(surface, tetrahedronRule(surface.isTetrahedron() ? 11 : 4));
  };
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, mesh.numVertices());
  for (const CellId id : mesh.cells()) {
    const CellSurface surface = makeCellSurface(mesh, id, mesh.restPositions());
    const CellQuadrature quadrature = quadratureOf(surface);
    const Eigen::Vector3d origin = starCentre(surface);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (int q = 0; q < quadrature.weights.size(); ++q)
      mean += quadrature.weights[q] * exact.bodyForce(origin + quadrature.points.col(q));
    const ElementMatrices& element = assembly.elementMatrices(id);
    mean /= element.volume;
    for (std::size_t i = 0; i < mesh.cell(id).vertices.size(); ++i)
      forces.col(mesh.cell(id).vertices[i].index()) += element.shape_integral[i] * mean;
  }

  ConvergencePoint point;
  std::vector<bool> fixed(mesh.numVertices());
  for (int i = 0; i < mesh.numVertices(); ++i) {
    const Eigen::Vector3d X = mesh.restPosition(VertexId(i));
    fixed[i] = X.minCoeff() < 1e-9 || X.maxCoeff() > 1 - 1e-9;
    point.unknowns += fixed[i] ? 0 : 3;
  }
  const StaticSolution solution = solveStatic(mesh, assembly, fixed, forces);
  if (solution.status != SolveStatus::kSolved) throw std::runtime_error(solution.message);

  const double lambda = lameLambda(exact.material), mu = shearModulus(exact.material);
  const auto energyOf = [&](const Eigen::Matrix3d& gradient) {
    const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
    return lambda * strain.trace() * strain.trace() + 2 * mu * strain.squaredNorm();
  };
  double l2 = 0, l2_exact = 0, energy = 0, energy_exact = 0;
  MeanValueCoordinates<double> coordinates;
  for (const CellId id : mesh.cells()) {
    const CellSurface surface = makeCellSurface(mesh, id, mesh.restPositions());
    const CellQuadrature quadrature = quadratureOf(surface);
    Eigen::Matrix3Xd u(3, surface.num_vertices);
    for (int i = 0; i < surface.num_vertices; ++i)
      u.col(i) = solution.displacements.col(mesh.cell(id).vertices[i].index());
    coordinates.setSurface(surface);
    coordinates.evaluate(quadrature.points);
    for (int q = 0; q < quadrature.weights.size(); ++q) {
      const Eigen::Vector3d x = coordinates.origin() + quadrature.points.col(q);
      const Eigen::Vector3d u_h = u * coordinates.values().col(q);
      const Eigen::Matrix3d gradient_h =
          u * coordinates.gradients().col(q).reshaped(3, surface.num_vertices).transpose();
      const double w = quadrature.weights[q];
      l2 += w * (u_h - exact.displacement(x)).squaredNorm();
      l2_exact += w * exact.displacement(x).squaredNorm();
      energy += w * energyOf(gradient_h - exact.gradient(x));
      energy_exact += w * energyOf(exact.gradient(x));
    }
  }
  point.cells = mesh.numCells();
  point.h = std::cbrt(1.0 / point.cells);
  point.l2_error = std::sqrt(l2 / l2_exact);
  point.energy_error = std::sqrt(energy / energy_exact);
  return point;
}

/// The unit cube in n x n x n cells of a kind; a sliced one is cut by n / 2 planes, so that cut cells are
/// about as large a part of the body at every size.
inline PolyhedralMesh makeManufacturedMesh(BodyKind kind, int n) {
  return makeStudyMesh(kind, Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), Eigen::Vector3i::Constant(n),
                       n / 2);
}

/// Slope of the straight line through (log h, log error) with the least squared distance: the order of
/// convergence.
inline double fittedSlope(const std::vector<double>& h, const std::vector<double>& error) {
  const auto n = static_cast<Eigen::Index>(h.size());
  const Eigen::ArrayXd x = Eigen::Map<const Eigen::ArrayXd>(h.data(), n).log();
  const Eigen::ArrayXd y = Eigen::Map<const Eigen::ArrayXd>(error.data(), n).log();
  return ((x - x.mean()) * (y - y.mean())).sum() / (x - x.mean()).square().sum();
}

/// Errors over several sizes, and their orders.
struct ConvergenceStudy {
  std::vector<ConvergencePoint> points;
  double l2_order = 0;
  double energy_order = 0;
};
inline ConvergenceStudy studyConvergence(BodyKind kind, const std::vector<int>& sizes,
                                         const ElementConfig& config) {
  ConvergenceStudy study;
  std::vector<double> h, l2, energy;
  for (const int n : sizes) {
    study.points.push_back(solveManufactured(makeManufacturedMesh(kind, n), config));
    h.push_back(study.points.back().h);
    l2.push_back(study.points.back().l2_error);
    energy.push_back(study.points.back().energy_error);
  }
  study.l2_order = fittedSlope(h, l2);
  study.energy_order = fittedSlope(h, energy);
  return study;
}

}  // namespace polyscalpel
