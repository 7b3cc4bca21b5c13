// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/spectrum.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

#include "polyscalpel/solver/direct_solver.hpp"

namespace polyscalpel::report {
namespace {

void clearFixed(const std::vector<bool>& fixed, Eigen::Matrix3Xd& field) {
  for (std::size_t i = 0; i < fixed.size(); ++i)
    if (fixed[i]) field.col(static_cast<Eigen::Index>(i)).setZero();
}

}  // namespace

double largestEigenvalue(const std::function<Eigen::Matrix3Xd(const Eigen::Matrix3Xd&)>& product,
                         const std::vector<bool>& fixed, int iterations) {
  // A start without symmetry, so that it has a part of every mode.
  Eigen::Matrix3Xd q(3, static_cast<Eigen::Index>(fixed.size()));
  for (Eigen::Index i = 0; i < q.size(); ++i)
    q.data()[i] = std::sin(1.0 + 37.0 * static_cast<double>(i % 9973));
  clearFixed(fixed, q);
  q /= q.norm();
  Eigen::Matrix3Xd previous = Eigen::Matrix3Xd::Zero(3, q.cols());
  std::vector<double> diagonal, below;
  double largest = 0;
  for (int k = 0; k < iterations; ++k) {
    Eigen::Matrix3Xd r = product(q);
    clearFixed(fixed, r);
    if (k > 0) r -= below.back() * previous;
    diagonal.push_back((q.array() * r.array()).sum());
    r -= diagonal.back() * q;
    const double norm = r.norm();
    if (k % 5 == 4 || norm <= 1e-12 * std::abs(diagonal.back()) || k + 1 == iterations) {
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
      solver.computeFromTridiagonal(
          Eigen::Map<const Eigen::VectorXd>(diagonal.data(), static_cast<Eigen::Index>(diagonal.size())),
          Eigen::Map<const Eigen::VectorXd>(below.data(), static_cast<Eigen::Index>(below.size())),
          Eigen::EigenvaluesOnly);
      const double former = largest;
      largest = solver.eigenvalues()[solver.eigenvalues().size() - 1];
      if (norm <= 1e-12 * largest || std::abs(largest - former) < 1e-6 * largest) break;
    }
    below.push_back(norm);
    previous = q;
    q = r / norm;
  }
  return largest;
}

Spectrum findSpectrum(const BlockPattern& pattern, const Blocks& stiffness, const Eigen::VectorXd& masses,
                      const std::vector<bool>& fixed) {
  constexpr int kIterations = 200, kInverseIterations = 60;
  Spectrum spectrum;
  DirectSolver solver;
  SolveStatus status = solver.analyse(pattern, fixed);
  if (status == SolveStatus::kSolved) status = solver.factorise(pattern, stiffness);
  if (status != SolveStatus::kSolved) {
    spectrum.message = toString(status);
    return spectrum;
  }
  const double largest = largestEigenvalue(
      [&](const Eigen::Matrix3Xd& x) { return multiply(pattern, stiffness, x); }, fixed, kIterations);
  const double largest_of_inverse = largestEigenvalue(
      [&](const Eigen::Matrix3Xd& x) {
        Eigen::Matrix3Xd y;
        const SolveResult result = solver.solve(x, y);
        if (result.status != SolveStatus::kSolved) spectrum.message = toString(result.status);
        return y;
      },
      fixed, kInverseIterations);
  const Eigen::RowVectorXd scale = masses.cwiseSqrt().cwiseInverse();
  const double highest_frequency_squared = largestEigenvalue(
      [&](const Eigen::Matrix3Xd& x) -> Eigen::Matrix3Xd {
        const Eigen::Matrix3Xd scaled = x.array().rowwise() * scale.array();
        return multiply(pattern, stiffness, scaled).array().rowwise() * scale.array();
      },
      fixed, kIterations);
  spectrum.condition = largest * largest_of_inverse;
  spectrum.stable_step_s = 2 / std::sqrt(highest_frequency_squared);
  return spectrum;
}

}  // namespace polyscalpel::report
