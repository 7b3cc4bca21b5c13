// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/aggregates.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "polyscalpel/solver/conjugate_gradients.hpp"
#include "support/body_system.hpp"
#include "support/small_bodies.hpp"

namespace polyscalpel {
namespace {

std::vector<std::vector<int>> membersOf(const std::vector<int>& group, int num_groups) {
  std::vector<std::vector<int>> members(num_groups);
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (group[i] >= 0) members.at(group[i]).push_back(static_cast<int>(i));
  }
  return members;
}

/// How many vertices of the same number the pattern joins to one.
int countJoined(const RowPattern& pattern, const std::vector<int>& number, int start) {
  std::vector<bool> is_met(number.size(), false);
  std::vector<int> queue = {start};
  is_met[start] = true;
  for (std::size_t k = 0; k < queue.size(); ++k) {
    const RowPattern::Row& row = pattern.rows[queue[k]];
    for (int entry = row.first; entry < row.first + row.count; ++entry) {
      const int other = pattern.column[entry];
      if (is_met[other] || number[other] != number[start]) continue;
      is_met[other] = true;
      queue.push_back(other);
    }
  }
  return static_cast<int>(queue.size());
}

TEST(Aggregates, EveryActiveVertexIsInOneGroupThatHangsTogether) {
  for (const PolyhedralMesh& mesh : {makeTetBeam(4), makeTetBall({0, 0, 0}, 0.05, 5), makePolyhedra()}) {
    const BodySystem system(mesh);
    for (const int size : {1, 8, 30, 100000}) {
      int num_groups = -1;
      const std::vector<int> group = makeAggregates(system.pattern(), system.active(), size, num_groups);
      ASSERT_EQ(static_cast<int>(group.size()), mesh.numVertices());
      const std::vector<bool> fixed = system.fixed();
      for (int i = 0; i < mesh.numVertices(); ++i) {
        if (fixed[i]) {
          EXPECT_EQ(group[i], -1);
        } else {
          EXPECT_TRUE(group[i] >= 0 && group[i] < num_groups);
        }
      }
      for (const std::vector<int>& members : membersOf(group, num_groups)) {
        ASSERT_FALSE(members.empty());
        EXPECT_EQ(countJoined(system.pattern(), group, members.front()), static_cast<int>(members.size()));
      }
    }
  }
}

TEST(Aggregates, GroupsAreNeitherTinyNorHuge) {
  for (const PolyhedralMesh& mesh : {makeTetBeam(4), makeTetBeam(8), makeTetBall({0, 0, 0}, 0.05, 5)}) {
    const BodySystem system(mesh);
    for (const int size : {8, 30}) {
      int num_groups = 0;
      const std::vector<int> group = makeAggregates(system.pattern(), system.active(), size, num_groups);
      for (const std::vector<int>& members : membersOf(group, num_groups)) {
        EXPECT_GE(3 * static_cast<int>(members.size()), size);  // these bodies have no small piece
        EXPECT_LE(static_cast<int>(members.size()), 3 * size);  // with what is left over around it
      }
      EXPECT_LT(num_groups, 2 * static_cast<int>(system.active().size()) / size);
    }
  }
}

TEST(Aggregates, PiecesShareNoGroup) {
  const PolyhedralMesh mesh = makePolyhedra();
  const BodySystem system(mesh);
  int num_groups = 0;
  const std::vector<int> group = makeAggregates(system.pattern(), system.active(), 100000, num_groups);
  EXPECT_EQ(num_groups, 2);
  // A piece that is smaller than any group is wanted keeps to itself.
  for (const std::vector<int>& members : membersOf(group, num_groups)) EXPECT_LT(members.size(), 100U);
}

TEST(Aggregates, NothingActiveMakesNoGroup) {
  BodySystem system(makeTetBeam(1));
  int num_groups = -1;
  const std::vector<int> group = makeAggregates(system.pattern(), {}, 30, num_groups);
  EXPECT_EQ(num_groups, 0);
  EXPECT_TRUE(std::all_of(group.begin(), group.end(), [](int of) { return of == -1; }));
}

/// A body that has bent and been shaken, with its preconditioners as they are made for a step.
struct Bent {
  BodySystem system;
  DifferenceMatrix<float> matrix;
  std::vector<float> rotations;
  AggregatePreconditioner aggregates;
  BlockJacobi jacobi;

  explicit Bent(const PolyhedralMesh& mesh) : system(mesh) {
    system.linearise(shake(bend(mesh.restPositions(), 0.4, 1.2), 1e-4, 1));
    system.assemble(matrix);
    system.vertexRotations(rotations);
    DifferenceMatrix<double> at_rest;
    system.assembleAtRest(at_rest);
    EXPECT_EQ(aggregates.make(system.pattern(), at_rest, system.restPositions(), system.active()),
              SolveStatus::kSolved);
    aggregates.update(system.pattern(), matrix, system.active(), rotations, 1);
    jacobi.update(system.pattern(), matrix, system.active(), 1);
  }

  int iterations(Preconditioner& preconditioner) {
    IterationLimits limits;
    limits.tolerance = 1e-5;
    limits.max_iterations = 10000;
    ConjugateGradients<float> iteration;
    Eigen::VectorXd x = Eigen::VectorXd::Zero(paddedSize(system.pattern().numVertices()));
    const Eigen::VectorXf b = toPadded<float>(system, someLoad(system, 2)).normalized();
    const IterationResult result =
        iteration.solve(system.pattern(), matrix, system.active(), {}, b, preconditioner, limits, 1, x);
    EXPECT_EQ(result.end, IterationResult::End::kConverged);
    return result.iterations;
  }
};

TEST(AggregatePreconditioner, IsSymmetricAndPositive) {
  Bent body(makeTetBeam(4));
  EXPECT_GT(body.aggregates.numGroups(), 5);
  const auto apply = [&](Preconditioner& preconditioner, const Eigen::VectorXf& x) {
    Eigen::VectorXf y = Eigen::VectorXf::Zero(x.size());
    preconditioner.apply(x.data(), y.data());
    return y;
  };
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Eigen::VectorXf x = toPadded<float>(body.system, someLoad(body.system, 10 + seed));
    const Eigen::VectorXf y = toPadded<float>(
        body.system, shake(Eigen::Matrix3Xd::Zero(3, body.system.pattern().numVertices()), 1, seed));
    for (Preconditioner* const preconditioner :
         {static_cast<Preconditioner*>(&body.aggregates), static_cast<Preconditioner*>(&body.jacobi)}) {
      const Eigen::VectorXf Bx = apply(*preconditioner, x), By = apply(*preconditioner, y);
      const auto dot = [](const Eigen::VectorXf& a, const Eigen::VectorXf& b) {
        return a.cast<double>().dot(b.cast<double>());
      };
      EXPECT_GT(dot(x, Bx), 0);
      EXPECT_GT(dot(y, By), 0);
      EXPECT_NEAR(dot(x, By), dot(y, Bx), 1e-5 * std::sqrt(dot(x, Bx) * dot(y, By)));
      for (int i = 0; i < body.system.pattern().numVertices(); ++i) {
        if (body.system.fixed()[i]) {
          EXPECT_TRUE(Bx.segment<3>(3 * i).isZero(0));
        }
      }
    }
  }
}

// Halved cells double what diagonal blocks alone need, and leave rigid groups almost where they were.
TEST(AggregatePreconditioner, IterationsHardlyGrowWithTheBody) {
  Bent coarse(makeTetBeam(4)), fine(makeTetBeam(8));
  const double growth =
      static_cast<double>(fine.iterations(fine.aggregates)) / coarse.iterations(coarse.aggregates);
  const double growth_of_jacobi =
      static_cast<double>(fine.iterations(fine.jacobi)) / coarse.iterations(coarse.jacobi);
  EXPECT_LT(growth, 1.5);
  EXPECT_GT(growth_of_jacobi, 1.5 * growth);
  EXPECT_LT(2 * fine.iterations(fine.aggregates), fine.iterations(fine.jacobi));
}

// The groups' motions turn with the body: a rigid turn of all changes nothing.
TEST(AggregatePreconditioner, TurnsWithTheBody) {
  const PolyhedralMesh mesh = makeTetBeam(4);
  BodySystem system(mesh);
  DifferenceMatrix<double> at_rest;
  system.assembleAtRest(at_rest);
  AggregatePreconditioner aggregates;
  ASSERT_EQ(aggregates.make(system.pattern(), at_rest, system.restPositions(), system.active()),
            SolveStatus::kSolved);
  const auto apply = [&](const Eigen::Matrix3d& turn) {
    system.linearise(turn * mesh.restPositions());
    DifferenceMatrix<float> matrix;
    std::vector<float> rotations;
    system.assemble(matrix);
    system.vertexRotations(rotations);
    aggregates.update(system.pattern(), matrix, system.active(), rotations, 1);
    const Eigen::VectorXf b = toPadded<float>(system, turn * someLoad(system, 3));
    Eigen::VectorXf x = Eigen::VectorXf::Zero(b.size());
    aggregates.apply(b.data(), x.data());
    const Eigen::Matrix3Xf moved = x.head(b.size() - 1).reshaped(3, mesh.numVertices());
    return Eigen::Matrix3Xd(turn.transpose() * moved.cast<double>());
  };
  const Eigen::Matrix3Xd expected = apply(Eigen::Matrix3d::Identity());
  EXPECT_LT((apply(someRotation()) - expected).norm(), 1e-5 * expected.norm());
}

}  // namespace
}  // namespace polyscalpel
