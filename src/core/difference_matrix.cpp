// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/core/difference_matrix.hpp"

#include <type_traits>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/parallel.hpp"
#include "row_kernels.hpp"

namespace polyscalpel {

namespace {
constexpr int kRowsAChunk = 512;
}

// What it adds to a vertex's row in all is a tie.
template <class Scalar>
void addHold(const RowPattern& pattern, const Hold& hold, DifferenceMatrix<Scalar>& matrix) {
  for (const Hold::Share& i : hold.shares) {
    double sum = 0;
    for (const Hold::Share& j : hold.shares) {
      sum += j.weight;
      if (j.vertex == i.vertex) continue;
      const int entry = pattern.find(i.vertex, j.vertex);
      POLYSCALPEL_ASSERT(entry >= 0);
      Eigen::Map<Eigen::Matrix<Scalar, 3, 3>>(&matrix.blocks[9 * static_cast<std::size_t>(entry)]) +=
          (i.weight * j.weight * hold.stiffness).template cast<Scalar>();
    }
    matrix.ties.push_back({i.vertex, i.weight * sum * hold.stiffness});
  }
  matrix.holds.push_back(hold);
}

template void addHold<float>(const RowPattern&, const Hold&, DifferenceMatrix<float>&);
template void addHold<double>(const RowPattern&, const Hold&, DifferenceMatrix<double>&);

template <class Scalar>
void multiply(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix,
              const std::vector<int>& active, const Scalar* x, Scalar* y, int num_threads) {
  const RowsOfBlocks<Scalar> rows = {pattern.rows.data(), pattern.column.data(), matrix.blocks.data(),
                                     matrix.masses.data()};
  parallelChunks(static_cast<int>(active.size()), kRowsAChunk, num_threads, [&](int first, int last) {
    if constexpr (std::is_same_v<Scalar, float>) {
      rowKernels().multiply_float(rows, &active[first], last - first, x, y);
    } else {
      rowKernels().multiply_double(rows, &active[first], last - first, x, y);
    }
  });
  for (const auto& tie : matrix.ties) {
    Eigen::Map<Eigen::Matrix<Scalar, 3, 1>>(y + 3 * tie.vertex) +=
        tie.stiffness.template cast<Scalar>() *
        Eigen::Map<const Eigen::Matrix<Scalar, 3, 1>>(x + 3 * tie.vertex);
  }
}

template <class Scalar>
Eigen::Matrix3d diagonalBlock(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix, int vertex) {
  const RowPattern::Row& row = pattern.rows[vertex];
  Eigen::Matrix3d diagonal = Eigen::Matrix3d::Identity() * matrix.masses[vertex];
  for (int entry = row.first; entry < row.first + row.count; ++entry) {
    diagonal -=
        Eigen::Map<const Eigen::Matrix<Scalar, 3, 3>>(&matrix.blocks[9 * static_cast<std::size_t>(entry)])
            .template cast<double>();
  }
  return diagonal;
}

BlockPattern toBlockPattern(const RowPattern& rows) {
  BlockPattern pattern;
  for (int i = 0; i < rows.numVertices(); ++i) {
    const RowPattern::Row& row = rows.rows[i];
    pattern.row.push_back(i);
    pattern.row.insert(pattern.row.end(), rows.column.begin() + row.first_above,
                       rows.column.begin() + row.first + row.count);
    pattern.column_start.push_back(pattern.numBlocks());
  }
  return pattern;
}

// Below the diagonal stand the transposed blocks of the row.
void convert(const RowPattern& rows, const DifferenceMatrix<double>& matrix, const BlockPattern& pattern,
             Blocks& blocks) {
  POLYSCALPEL_ASSERT(pattern.numVertices() == rows.numVertices());
  blocks.resize(pattern.numBlocks());
  int block = 0;
  for (int i = 0; i < rows.numVertices(); ++i) {
    const RowPattern::Row& row = rows.rows[i];
    blocks[block++] = diagonalBlock(rows, matrix, i);
    for (int entry = row.first_above; entry < row.first + row.count; ++entry) {
      POLYSCALPEL_ASSERT(pattern.row[block] == rows.column[entry]);
      blocks[block++] =
          Eigen::Map<const Eigen::Matrix3d>(&matrix.blocks[9 * static_cast<std::size_t>(entry)]).transpose();
    }
  }
  for (const auto& tie : matrix.ties) blocks[pattern.column_start[tie.vertex]] += tie.stiffness;
}

template void multiply<float>(const RowPattern&, const DifferenceMatrix<float>&, const std::vector<int>&,
                              const float*, float*, int);
template void multiply<double>(const RowPattern&, const DifferenceMatrix<double>&, const std::vector<int>&,
                               const double*, double*, int);
template Eigen::Matrix3d diagonalBlock<float>(const RowPattern&, const DifferenceMatrix<float>&, int);
template Eigen::Matrix3d diagonalBlock<double>(const RowPattern&, const DifferenceMatrix<double>&, int);

}  // namespace polyscalpel
