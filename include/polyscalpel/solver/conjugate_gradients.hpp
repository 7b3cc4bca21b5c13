// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/difference_matrix.hpp"
#include "polyscalpel/solver/active_runs.hpp"
#include "polyscalpel/solver/preconditioner.hpp"

namespace polyscalpel {

struct IterationLimits {
  /// |r| / |b|. A part may leave so much of its load, or of its share of all loads by mass where that is
  /// more; a small one goes on until its estimated error, too, is below a tenth of it.
  double tolerance = 1e-4;
  /// Instead: estimated error of each part in the norm of A, relative to x.
  std::optional<double> error_target;
  int max_iterations = 500;
  std::optional<std::chrono::steady_clock::time_point> deadline;  ///< ends it, after the first iteration
};

struct IterationResult {
  enum class End {
    kConverged,
    kDeadline,
    kIterations,  ///< max_iterations
    kBreakdown,   ///< a number that is not finite, or A or B not positive along a direction
  };
  End end = End::kConverged;
  int iterations = 0;
  double relative_residual = 0;  ///< |r| / |b|, r updated from step to step
  double estimated_error = 0;    ///< |x - A^-1 b| / |x| in the norm of A
};

/// Preconditioned conjugate gradients (M. Hestenes, E. Stiefel, "Methods of Conjugate Gradients for Solving
/// Linear Systems", 1952). The error is told by their theorem 6:1: |x_k - x|^2 in the norm of A is the sum
/// of alpha_j r_j.z_j over all later steps j (Z. Strakos, P. Tichy, "On Error Estimation in the Conjugate
/// Gradient Method and Why It Works in Finite Precision Computations", 2002); of these the next few are taken
/// from how the last ones fell. Sums run in double precision, in a fixed order.
///
/// Parts that no entry of A joins, nor the preconditioner, are iterated side by side, each by its own sums,
/// so that none waits for what is hard in another, and each ends by itself: a light piece's residual would
/// hardly show in that of all, and it would spin.
template <class Scalar>
class ConjugateGradients {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  /// Solves A x = b from the x that is given. x is summed up in double precision: stiff cells make forces of
  /// what rounding it to single precision changes. b, x: of paddedSize(), zero at vertices that are not
  /// active. part_of_vertex: a number of each active vertex's part; empty: all are one.
  IterationResult solve(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix,
                        const std::vector<int>& active, const std::vector<int>& part_of_vertex,
                        const Vector& b, Preconditioner& preconditioner, const IterationLimits& limits,
                        int num_threads, Eigen::VectorXd& x);

 private:
  struct Part {
    ActiveRuns runs;
    double share = 0;        // of the sum of the masses' squares
    double square_load = 0;  // its part of b . b, by what it may leave
    double square_r = 0;
    double r_dot_z = 0;
    double energy = 0, step_energy = 0, last_energy = 0, rest_energy = 0;
    bool is_solved = false;
  };

  bool setParts(const std::vector<int>& active, const std::vector<int>& part_of_vertex);
  double begin(const DifferenceMatrix<Scalar>& matrix, const Vector& b);
  void look(const IterationLimits& limits, int iterations, Part& part);
  bool turn(bool is_first, Part& part);
  bool advance(Part& part, Eigen::VectorXd& x);
  void precondition(Preconditioner& preconditioner);

  std::vector<int> part_of_vertex_;
  ActiveRuns runs_;
  std::vector<Part> parts_;
  Vector r_, z_, p_, q_;
  Eigen::VectorXf single_r_, single_z_;  // of the iteration in double precision
};

extern template class ConjugateGradients<float>;
extern template class ConjugateGradients<double>;

}  // namespace polyscalpel
