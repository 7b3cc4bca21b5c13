// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/core/difference_matrix.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "support/body_system.hpp"
#include "support/dense_matrices.hpp"
#include "support/random_block_matrix.hpp"
#include "support/small_bodies.hpp"

namespace polyscalpel {
namespace {

template <class Scalar>
using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

/// The rows of a pattern, one after the other in no order, with room left behind between them.
RowPattern scatter(const BlockPattern& blocks, unsigned seed) {
  const int n = blocks.numVertices();
  std::mt19937 engine(seed);
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), engine);
  RowPattern pattern;
  pattern.rows.resize(n);
  for (const int i : order) {
    const int left_behind = static_cast<int>(engine() % 3);
    pattern.column.resize(pattern.column.size() + left_behind, n + 1000);
    RowPattern::Row& row = pattern.rows[i];
    row.first = row.first_above = pattern.capacity();
    for (int j = 0; j < n; ++j) {
      if (j == i || blocks.find(i, j) < 0) continue;
      if (j < i) ++row.first_above;
      pattern.column.push_back(j);
    }
    row.count = pattern.capacity() - row.first;
  }
  pattern.mirror.resize(pattern.capacity(), -1);
  for (int i = 0; i < n; ++i) {
    for (int k = pattern.rows[i].first; k < pattern.rows[i].first + pattern.rows[i].count; ++k)
      pattern.mirror[k] = pattern.find(pattern.column[k], i);
  }
  return pattern;
}

struct Sample {
  RowPattern pattern;
  DifferenceMatrix<double> matrix;
};

/// Random blocks, masses and ties, several to some vertices.
Sample makeSample(int size, unsigned seed) {
  const RandomBlockMatrix random = makeRandomBlockMatrix(size, 0.2, seed);
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Sample sample;
  sample.pattern = scatter(random.pattern, seed);
  sample.matrix.resize(sample.pattern);
  // What rows have left behind, and the number behind the last block, may be anything but a NaN.
  std::fill(sample.matrix.blocks.begin(), sample.matrix.blocks.end(), 1e30);
  for (int i = 0; i < size; ++i) {
    sample.matrix.masses[i] = 1 + uniform(engine);
    const RowPattern::Row& row = sample.pattern.rows[i];
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int k = row.first; k < row.first + row.count; ++k) {
      const Eigen::Matrix3d block = random.dense.block<3, 3>(3 * i, 3 * sample.pattern.column[k]);
      std::copy(block.data(), block.data() + 9, &sample.matrix.blocks[9 * k]);
      sum += block;
    }
    // An elastic row's blocks have a symmetric sum. Those of random ones make up for it by a tie.
    sample.matrix.ties.push_back({i, 0.5 * (sum - sum.transpose())});
  }
  for (const int round : {0, 1}) {
    for (int i = size - 1 - round; i >= 0; i -= 3) {
      Eigen::Matrix3d root;
      for (double& number : root.reshaped()) number = uniform(engine);
      sample.matrix.ties.push_back({i, root * root.transpose()});
      if (round == 1) sample.matrix.ties.push_back({i, root.transpose() * root});
    }
  }
  return sample;
}

template <class Scalar>
DifferenceMatrix<Scalar> cast(const DifferenceMatrix<double>& matrix) {
  DifferenceMatrix<Scalar> result;
  result.blocks.assign(matrix.blocks.begin(), matrix.blocks.end());
  result.masses.assign(matrix.masses.begin(), matrix.masses.end());
  for (const auto& tie : matrix.ties) result.ties.push_back({tie.vertex, tie.stiffness});
  return result;
}

std::vector<int> allOf(int size) {
  std::vector<int> all(size);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

template <class Scalar>
Vector<Scalar> randomVector(int size, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<Scalar> uniform(-1, 1);
  Vector<Scalar> x(paddedSize(size));
  for (Scalar& number : x) number = uniform(engine);
  return x;
}

template <class Scalar>
class DifferenceMatrixOf : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(DifferenceMatrixOf, Scalars);

TYPED_TEST(DifferenceMatrixOf, MultipliesAsTheDenseMatrix) {
  using Scalar = TypeParam;
  for (const int size : {1, 2, 7, 60}) {
    const Sample sample = makeSample(size, 11 + size);
    const auto matrix = cast<Scalar>(sample.matrix);
    const Vector<Scalar> x = randomVector<Scalar>(size, 3);
    Vector<Scalar> y = Vector<Scalar>::Constant(paddedSize(size), 7);
    multiply(sample.pattern, matrix, allOf(size), x.data(), y.data());
    const Eigen::MatrixXd dense = toDense(sample.pattern, matrix);
    const Eigen::VectorXd exact = x.head(3 * size).template cast<double>();
    const Eigen::VectorXd expected = dense * exact;
    // Each sum has a dozen terms of about the size of the largest.
    const double rounding = 20 * std::numeric_limits<Scalar>::epsilon() * dense.norm() * exact.norm();
    EXPECT_LT((y.head(3 * size).template cast<double>() - expected).norm(), rounding) << size;
    EXPECT_EQ(y[3 * size], 7);  // the number behind the last is not written
  }
}

TYPED_TEST(DifferenceMatrixOf, LeavesVerticesThatAreNotActiveAlone) {
  using Scalar = TypeParam;
  const int size = 60;
  const Sample sample = makeSample(size, 5);
  auto matrix = cast<Scalar>(sample.matrix);
  std::vector<int> active, others;
  for (int i = 0; i < size; ++i) (i % 4 == 0 || i > 56 ? others : active).push_back(i);
  Vector<Scalar> x = randomVector<Scalar>(size, 4);
  for (const int i : others) x.template segment<3>(3 * i).setZero();
  Vector<Scalar> y = Vector<Scalar>::Constant(paddedSize(size), 7);
  multiply(sample.pattern, matrix, active, x.data(), y.data());
  const Eigen::MatrixXd dense = toDense(sample.pattern, matrix);
  const Eigen::VectorXd expected = dense * x.head(3 * size).template cast<double>();
  const double rounding = 20 * std::numeric_limits<Scalar>::epsilon() * dense.norm() * x.norm();
  for (const int i : active) {
    const Eigen::Vector3d found = y.template segment<3>(3 * i).template cast<double>();
    EXPECT_LT((found - expected.segment<3>(3 * i)).norm(), rounding);
  }
  for (const int i : others) EXPECT_EQ(y.template segment<3>(3 * i), Vector<Scalar>::Constant(3, 7));
}

// Blocks may be as large as they like against the masses.
TYPED_TEST(DifferenceMatrixOf, ATranslationFeelsMassAlone) {
  using Scalar = TypeParam;
  const int size = 60;
  Sample sample = makeSample(size, 6);
  sample.matrix.ties.clear();
  for (double& number : sample.matrix.blocks) number *= 1e6;
  const auto matrix = cast<Scalar>(sample.matrix);
  Vector<Scalar> x = Vector<Scalar>::Zero(paddedSize(size)), y = x;
  const Eigen::Matrix<Scalar, 3, 1> shift(static_cast<Scalar>(0.3), static_cast<Scalar>(-1.7),
                                          static_cast<Scalar>(1e-3));
  for (int i = 0; i < size; ++i) x.template segment<3>(3 * i) = shift;
  multiply(sample.pattern, matrix, allOf(size), x.data(), y.data());
  for (int i = 0; i < size; ++i) {
    const Eigen::Matrix<Scalar, 3, 1> expected = matrix.masses[i] * shift;
    EXPECT_EQ(y.template segment<3>(3 * i), expected);
  }
}

TYPED_TEST(DifferenceMatrixOf, DiagonalBlocksAreThoseOfTheMatrixWithoutTies) {
  using Scalar = TypeParam;
  const int size = 40;
  auto matrix = cast<Scalar>(makeSample(size, 7).matrix);
  const RowPattern pattern = makeSample(size, 7).pattern;
  const auto with_ties = matrix;
  matrix.ties.clear();
  const Eigen::MatrixXd dense = toDense(pattern, matrix);
  for (int i = 0; i < size; ++i) {
    const Eigen::Matrix3d block = diagonalBlock(pattern, with_ties, i);
    EXPECT_LT((block - dense.block<3, 3>(3 * i, 3 * i)).norm(), 1e-14 * dense.norm());
  }
}

TEST(DifferenceMatrix, ConvertsToTheSameMatrixInBlocks) {
  const int size = 60;
  const Sample sample = makeSample(size, 8);
  const BlockPattern pattern = toBlockPattern(sample.pattern);
  const BlockPattern expected = makeRandomBlockMatrix(size, 0.2, 8).pattern;
  EXPECT_EQ(pattern.column_start, expected.column_start);
  EXPECT_EQ(pattern.row, expected.row);
  Blocks blocks;
  convert(sample.pattern, sample.matrix, pattern, blocks);
  const Eigen::MatrixXd dense = toDense(sample.pattern, sample.matrix);
  EXPECT_LT((toDense(pattern, blocks) - dense).norm(), 1e-14 * dense.norm());
}

TEST(DifferenceMatrix, FindsTheEntriesThatAreThereAndNoOthers) {
  const int size = 40;
  const BlockPattern blocks = makeRandomBlockMatrix(size, 0.2, 9).pattern;
  const RowPattern pattern = scatter(blocks, 9);
  for (int i = 0; i < size; ++i) {
    EXPECT_EQ(pattern.find(i, i), -1);
    for (int j = 0; j < size; ++j) {
      if (i == j) continue;
      const int entry = pattern.find(i, j);
      EXPECT_EQ(entry >= 0, blocks.find(i, j) >= 0);
      if (entry < 0) continue;
      EXPECT_EQ(pattern.column[entry], j);
      EXPECT_EQ(pattern.mirror[entry], pattern.find(j, i));
    }
  }
}

TYPED_TEST(DifferenceMatrixOf, AnyNumberOfThreadsGivesTheSameBits) {
  using Scalar = TypeParam;
  const PolyhedralMesh mesh = makeTetBeam(8);
  ASSERT_GT(mesh.numVertices(), 2000);  // several chunks of rows
  BodySystem system(mesh);
  system.linearise(shake(mesh, 0.002, 1));
  DifferenceMatrix<Scalar> matrix;
  system.assemble(matrix);
  matrix.ties.push_back({2000, Eigen::Matrix3d::Identity()});
  Vector<Scalar> x = randomVector<Scalar>(mesh.numVertices(), 5);
  for (int i = 0; i < mesh.numVertices(); ++i) {
    if (!std::binary_search(system.active().begin(), system.active().end(), i))
      x.template segment<3>(3 * i).setZero();
  }
  Vector<Scalar> expected = Vector<Scalar>::Zero(x.size());
  multiply(system.pattern(), matrix, system.active(), x.data(), expected.data(), 1);
  EXPECT_GT(expected.norm(), 0);
  for (const int threads : {2, 3, 7}) {
    Vector<Scalar> y = Vector<Scalar>::Zero(x.size());
    multiply(system.pattern(), matrix, system.active(), x.data(), y.data(), threads);
    EXPECT_EQ(y, expected) << threads;
  }
}

}  // namespace
}  // namespace polyscalpel
