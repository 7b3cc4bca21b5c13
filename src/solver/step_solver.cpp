// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/step_solver.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "ban.hpp"
#include "earlier_solutions.hpp"
#include "factor_maker.hpp"
#include "movable_parts.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/solver/aggregates.hpp"
#include "polyscalpel/solver/block_jacobi.hpp"
#include "polyscalpel/solver/conjugate_gradients.hpp"

namespace polyscalpel {

namespace {

/// Up to so many vertices that move, a factor's solve costs less than the iterations it saves.
constexpr std::size_t kFewVertices = 6000;
/// Where stiffness is less than this many times the mass in the matrix, diagonal blocks need few iterations.
constexpr double kMildStiffness = 4;
/// A patch of more than this part of the factor's vertices costs as much as it saves, sooner one that each
/// further cut makes larger.
constexpr double kLargestPatch = 0.35, kLargestGrown = 0.2;
/// Contacts so stiff that single precision does not hold them in the factor: what takes more iterations than
/// this costs more than factoring the matrix does.
constexpr int kMostForContacts = 30;
/// With a patch, so many iterations for each digit of the solution cost more than to factor it anew, if cells
/// have turned since, or the whole body.
constexpr double kMostADigitWithPatch = 6;
/// Where steps with a patch take more iterations than this, as beside a slit that opens wide, or the patch is
/// larger than it may grow, the next factor is taken over after as many steps as one takes to be made.
constexpr int kManyWithPatch = 12, kSoonestFactor = 4;
/// Where aggregates take more iterations than this, by slivers or loose pieces, a factor is tried.
constexpr int kManyIterations = 70;
/// A finer tolerance is not for single precision: rounding x alone leaves more.
constexpr double kSingleTolerance = 1e-5;

using Clock = std::chrono::steady_clock;

/// The largest ratio of stiffness to mass on the diagonal.
double stiffnessOverMass(const RowPattern& pattern, const DifferenceMatrix<double>& matrix,
                         const std::vector<int>& active) {
  double largest = 0;
  for (const int i : active) {
    const double mass = matrix.masses[i];
    if (mass > 0) largest = std::max(largest, diagonalBlock(pattern, matrix, i).trace() / (3 * mass) - 1);
  }
  return largest;
}

}  // namespace

struct StepSolver::Impl {
  SolverConfig config;
  bool is_restarted = true;
  bool is_cut = false;     // since the last solve
  bool had_patch = false;  // the factor, before that
  bool is_stale = false;   // factor or aggregates are of the body before a cut, or there is no factor
  int stale_steps = 0;
  int last_iterations = 0;
  bool has_stiff_contacts = false;  // from the step on that found it, until nothing touches
  Ban of_single, of_iterations;
  int many_iterations_since = 0;        // steps in a row
  int many_iterations_most = 0;         // of these steps
  bool was_factor_tried = false;        // instead of aggregates
  bool prefers_factor = false;          // to aggregates, however many vertices move
  SolverKind kind = SolverKind::kAuto;  // what the config or the choice says
  std::string reason;

  std::vector<bool> fixed;
  DifferenceMatrix<double> body_matrix;  // of all that is movable, without contacts
  std::vector<float> body_rotations;     // of the vertices in it; empty: it is of the rest shape
  std::optional<TurnedFactor> factor;
  FactorMaker factors;
  std::optional<AggregatePreconditioner> aggregates;
  std::vector<AddedVertex> added;  // by cuts that aggregates have not followed yet
  BlockJacobi jacobi;
  std::vector<float> rotations;

  // What belongs to one precision.
  template <class Scalar>
  struct Lane {
    DifferenceMatrix<Scalar> matrix;
    ConjugateGradients<Scalar> iteration;
    Eigen::Matrix<Scalar, Eigen::Dynamic, 1> b;
    Eigen::VectorXd x;
    EarlierSolutions::Room<Scalar> earlier;
    ActiveRuns runs;
  };
  std::optional<MovableParts> parts;  // found when first asked for
  // Of parts that neither the matrix nor what preconditions joins; empty: all are one.
  std::vector<int> part_of_vertex;

  Lane<float> single;
  Lane<double> twofold;
  EarlierSolutions solutions;

  DirectSolver direct;
  BlockPattern direct_pattern;
  bool is_direct_analysed = false;
  std::vector<bool> direct_still;  // analysed without these
  Blocks blocks;

  explicit Impl(const SolverConfig& given) : config(given) { validate(config); }
  double finest() const { return config.error_target ? *config.error_target : config.tolerance; }

  void choose(StepSystem& system);
  bool iterateOrGiveUp(StepSystem& system, const Eigen::Matrix3Xd& b, Clock::time_point step_start,
                       Eigen::Matrix3Xd& x, SolverReport& report, SolveResult& result);
  void noteIterations(const SolverReport& report);
  void replaceAggregates(StepSystem& system);
  void takeFixed(StepSystem& system);
  void takeBodyAtRest(StepSystem& system);
  void takeBodyAsItLies(StepSystem& system);
  void prepare(StepSystem& system);
  void refresh(StepSystem& system);
  void takeNextFactor();
  void takeFactor(FactorMaker::Made made);
  FactorMaker::Body bodyForFactor(StepSystem& system) const;
  bool hasPatchOf(double part) const;
  void replaceLargePatch(StepSystem& system);
  void renewPatchOrFactor(StepSystem& system);
  void makeFactorAtOnce(StepSystem& system);
  void prepareAggregates(StepSystem& system);
  void followByAggregates(StepSystem& system);
  void refreshAggregates(StepSystem& system);
  template <class Scalar>
  SolveStatus update(StepSystem& system, Lane<Scalar>& lane, Preconditioner& chosen);
  Preconditioner& preconditioner(StepSystem& system, SolverReport& report);
  IterationLimits limitsOf(bool is_touched, Clock::time_point step_start) const;
  template <class Scalar>
  void startFromEarlier(const StepSystem& system, Lane<Scalar>& lane);
  template <class Scalar>
  bool iterate(StepSystem& system, Lane<Scalar>& lane, const Eigen::Matrix3Xd& b,
               Clock::time_point step_start, Eigen::Matrix3Xd& x, SolverReport& report, SolveResult& result);
  SolveResult solveDirectly(StepSystem& system, const Eigen::Matrix3Xd& b, Eigen::Matrix3Xd& x);
};

void StepSolver::Impl::choose(StepSystem& system) {
  kind = config.kind;
  if (kind != SolverKind::kAuto) {
    reason = "the scene asks for it";
    return;
  }
  const std::size_t moving = system.movable().size();
  const double ratio = stiffnessOverMass(system.pattern(), body_matrix, system.movable());
  if (ratio < kMildStiffness) {
    kind = SolverKind::kJacobi;
    reason = "the step is short: mass outweighs stiffness";
  } else if (prefers_factor) {
    kind = SolverKind::kFactor;
    reason = "aggregates took more than " + std::to_string(kManyIterations) + " iterations";
  } else if (moving <= kFewVertices) {
    kind = SolverKind::kFactor;
    reason = "at most " + std::to_string(kFewVertices) + " vertices move";
  } else {
    kind = SolverKind::kAggregates;
    reason = "more than " + std::to_string(kFewVertices) + " vertices move";
  }
}

void StepSolver::Impl::takeFixed(StepSystem& system) {
  fixed.assign(system.pattern().numVertices(), true);
  for (const int i : system.movable()) fixed[i] = false;
}

void StepSolver::Impl::takeBodyAtRest(StepSystem& system) {
  takeFixed(system);
  system.assembleAtRest(body_matrix);
  body_rotations.clear();
}

// Where cuts leave thin parts, a factor of the body as it lies takes a third of the iterations or less.
void StepSolver::Impl::takeBodyAsItLies(StepSystem& system) {
  takeFixed(system);
  system.assembleBody(body_matrix, body_rotations);
}

// What depends on the pattern and on which vertices move.
void StepSolver::Impl::prepare(StepSystem& system) {
  factors = {};  // waits for one under way
  factor.reset();
  solutions.clear();
  is_direct_analysed = false;
  parts.reset();
  of_single = of_iterations = {};
  many_iterations_since = 0;
  was_factor_tried = prefers_factor = false;
  prepareAggregates(system);
  choose(system);
  if (kind == SolverKind::kFactor) {
    takeFactor(factors.make(bodyForFactor(system)));
  }
  is_restarted = is_cut = is_stale = false;
  stale_steps = 0;
}

// A factor of the cut body is begun and taken over at fixed steps, so that a machine's speed does not tell
// which step has it. Cuts that come in between are a patch to it, and the next one's reason.
void StepSolver::Impl::refresh(StepSystem& system) {
  ++stale_steps;
  if (kind == SolverKind::kAggregates) return refreshAggregates(system);
  // Not in the first step after a cut, which has the patch to factor.
  if (!factors.isUnderWay() && stale_steps >= std::min(2, config.refresh_after_steps)) {
    takeBodyAsItLies(system);
    choose(system);  // cuts make vertices
    if (kind != SolverKind::kFactor) {
      factor.reset();
      prepareAggregates(system);
      is_stale = false;
      return;
    }
    factors.begin(bodyForFactor(system));
  }
  const bool is_hard = last_iterations > kManyWithPatch || hasPatchOf(kLargestGrown);
  if (stale_steps >
      (is_hard ? std::min(kSoonestFactor, config.refresh_after_steps) : config.refresh_after_steps))
    takeNextFactor();
  if (!factor) prepareAggregates(system);
}

FactorMaker::Body StepSolver::Impl::bodyForFactor(StepSystem& system) const {
  return {system.pattern(), body_matrix, fixed, body_rotations};
}

void StepSolver::Impl::takeNextFactor() {
  is_stale = factors.wasCutSince();
  stale_steps = is_stale ? 1 : 0;  // the next one begins in the next step
  takeFactor(factors.take());
}

void StepSolver::Impl::takeFactor(FactorMaker::Made made) {
  factor = std::move(made.factor);
  if (factor) return;
  is_stale = false;
  kind = SolverKind::kAggregates;
  reason = std::string("of the body's factor, ") + toString(made.status);
}

bool StepSolver::Impl::hasPatchOf(double part) const {
  return factor && factor->patchSize() > part * factor->numVertices();
}

// Where cuts have touched too much, a step waits for the factor that is under way, or for one of its own.
void StepSolver::Impl::replaceLargePatch(StepSystem& system) {
  const double largest = had_patch ? kLargestGrown : kLargestPatch;
  if (hasPatchOf(largest) && factors.isUnderWay()) takeNextFactor();
  if (hasPatchOf(largest)) makeFactorAtOnce(system);
}

void StepSolver::Impl::renewPatchOrFactor(StepSystem& system) {
  if (factor->hasOldPatch()) {
    factor->renewPatch();
  } else {
    makeFactorAtOnce(system);
  }
}

void StepSolver::Impl::makeFactorAtOnce(StepSystem& system) {
  takeBodyAsItLies(system);
  choose(system);  // cuts make vertices
  is_stale = false;
  stale_steps = 0;
  if (kind == SolverKind::kFactor) {
    takeFactor(factors.makeAtOnce(bodyForFactor(system)));
  } else {
    factor.reset();
  }
  if (!factor) prepareAggregates(system);
}

void StepSolver::Impl::noteIterations(const SolverReport& report) {
  const bool are_many = config.kind == SolverKind::kAuto && kind == SolverKind::kAggregates &&
                        report.iterations > kManyIterations;
  many_iterations_most = are_many ? std::max(many_iterations_most, report.iterations) : 0;
  many_iterations_since = are_many ? many_iterations_since + 1 : 0;
}

// By what has to be read for it, a factor pays off where it spares enough iterations: those with it are taken
// for 8.
void StepSolver::Impl::replaceAggregates(StepSystem& system) {
  was_factor_tried = true;
  constexpr double kIterationsWithFactor = 8, kSlowness = 0.75;  // the matrix is read slower than the factor
  const double spared = many_iterations_most / kIterationsWithFactor - 1;
  takeBodyAsItLies(system);
  const double most_values = spared * kSlowness * static_cast<double>(body_matrix.blocks.size());
  FactorMaker::Made made = factors.make(bodyForFactor(system), static_cast<std::size_t>(most_values));
  if (!made.factor) return;
  prefers_factor = true;
  choose(system);
  aggregates.reset();
  takeFactor(std::move(made));
}

// The aggregates of the body as it is now are made when they are first asked for.
void StepSolver::Impl::prepareAggregates(StepSystem& system) {
  takeBodyAtRest(system);
  aggregates.reset();
  added.clear();
}

void StepSolver::Impl::followByAggregates(StepSystem& system) {
  if (!aggregates || !aggregates->follow(added, system.restPositions())) {
    prepareAggregates(system);
    is_stale = false;
  }
  added.clear();
}

void StepSolver::Impl::refreshAggregates(StepSystem& system) {
  if (stale_steps <= config.refresh_after_steps && last_iterations <= kManyIterations) return;
  prepareAggregates(system);
  is_stale = false;
  many_iterations_since = 0;
}

Preconditioner& StepSolver::Impl::preconditioner(StepSystem& system, SolverReport& report) {
  report.kind = kind;
  if (report.kind == SolverKind::kAggregates && !aggregates) {
    aggregates.emplace();
    const SolveStatus status =
        aggregates->make(system.pattern(), body_matrix, system.restPositions(), system.movable());
    if (status != SolveStatus::kSolved) {
      report.kind = kind = SolverKind::kJacobi;
      reason = std::string("of the aggregates' factor, ") + toString(status);
    }
  }
  if (report.kind != SolverKind::kJacobi) system.vertexRotations(rotations);
  switch (report.kind) {
    case SolverKind::kFactor:
      return *factor;
    case SolverKind::kAggregates:
      return *aggregates;
    default:
      return jacobi;
  }
}

// The preconditioner learns of the matrix as it is now.
template <class Scalar>
SolveStatus StepSolver::Impl::update(StepSystem& system, Lane<Scalar>& lane, Preconditioner& chosen) {
  const std::vector<int>& active = system.active();
  if (&chosen == &jacobi) jacobi.update(system.pattern(), lane.matrix, active, config.threads);
  if (aggregates && &chosen == &*aggregates)
    return aggregates->update(system.pattern(), lane.matrix, active, rotations, config.threads);
  if (factor && &chosen == &*factor) {
    if (std::is_same_v<Scalar, double> && (factor->patchSize() > 0 || !lane.matrix.ties.empty()))
      system.assemble(single.matrix);
    return factor->update(system.pattern(), single.matrix, rotations, active);
  }
  return SolveStatus::kSolved;
}

template <class Scalar>
void StepSolver::Impl::startFromEarlier(const StepSystem& system, Lane<Scalar>& lane) {
  solutions.guess(system.pattern(), lane.matrix, system.active(), lane.runs, lane.b, config.threads,
                  lane.earlier, lane.x);
}

IterationLimits StepSolver::Impl::limitsOf(bool is_touched, Clock::time_point step_start) const {
  IterationLimits limits;
  limits.tolerance = config.tolerance;
  limits.error_target = config.error_target;
  limits.max_iterations =
      is_touched ? std::min(config.max_iterations, kMostForContacts) : config.max_iterations;
  if (config.step_budget_ms) {
    limits.deadline = step_start + std::chrono::duration_cast<Clock::duration>(
                                       std::chrono::duration<double, std::milli>(*config.step_budget_ms));
  }
  return limits;
}

// Whether it came to an end that will do.
template <class Scalar>
bool StepSolver::Impl::iterate(StepSystem& system, Lane<Scalar>& lane, const Eigen::Matrix3Xd& b,
                               Clock::time_point step_start, Eigen::Matrix3Xd& x, SolverReport& report,
                               SolveResult& result) {
  const std::vector<int>& active = system.active();
  system.assemble(lane.matrix);
  const bool is_touched = kind == SolverKind::kFactor && !lane.matrix.ties.empty();
  has_stiff_contacts = has_stiff_contacts && is_touched;
  if (has_stiff_contacts) return false;
  Preconditioner& chosen = preconditioner(system, report);
  result.status = update(system, lane, chosen);
  // A patch is of the matrix in single precision, which slivers may be too much for.
  if (result.status != SolveStatus::kSolved && kind == SolverKind::kFactor && factor->patchSize() > 0) {
    makeFactorAtOnce(system);
    if (!factor) return false;
    result.status = update(system, lane, chosen);
  }
  if (result.status != SolveStatus::kSolved) {
    has_stiff_contacts = !lane.matrix.holds.empty();
    return false;
  }

  // Of length one, so that single precision neither over- nor underflows.
  double square = 0;
  for (const int i : active) square += b.col(i).squaredNorm();
  const double length = std::sqrt(square);
  if (!std::isfinite(length)) {
    result.status = SolveStatus::kNotFinite;
    return false;
  }
  const Eigen::Index size = paddedSize(system.pattern().numVertices());
  if (lane.runs.set(active) || lane.b.size() != size) {
    lane.b.setZero(size);
    lane.x.setZero(size);
    lane.earlier = {};
  }
  for (const int i : active) {
    for (int c = 0; c < 3; ++c)
      lane.b[3 * i + c] = length > 0 ? static_cast<Scalar>(b(c, i) / length) : Scalar(0);
  }
  startFromEarlier(system, lane);
  IterationLimits limits = limitsOf(is_touched, step_start);
  const int most_iterations = limits.max_iterations;
  const int most_with_patch = static_cast<int>(kMostADigitWithPatch * std::max(-std::log10(finest()), 1.0));
  if (!parts) parts.emplace(system.pattern(), system.movable());
  // What is of the body before a cut joins the parts that the cut has made.
  if (!is_stale) part_of_vertex = parts->partOfVertex();
  const auto hasFailed = [&](const IterationResult& done) {
    return done.end == IterationResult::End::kIterations || done.end == IterationResult::End::kBreakdown ||
           !lane.x.allFinite();
  };
  IterationResult done;
  while (true) {
    const bool has_patch = kind == SolverKind::kFactor && factor->patchSize() > 0;
    limits.max_iterations = has_patch ? std::min(most_iterations, most_with_patch) : most_iterations;
    done = lane.iteration.solve(system.pattern(), lane.matrix, active, part_of_vertex, lane.b, chosen, limits,
                                config.threads, lane.x);
    report.iterations += done.iterations;
    if (!has_patch || !hasFailed(done)) break;
    renewPatchOrFactor(system);
    if (!factor) return false;
    result.status = update(system, lane, chosen);
    if (result.status != SolveStatus::kSolved) return false;
    if (!lane.x.allFinite()) startFromEarlier(system, lane);
  }
  report.is_single = std::is_same_v<Scalar, float>;
  report.estimated_error = done.estimated_error;
  report.budget_ended = report.budget_ended || done.end == IterationResult::End::kDeadline;
  result.relative_residual = done.relative_residual;
  has_stiff_contacts = is_touched && done.end == IterationResult::End::kIterations;
  if (hasFailed(done)) {
    result.status = SolveStatus::kInaccurate;
    return false;
  }
  x.setZero(3, b.cols());
  for (const int i : active) {
    for (int c = 0; c < 3; ++c) x(c, i) = length * lane.x[3 * i + c];
  }
  parts->keepMomentum(lane.matrix, active, b, x);
  if (length > 0) solutions.keep(active, lane.runs, lane.x, config.projection);
  result.status = SolveStatus::kSolved;
  return true;
}

SolveResult StepSolver::Impl::solveDirectly(StepSystem& system, const Eigen::Matrix3Xd& b,
                                            Eigen::Matrix3Xd& x) {
  SolveResult result;
  std::vector<bool> still(system.pattern().numVertices(), true);
  for (const int i : system.active()) still[i] = false;
  if (!is_direct_analysed || still != direct_still) {
    is_direct_analysed = false;
    direct_pattern = toBlockPattern(system.pattern());
    result.status = direct.analyse(direct_pattern, still);
    if (result.status != SolveStatus::kSolved) return result;
    direct_still = std::move(still);
    is_direct_analysed = true;
  }
  system.assemble(twofold.matrix);
  convert(system.pattern(), twofold.matrix, direct_pattern, blocks);
  result.status = direct.factorise(direct_pattern, blocks);
  if (result.status != SolveStatus::kSolved) return result;
  return direct.solve(b, x);
}

StepSolver::StepSolver(const SolverConfig& config) : impl_(std::make_unique<Impl>(config)) {}
StepSolver::~StepSolver() = default;
StepSolver::StepSolver(StepSolver&&) noexcept = default;
StepSolver& StepSolver::operator=(StepSolver&&) noexcept = default;

void StepSolver::restart() {
  impl_->is_restarted = true;
}

void StepSolver::follow(const std::vector<AddedVertex>& added, const std::vector<int>& touched) {
  Impl& s = *impl_;
  if (s.is_restarted) return;
  if (!s.is_cut) s.had_patch = s.hasPatchOf(0);
  s.is_cut = true;
  if ((s.kind == SolverKind::kFactor || s.kind == SolverKind::kAggregates) && !s.is_stale) {
    s.is_stale = true;
    s.stale_steps = 0;
  }
  s.is_direct_analysed = false;
  s.parts.reset();
  MovableParts::follow(added, s.part_of_vertex);
  s.solutions.clear();
  s.factors.follow(added, touched);
  if (s.factor) s.factor->follow(added, touched);
  if (s.aggregates) s.added.insert(s.added.end(), added.begin(), added.end());
}

// In single precision, then in double; whether it came to an end that will do.
bool StepSolver::Impl::iterateOrGiveUp(StepSystem& system, const Eigen::Matrix3Xd& b,
                                       Clock::time_point step_start, Eigen::Matrix3Xd& x,
                                       SolverReport& report, SolveResult& result) {
  const bool is_single = config.precision == Precision::kSingle ||
                         (config.precision == Precision::kAuto && finest() >= kSingleTolerance);
  if (is_single && !of_single.holds()) {
    if (iterate(system, single, b, step_start, x, report, result)) {
      of_single.noteSuccess();
      of_iterations.noteSuccess();
      return true;
    }
    if (has_stiff_contacts) return false;
    ++report.fallbacks;
  }
  if (result.status == SolveStatus::kNotFinite) return false;
  if (iterate(system, twofold, b, step_start, x, report, result)) {
    if (is_single && !of_single.holds()) of_single.noteFailure();
    of_iterations.noteSuccess();
    return true;
  }
  if (has_stiff_contacts) return false;
  ++report.fallbacks;
  of_iterations.noteFailure();
  return false;
}

SolveResult StepSolver::solve(StepSystem& system, const Eigen::Matrix3Xd& b, bool begins_step,
                              Clock::time_point step_start, Eigen::Matrix3Xd& x, SolverReport& report) {
  Impl& s = *impl_;
  if (s.is_restarted) {
    s.prepare(system);
  } else {
    if (s.is_cut) {
      if (s.factor) {
        s.replaceLargePatch(system);
      } else {
        s.followByAggregates(system);
      }
      s.many_iterations_since = 0;
      s.was_factor_tried = false;
    }
    s.is_cut = false;
    if (begins_step) {
      s.of_single.beginStep();
      s.of_iterations.beginStep();
      if (s.is_stale) s.refresh(system);
      if (s.many_iterations_since >= 2 && !s.was_factor_tried) s.replaceAggregates(system);
    }
  }
  report.reason = s.reason;
  SolveResult result;
  if (s.kind != SolverKind::kDirect) {
    if (s.of_iterations.holds()) {
      report.reason = "conjugate gradients failed some steps ago";
    } else if (s.iterateOrGiveUp(system, b, step_start, x, report, result)) {
      s.noteIterations(report);
      s.last_iterations = report.iterations;
      return result;
    } else {
      report.reason = s.has_stiff_contacts ? "contacts are too many or too stiff to iterate with"
                                           : "conjugate gradients failed";
    }
  }
  report.kind = SolverKind::kDirect;
  report.is_single = false;
  report.estimated_error = 0;
  return s.solveDirectly(system, b, x);
}

}  // namespace polyscalpel
