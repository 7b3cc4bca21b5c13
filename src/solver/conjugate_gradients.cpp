// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

template <class Scalar>
void ConjugateGradients<Scalar>::precondition(Preconditioner& preconditioner) {
  if constexpr (std::is_same_v<Scalar, float>) {
    preconditioner.apply(r_.data(), z_.data());
  } else {
    // Near the end residuals are too small for single precision, or their products are.
    const double scale = r_.cwiseAbs().maxCoeff();
    if (!(scale > 0)) {
      z_.setZero();
      return;
    }
    single_r_ = (r_ / scale).template cast<float>();
    single_z_.setZero(r_.size());
    preconditioner.apply(single_r_.data(), single_z_.data());
    z_ = scale * single_z_.template cast<double>();
  }
}

template <class Scalar>
IterationResult ConjugateGradients<Scalar>::solve(const RowPattern& pattern,
                                                  const DifferenceMatrix<Scalar>& matrix,
                                                  const std::vector<int>& active, const Vector& b,
                                                  Preconditioner& preconditioner,
                                                  const IterationLimits& limits, int num_threads, Vector& x) {
  const Eigen::Index size = paddedSize(pattern.numVertices());
  POLYSCALPEL_ASSERT(b.size() == size && x.size() == size);
  if (runs_.set(active) || r_.size() != size) {
    for (Vector* const vector : {&r_, &z_, &p_, &q_}) vector->setZero(size);
  }
  IterationResult result;
  const double norm_b = std::sqrt(runs_.dot(b, b));
  if (norm_b == 0) {
    x.setZero();
    return result;
  }
  runs_.forEach([](auto r, const auto& b_run) { r = b_run; }, r_, b);
  if (runs_.dot(x, x) != 0) {
    multiply(pattern, matrix, active, x.data(), q_.data(), num_threads);
    runs_.forEach([](auto r, const auto& q) { r -= q; }, r_, q_);
  }
  double step_energy = 0, last_energy = 0, energy = std::abs(runs_.dot(x, b));
  double r_dot_z = 0;
  while (true) {
    result.relative_residual = std::sqrt(runs_.dot(r_, r_)) / norm_b;
    if (result.iterations > 0) {
      // What steps gain falls off like a geometric series, if it falls.
      const double ratio = last_energy > 0 ? std::min(step_energy / last_energy, 0.9) : 0.5;
      const double rest = step_energy * ratio / (1 - ratio);
      result.estimated_error = energy > 0 ? std::sqrt(rest / energy) : 0;
    }
    if (!std::isfinite(result.relative_residual)) {
      result.end = IterationResult::End::kBreakdown;
      return result;
    }
    const bool is_done = limits.error_target
                             ? (result.iterations > 1 && result.estimated_error <= *limits.error_target) ||
                                   result.relative_residual == 0
                             : result.relative_residual <= limits.tolerance;
    if (is_done) return result;
    if (result.iterations >= limits.max_iterations) {
      result.end = IterationResult::End::kIterations;
      return result;
    }
    if (limits.deadline && result.iterations > 0 && std::chrono::steady_clock::now() >= *limits.deadline) {
      result.end = IterationResult::End::kDeadline;
      return result;
    }
    precondition(preconditioner);
    const double r_dot_z_before = r_dot_z;
    r_dot_z = runs_.dot(r_, z_);
    if (!(r_dot_z > 0) || !std::isfinite(r_dot_z)) {
      result.end = IterationResult::End::kBreakdown;
      return result;
    }
    if (result.iterations == 0) {
      runs_.forEach([](auto p, const auto& z) { p = z; }, p_, z_);
    } else {
      const Scalar beta = static_cast<Scalar>(r_dot_z / r_dot_z_before);
      runs_.forEach([&](auto p, const auto& z) { p = z + beta * p; }, p_, z_);
    }
    multiply(pattern, matrix, active, p_.data(), q_.data(), num_threads);
    const double curvature = runs_.dot(p_, q_);
    if (!(curvature > 0) || !std::isfinite(curvature)) {
      result.end = IterationResult::End::kBreakdown;
      return result;
    }
    const double alpha = r_dot_z / curvature;
    const Scalar step = static_cast<Scalar>(alpha);
    runs_.forEach([&](auto x_run, const auto& p) { x_run += step * p; }, x, p_);
    runs_.forEach([&](auto r, const auto& q) { r -= step * q; }, r_, q_);
    last_energy = step_energy;
    step_energy = alpha * r_dot_z;
    energy += step_energy;
    ++result.iterations;
  }
}

template class ConjugateGradients<float>;
template class ConjugateGradients<double>;

}  // namespace polyscalpel
