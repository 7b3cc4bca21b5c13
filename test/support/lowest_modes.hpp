// SPDX-License-Identifier: BSD-3-Clause
//
// Lowest eigenfrequencies of a free body.
#pragma once

#include <cmath>
#include <random>
#include <stdexcept>

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/solver/direct_solver.hpp"

namespace polyscalpel {

/// The lowest `count` angular frequencies of K v = omega^2 M v around the rest shape, ascending [rad/s], six
/// zeros of the rigid motions among them; those come out at the square root of rounding. By subspace
/// iteration (K.-J. Bathe, "Finite Element Procedures", 1996, section 11.6), to 1e-8 relative. shift: sigma
/// [rad^2/s^2] in (K + sigma M), > 0, some way below the square of the lowest frequency of interest. Throws
/// std::runtime_error where it does not converge.
inline Eigen::VectorXd lowestFrequencies(Assembly& assembly, int count, double shift) {
  const int n = assembly.numVertices();
  const int width = std::min(2 * count, 3 * n);  // more vectors than wanted: the last ones converge slowly
  assembly.lineariseAtRest();
  Blocks stiffness, shifted;
  assembly.assemble(0, 1, stiffness);
  assembly.assemble(shift, 1, shifted);
  DirectSolver solver;
  const std::vector<bool> nothing_fixed(n, false);
  if (solver.analyse(assembly.pattern(), nothing_fixed) != SolveStatus::kSolved ||
      solver.factorise(assembly.pattern(), shifted) != SolveStatus::kSolved)
    throw std::runtime_error("the shifted stiffness cannot be factored");

  Eigen::MatrixXd vectors(3 * n, width), mass_times(3 * n, width), stiffness_times(3 * n, width);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (double& entry : vectors.reshaped()) entry = normal(random);
  Eigen::VectorXd last = Eigen::VectorXd::Constant(count, -1);
  Eigen::Matrix3Xd result;
  constexpr int kMostIterations = 200;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    for (int j = 0; j < width; ++j) {
      assembly.multiplyMass(vectors.col(j).reshaped(3, n), result);
      if (solver.solve(Eigen::Matrix3Xd(result), result).status != SolveStatus::kSolved)
        throw std::runtime_error("a solve of the subspace iteration failed");
      vectors.col(j) = result.reshaped();
      assembly.multiplyMass(vectors.col(j).reshaped(3, n), result);
      mass_times.col(j) = result.reshaped();
      stiffness_times.col(j) =
          multiply(assembly.pattern(), stiffness, vectors.col(j).reshaped(3, n)).reshaped();
    }
    Eigen::MatrixXd K = vectors.transpose() * stiffness_times, M = vectors.transpose() * mass_times;
    K = 0.5 * (K + K.transpose()).eval();
    M = 0.5 * (M + M.transpose()).eval();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(K, M);
    vectors *= ritz.eigenvectors();
    const Eigen::VectorXd squares = ritz.eigenvalues().head(count);
    const bool has_converged =
        ((squares - last).array().abs() < 1e-8 * (squares.array().abs() + shift)).all();
    if (has_converged) return squares.cwiseMax(0).cwiseSqrt();
    last = squares;
  }
  throw std::runtime_error("the subspace iteration does not converge");
}

/// Angular frequencies of the free bending vibrations of a beam of rectangular section by S. P. Timoshenko,
/// "On the correction for shear of the differential equation for transverse vibrations of prismatic bars",
/// 1921, with the shear coefficient of T. Kaneko, "On Timoshenko's correction for shear in vibrating beams",
/// 1975, which fits experiments and three-dimensional elasticity best.
struct TimoshenkoBeam {
  double length_m = 1, width_m = 0.1, height_m = 0.1;  ///< bends along its height
  IsotropicMaterial material;

  /// Zero exactly at the frequencies of the beam with free ends. Along the beam (w, psi, M, Q) obey
  ///   w' = psi + Q / (k G A),  psi' = M / (E I),  M' = -Q - rho I omega^2 psi,  Q' = -rho A omega^2 w;
  /// M and Q vanish at both ends, so the block of the transfer matrix that takes (w, psi) at one end to (M,
  /// Q) at the other is singular.
  double frequencyEquation(double omega) const {
    const double nu = material.poisson_ratio, rho = material.density_kg_m3;
    const double k = 5 * (1 + nu) / (6 + 5 * nu);
    const double A = width_m * height_m, I = A * height_m * height_m / 12;
    const double EI = material.youngs_modulus_pa * I, kGA = k * shearModulus(material) * A;
    const double square = omega * omega;
    Eigen::Matrix4d D = Eigen::Matrix4d::Zero();  // of (w, psi L, M L^2 / EI, Q L^3 / EI) by x / L
    const double L = length_m;
    D(0, 1) = 1;
    D(0, 3) = EI / (kGA * L * L);
    D(1, 2) = 1;
    D(2, 1) = -rho * I * square * L * L / EI;
    D(2, 3) = -1;
    D(3, 0) = -rho * A * square * L * L * L * L / EI;
    // exp(D) by its series on D / 2^10, squared ten times.
    Eigen::Matrix4d term = Eigen::Matrix4d::Identity(), transfer = term;
    for (int i = 1; i <= 12; ++i) {
      term = (term * D / (1024.0 * i)).eval();
      transfer += term;
    }
    for (int i = 0; i < 10; ++i) transfer = (transfer * transfer).eval();
    return transfer.bottomLeftCorner<2, 2>().determinant();
  }

  /// The lowest `count` bending frequencies [rad/s], ascending, by bisection.
  std::vector<double> bendingFrequencies(int count) const {
    // The classical beam's first one, which lies above; shear and turning of the sections lower it.
    const double first = 22.3733 / (length_m * length_m) * height_m *
                         std::sqrt(material.youngs_modulus_pa / (12 * material.density_kg_m3));
    const double stride = first / 50;
    std::vector<double> found;
    double low = stride, value_low = frequencyEquation(low);
    while (static_cast<int>(found.size()) < count) {
      const double high = low + stride, value_high = frequencyEquation(high);
      if (value_low * value_high < 0) {
        double a = low, b = high;
        for (int i = 0; i < 60; ++i) {
          const double middle = 0.5 * (a + b);
          (frequencyEquation(middle) * value_low > 0 ? a : b) = middle;
        }
        found.push_back(0.5 * (a + b));
      }
      low = high;
      value_low = value_high;
    }
    return found;
  }
};

}  // namespace polyscalpel
