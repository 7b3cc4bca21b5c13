// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

namespace polyscalpel {

/// How the linear system of a step is solved. All but kDirect are conjugate gradients that go on until
/// SolverConfig::tolerance; they need Strain::kCorotated.
enum class SolverKind {
  kAuto,        ///< chosen by strain, size, step and stiffness; the status says what and why
  kDirect,      ///< a sparse Cholesky factor (CHOLMOD) in every step: exact, slow
  kJacobi,      ///< 3 x 3 diagonal blocks: for steps so short that mass outweighs stiffness
  kFactor,      ///< the rest shape's factor turned with each vertex: small bodies
  kAggregates,  ///< diagonal blocks and the rigid motions of groups of vertices: large bodies
};

/// Numbers of the matrix and of the iteration.
enum class Precision {
  kAuto,    ///< single where the tolerance allows, double otherwise
  kSingle,  ///< state, forces and the right-hand side stay double
  kDouble,
};

struct SolverConfig {
  SolverKind kind = SolverKind::kAuto;
  /// In [1e-12, 0.1]: |A x - b| / |b|, at which conjugate gradients end, A x - b followed from iteration to
  /// iteration; of parts of a body that nothing joins, each by its own load. In single precision rounding A
  /// comes on top, which tells where a piece turns about stiff slivers.
  double tolerance = 1e-4;
  /// In [1e-10, 0.1]: if given, they end instead where the estimated error of x, relative to x, both in the
  /// norm of A, is below this.
  std::optional<double> error_target;
  int max_iterations = 500;  ///< in [1, 100000]
  int projection = 4;        ///< in [0, 20]: earlier solutions that a step starts from
  Precision precision = Precision::kAuto;
  int threads = 1;  ///< in [1, 256]; the same bits for any number
  /// In (0, 1e6] ms: if given, conjugate gradients end once a step has taken this long, with the error that
  /// is left; what a step computes then depends on the machine's speed.
  std::optional<double> step_budget_ms;
  /// In [1, 1000000]: so many steps after a cut kFactor takes over a factor of the cut body; until then the
  /// old one serves, with a patch around the slit. Sooner, at most four steps, where that takes many
  /// iterations or the patch grows; at once where it is too large. So many steps after a cut kAggregates
  /// makes its groups anew.
  int refresh_after_steps = 10;
};

/// Throws std::invalid_argument with name, value and range.
void validate(const SolverConfig& config);

const char* toString(SolverKind kind);

}  // namespace polyscalpel
