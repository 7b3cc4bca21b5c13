// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>
#include <map>
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

/// Whether the parts are others than before.
template <class Scalar>
bool ConjugateGradients<Scalar>::setParts(const std::vector<int>& active,
                                          const std::vector<int>& part_of_vertex) {
  const bool has_changed = runs_.set(active);
  if (!has_changed && part_of_vertex == part_of_vertex_ && !parts_.empty()) return false;
  part_of_vertex_ = part_of_vertex;
  std::vector<std::vector<int>> vertices;
  std::map<int, std::size_t> place;
  for (const int i : active) {
    const std::size_t part =
        place.emplace(part_of_vertex.empty() ? 0 : part_of_vertex[i], place.size()).first->second;
    if (part == vertices.size()) vertices.emplace_back();
    vertices[part].push_back(i);
  }
  parts_.assign(vertices.size(), Part());
  for (std::size_t part = 0; part < vertices.size(); ++part) parts_[part].runs.set(vertices[part]);
  return true;
}

/// b . b, and the parts' loads.
template <class Scalar>
double ConjugateGradients<Scalar>::begin(const DifferenceMatrix<Scalar>& matrix, const Vector& b) {
  double square_b = 0, square_mass = 0, sum = 0;
  for (Part& part : parts_) {
    part.energy = part.step_energy = part.last_energy = part.rest_energy = 0;
    part.is_solved = false;
    part.square_load = part.runs.dot(b, b);
    part.share = 0;
    for (const ActiveRuns::Run& run : part.runs.runs()) {
      for (Eigen::Index i = run.first / 3; i < (run.first + run.count) / 3; ++i)
        part.share += matrix.masses[i] * matrix.masses[i];
    }
    square_b += part.square_load;
    square_mass += part.share;
  }
  for (Part& part : parts_) {
    part.share = square_mass > 0 ? part.share / square_mass : 0;
    part.square_load = std::max(part.square_load, part.share * square_b);
    sum += part.square_load;
  }
  for (Part& part : parts_) part.square_load *= square_b / sum;  // together no more than b . b
  return square_b;
}

/// Of a part that is not solved: what is left, and whether that will do.
template <class Scalar>
void ConjugateGradients<Scalar>::look(const IterationLimits& limits, int iterations, Part& part) {
  part.square_r = part.runs.dot(r_, r_);
  if (iterations > 0) {
    // What steps gain falls off like a geometric series, if it falls.
    const double ratio = part.last_energy > 0 ? std::min(part.step_energy / part.last_energy, 0.9) : 0.5;
    part.rest_energy = part.step_energy * ratio / (1 - ratio);
  }
  // What is left of a part that hardly moves may be too small for the numbers of the iteration.
  constexpr double kRounding = 1e-15;
  if (part.square_r <= kRounding * kRounding * part.square_load) {
    part.is_solved = true;
  } else if (limits.error_target) {
    const double square_target = *limits.error_target * *limits.error_target;
    part.is_solved = iterations > 1 && part.rest_energy <= square_target * part.energy;
  } else {
    // The residual tells little of how a small piece swings on a sliver. Where all is one part, it alone
    // tells.
    constexpr double kErrorOfSmallPart = 0.1;
    const double square_tolerance = limits.tolerance * limits.tolerance;
    part.is_solved = part.square_r <= square_tolerance * part.square_load &&
                     (1 - part.share) * part.rest_energy <=
                         kErrorOfSmallPart * kErrorOfSmallPart * square_tolerance * part.energy;
  }
}

/// The next direction; false where the preconditioner is not positive.
template <class Scalar>
bool ConjugateGradients<Scalar>::turn(bool is_first, Part& part) {
  const double before = part.r_dot_z;
  part.r_dot_z = part.runs.dot(r_, z_);
  if (!(part.r_dot_z > 0) || !std::isfinite(part.r_dot_z)) return false;
  if (is_first) {
    part.runs.forEach([](auto p, const auto& z) { p = z; }, p_, z_);
  } else {
    const Scalar beta = static_cast<Scalar>(part.r_dot_z / before);
    part.runs.forEach([&](auto p, const auto& z) { p = z + beta * p; }, p_, z_);
  }
  return true;
}

/// A step along it; false where the matrix is not positive.
template <class Scalar>
bool ConjugateGradients<Scalar>::advance(Part& part, Eigen::VectorXd& x) {
  const double curvature = part.runs.dot(p_, q_);
  if (!(curvature > 0) || !std::isfinite(curvature)) return false;
  const double alpha = part.r_dot_z / curvature;
  const Scalar step = static_cast<Scalar>(alpha);
  part.runs.forEach(
      [&](auto x_run, const auto& p) { x_run += static_cast<double>(step) * p.template cast<double>(); }, x,
      p_);
  part.runs.forEach([&](auto r, const auto& q) { r -= step * q; }, r_, q_);
  part.last_energy = part.step_energy;
  part.step_energy = alpha * part.r_dot_z;
  part.energy += part.step_energy;
  return true;
}

template <class Scalar>
IterationResult ConjugateGradients<Scalar>::solve(
    const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix, const std::vector<int>& active,
    const std::vector<int>& part_of_vertex, const Vector& b, Preconditioner& preconditioner,
    const IterationLimits& limits, int num_threads, Eigen::VectorXd& x) {
  const Eigen::Index size = paddedSize(pattern.numVertices());
  POLYSCALPEL_ASSERT(b.size() == size && x.size() == size);
  if (setParts(active, part_of_vertex) || r_.size() != size) {
    for (Vector* const vector : {&r_, &z_, &p_, &q_}) vector->setZero(size);
  }
  IterationResult result;
  const double square_b = begin(matrix, b);
  if (square_b == 0) {
    x.setZero();
    return result;
  }
  runs_.forEach([](auto r, const auto& b_run) { r = b_run; }, r_, b);
  if (runs_.dot(x, x) != 0) {
    // Rounded, so that the residual is that of this very x.
    runs_.forEach(
        [](auto z, auto x_run) {
          z = x_run.template cast<Scalar>();
          x_run = z.template cast<double>();
        },
        z_, x);
    multiply(pattern, matrix, active, z_.data(), q_.data(), num_threads);
    runs_.forEach([](auto r, const auto& q) { r -= q; }, r_, q_);
    for (Part& part : parts_) part.energy = std::abs(part.runs.dot(z_, b));
  }
  while (true) {
    bool are_solved = true;
    double square_r = 0, energy = 0, rest_energy = 0;
    for (Part& part : parts_) {
      if (!part.is_solved) look(limits, result.iterations, part);
      are_solved = are_solved && part.is_solved;
      square_r += part.square_r;
      energy += part.energy;
      rest_energy += part.rest_energy;
    }
    result.relative_residual = std::sqrt(square_r / square_b);
    if (result.iterations > 0) result.estimated_error = energy > 0 ? std::sqrt(rest_energy / energy) : 0;
    if (!std::isfinite(result.relative_residual)) {
      result.end = IterationResult::End::kBreakdown;
      return result;
    }
    if (are_solved) return result;
    if (result.iterations >= limits.max_iterations) {
      result.end = IterationResult::End::kIterations;
      return result;
    }
    if (limits.deadline && result.iterations > 0 && std::chrono::steady_clock::now() >= *limits.deadline) {
      result.end = IterationResult::End::kDeadline;
      return result;
    }
    precondition(preconditioner);
    for (Part& part : parts_) {
      if (!part.is_solved && !turn(result.iterations == 0, part)) {
        result.end = IterationResult::End::kBreakdown;
        return result;
      }
    }
    multiply(pattern, matrix, active, p_.data(), q_.data(), num_threads);
    for (Part& part : parts_) {
      if (!part.is_solved && !advance(part, x)) {
        result.end = IterationResult::End::kBreakdown;
        return result;
      }
    }
    ++result.iterations;
  }
}

template class ConjugateGradients<float>;
template class ConjugateGradients<double>;

}  // namespace polyscalpel
