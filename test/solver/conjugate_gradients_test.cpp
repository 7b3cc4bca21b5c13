// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/conjugate_gradients.hpp"

#include <limits>

#include <numeric>

#include <gtest/gtest.h>

#include "polyscalpel/solver/aggregates.hpp"
#include "polyscalpel/solver/block_jacobi.hpp"
#include "support/body_system.hpp"
#include "support/small_bodies.hpp"

namespace polyscalpel {
namespace {

using End = IterationResult::End;

/// A system whose exact solution is known, and preconditioners for it.
template <class Scalar>
struct Problem {
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  BodySystem system;
  DifferenceMatrix<Scalar> matrix;
  DifferenceMatrix<double> exact_matrix;
  std::vector<float> rotations;
  BlockJacobi jacobi;
  AggregatePreconditioner aggregates;
  Vector b;
  Eigen::VectorXd exact;

  explicit Problem(const PolyhedralMesh& mesh = makeTetBeam(4)) : system(mesh) {
    system.linearise(shake(bend(mesh.restPositions(), 0.4, 1.2), 0.005, 1));
    system.assemble(matrix);
    system.assemble(exact_matrix);
    system.vertexRotations(rotations);
    jacobi.update(system.pattern(), matrix, system.active(), 1);
    DifferenceMatrix<double> at_rest;
    system.assembleAtRest(at_rest);
    EXPECT_EQ(aggregates.make(system.pattern(), at_rest, system.restPositions(), system.active()),
              SolveStatus::kSolved);
    aggregates.update(system.pattern(), matrix, system.active(), rotations, 1);
    Eigen::Matrix3Xd load = someLoad(system, 2);
    load /= load.norm();
    b = toPadded<Scalar>(system, load);
    exact = toPadded<double>(system, solveByFactor(system, load));
  }

  Eigen::VectorXd zero() const { return Eigen::VectorXd::Zero(b.size()); }

  IterationResult solve(const IterationLimits& limits, Eigen::VectorXd& x, Preconditioner& preconditioner) {
    ConjugateGradients<Scalar> iteration;
    return iteration.solve(system.pattern(), matrix, system.active(), {}, b, preconditioner, limits, 1, x);
  }
  IterationResult solve(const IterationLimits& limits, Eigen::VectorXd& x) {
    return solve(limits, x, jacobi);
  }

  double energyNorm(const Eigen::VectorXd& x) const {
    Eigen::VectorXd product = Eigen::VectorXd::Zero(x.size());
    multiply(system.pattern(), exact_matrix, system.active(), x.data(), product.data());
    return std::sqrt(x.dot(product));
  }
  /// |x - A^-1 b| / |A^-1 b| in the norm of A.
  double errorOf(const Eigen::VectorXd& x) const { return energyNorm(x - exact) / energyNorm(exact); }
};

IterationLimits withTolerance(double tolerance) {
  IterationLimits limits;
  limits.tolerance = tolerance;
  limits.max_iterations = 10000;
  return limits;
}

TEST(ConjugateGradients, ConvergesToTheExactSolution) {
  for (const bool by_groups : {false, true}) {
    Problem<double> problem;
    Preconditioner* preconditioner = &problem.jacobi;
    if (by_groups) preconditioner = &problem.aggregates;
    Eigen::VectorXd x = problem.zero();
    const IterationResult result = problem.solve(withTolerance(1e-11), x, *preconditioner);
    EXPECT_EQ(result.end, End::kConverged);
    EXPECT_LE(result.relative_residual, 1e-11);
    EXPECT_LT((x - problem.exact).norm(), 1e-9 * problem.exact.norm());

    Problem<float> single;
    Eigen::VectorXd x_single = single.zero();
    if (by_groups) {
      EXPECT_EQ(single.solve(withTolerance(1e-6), x_single, single.aggregates).end, End::kConverged);
    } else {
      EXPECT_EQ(single.solve(withTolerance(1e-6), x_single).end, End::kConverged);
    }
    EXPECT_LT(single.errorOf(x_single), 1e-5);
  }
}

TEST(ConjugateGradients, ToldResidualIsTheTrueOne) {
  Problem<double> problem;
  for (const double tolerance : {1e-2, 1e-5, 1e-9}) {
    Eigen::VectorXd x = problem.zero(), product = problem.zero();
    const IterationResult result = problem.solve(withTolerance(tolerance), x);
    multiply(problem.system.pattern(), problem.matrix, problem.system.active(), x.data(), product.data());
    const double residual = (product - problem.b).norm() / problem.b.norm();
    EXPECT_NEAR(result.relative_residual, residual, 1e-3 * residual);
    EXPECT_LE(residual, tolerance * 1.001);
  }
}

template <class Scalar>
void expectTrueEstimates(const std::vector<double>& tolerances) {
  Problem<Scalar> problem;
  for (Preconditioner* const preconditioner :
       {static_cast<Preconditioner*>(&problem.jacobi), static_cast<Preconditioner*>(&problem.aggregates)}) {
    for (const double tolerance : tolerances) {
      auto x = problem.zero();
      const IterationResult result = problem.solve(withTolerance(tolerance), x, *preconditioner);
      ASSERT_EQ(result.end, End::kConverged);
      const double error = problem.errorOf(x);
      EXPECT_LT(result.estimated_error, 10 * error) << tolerance;
      EXPECT_GT(result.estimated_error, 0.1 * error) << tolerance;
    }
  }
}

TEST(ConjugateGradients, ErrorIsEstimatedWithinAFactorOfTen) {
  expectTrueEstimates<double>({1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8});
  expectTrueEstimates<float>({1e-1, 1e-2, 1e-3, 1e-4});
}

TEST(ConjugateGradients, EndsAtAnErrorTarget) {
  Problem<double> problem;
  int last = 0;
  for (const double target : {1e-1, 1e-2, 1e-4, 1e-6}) {
    IterationLimits limits = withTolerance(1e-12);  // plays no part then
    limits.error_target = target;
    Eigen::VectorXd x = problem.zero();
    const IterationResult result = problem.solve(limits, x);
    EXPECT_EQ(result.end, End::kConverged);
    EXPECT_LE(result.estimated_error, target);
    EXPECT_LT(problem.errorOf(x), 10 * target);
    EXPECT_GT(problem.errorOf(x), 0.01 * target);  // and not long after it
    EXPECT_GT(result.iterations, last);
    last = result.iterations;
  }
}

TEST(ConjugateGradients, ErrorFallsWithEveryIteration) {
  Problem<double> problem;
  double last = 1;
  for (int iterations = 1; iterations <= 20; ++iterations) {
    IterationLimits limits = withTolerance(1e-12);
    limits.max_iterations = iterations;
    Eigen::VectorXd x = problem.zero();
    problem.solve(limits, x);
    EXPECT_LT(problem.errorOf(x), last) << iterations;
    last = problem.errorOf(x);
  }
}

TEST(ConjugateGradients, NoLoadIsSolvedByZero) {
  Problem<float> problem;
  problem.b.setZero();
  for (const bool from_zero : {true, false}) {
    Eigen::VectorXd x = problem.zero();
    if (!from_zero) x = problem.exact;
    const IterationResult result = problem.solve(withTolerance(1e-4), x);
    EXPECT_EQ(result.end, End::kConverged);
    EXPECT_EQ(result.iterations, 0);
    EXPECT_EQ(result.relative_residual, 0);
    EXPECT_EQ(result.estimated_error, 0);
    EXPECT_TRUE(x.isZero(0));
  }
}

TEST(ConjugateGradients, StartsFromWhatIsGiven) {
  Problem<double> problem;
  Eigen::VectorXd x = problem.exact;
  IterationResult result = problem.solve(withTolerance(1e-6), x);
  EXPECT_EQ(result.end, End::kConverged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(x, problem.exact);
  // From anywhere to the same place.
  x = toPadded<double>(problem.system, shake(Eigen::Matrix3Xd::Zero(3, problem.exact.size() / 3), 1, 3));
  result = problem.solve(withTolerance(1e-11), x);
  EXPECT_EQ(result.end, End::kConverged);
  EXPECT_LT(problem.errorOf(x), 1e-9);
}

TEST(ConjugateGradients, BreaksDownOnNumbersThatAreNotFinite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInfinity}) {
    Problem<double> problem;
    const Eigen::VectorXd b = problem.b;
    const int vertex = problem.system.active()[40];
    Eigen::VectorXd x = problem.zero();
    problem.b[3 * vertex + 1] = bad;
    EXPECT_EQ(problem.solve(withTolerance(1e-4), x).end, End::kBreakdown);
    problem.b = b;
    x = problem.zero();
    x[3 * vertex + 1] = bad;
    EXPECT_EQ(problem.solve(withTolerance(1e-4), x).end, End::kBreakdown);
    x = problem.zero();
    problem.matrix.masses[vertex] = bad;
    EXPECT_EQ(problem.solve(withTolerance(1e-4), x).end, End::kBreakdown);
    problem.matrix = problem.exact_matrix;
    x = problem.zero();
    EXPECT_EQ(problem.solve(withTolerance(1e-4), x).end, End::kConverged);
  }
}

TEST(ConjugateGradients, BreaksDownOnAMatrixThatIsNotPositive) {
  Problem<double> problem;
  for (double& mass : problem.matrix.masses) mass = -mass;
  for (double& number : problem.matrix.blocks) number = -number;
  Eigen::VectorXd x = problem.zero();
  const IterationResult result = problem.solve(withTolerance(1e-4), x);
  EXPECT_EQ(result.end, End::kBreakdown);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_TRUE(x.isZero(0));
}

TEST(ConjugateGradients, EndsAtTheMostIterations) {
  Problem<float> problem;
  for (const int most : {1, 2, 7}) {
    IterationLimits limits = withTolerance(1e-6);
    limits.max_iterations = most;
    Eigen::VectorXd x = problem.zero();
    const IterationResult result = problem.solve(limits, x);
    EXPECT_EQ(result.end, End::kIterations);
    EXPECT_EQ(result.iterations, most);
    EXPECT_GT(result.relative_residual, 1e-6);
    EXPECT_TRUE(x.allFinite());
  }
}

TEST(ConjugateGradients, ADeadlineEndsItAfterTheFirstIteration) {
  Problem<float> problem;
  const auto now = std::chrono::steady_clock::now();
  IterationLimits limits = withTolerance(1e-6);
  limits.deadline = now - std::chrono::seconds(1);
  Eigen::VectorXd x = problem.zero();
  IterationResult result = problem.solve(limits, x);
  EXPECT_EQ(result.end, End::kDeadline);
  EXPECT_EQ(result.iterations, 1);
  EXPECT_LT(problem.errorOf(x), 1);  // better than nothing
  limits.deadline = now + std::chrono::hours(1);
  x = problem.zero();
  result = problem.solve(limits, x);
  EXPECT_EQ(result.end, End::kConverged);
}

// In single precision a million terms are off by a thousandth.
TEST(ConjugateGradients, SumsInDoublePrecision) {
  const int num_vertices = 333334, size = 3 * num_vertices + 1;
  const Eigen::VectorXf ones = Eigen::VectorXf::Ones(size), tenths = 0.1F * ones;
  std::vector<int> all(num_vertices), some;
  std::iota(all.begin(), all.end(), 0);
  for (const int i : all) {
    if (i % 7 != 3) some.push_back(i);
  }
  for (const std::vector<int>& active : {all, some}) {
    ActiveRuns runs;
    EXPECT_TRUE(runs.set(active));
    EXPECT_FALSE(runs.set(active));
    const double expected = 3 * static_cast<double>(active.size()) * static_cast<double>(0.1F);
    EXPECT_NEAR(runs.dot(ones, tenths), expected, 1e-9 * expected);
    EXPECT_EQ(runs.dot(ones, tenths), runs.dot(tenths, ones));
  }
}

}  // namespace
}  // namespace polyscalpel
