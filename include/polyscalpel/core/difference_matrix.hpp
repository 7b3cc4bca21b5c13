// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/core/row_pattern.hpp"

namespace polyscalpel {

/// A point of the body that something outside holds.
struct Hold {
  /// The point is the sum of weight x vertex.
  struct Share {
    int vertex = 0;
    double weight = 0;
  };
  std::vector<Share> shares;                            ///< each vertex once
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();  ///< symmetric positive semidefinite
};

/// A symmetric matrix A on a RowPattern in the form
///
///   y_i = S_i x_i + sum over j of A_ij (x_j - x_i),  S_i = sum over all j of A_ij.
///
/// Elastic stiffness adds nothing to S_i, which is mass and contact alone. So translations feel no stiffness
/// in any precision; with a diagonal block rounded to single precision they would, and an iteration stalls
/// at a part of 4e-4.
template <class Scalar>
struct DifferenceMatrix {
  std::vector<Scalar> blocks;  ///< A_ij, 9 an entry, column by column, and one number more
  std::vector<double> masses;  ///< one a vertex: S_i = masses[i] I, plus what `ties` has for i
  struct Tie {
    int vertex = 0;
    Eigen::Matrix3d stiffness;
  };
  std::vector<Tie> ties;    ///< what holds a vertex to something outside; any order, several a vertex
  std::vector<Hold> holds;  ///< what addHold() has put into blocks and ties

  void resize(const RowPattern& pattern) {
    blocks.resize(9 * static_cast<std::size_t>(pattern.capacity()) + 1);
    masses.resize(pattern.numVertices());
    ties.clear();
    holds.clear();
  }
};

/// matrix += J^T stiffness J, J taking values at the vertices to the point's. Its vertices share a cell.
template <class Scalar>
void addHold(const RowPattern& pattern, const Hold& hold, DifferenceMatrix<Scalar>& matrix);

/// Length of a vector of 3 numbers a vertex as the functions below take it: one number more, which they may
/// read and never write.
inline Eigen::Index paddedSize(int num_vertices) {
  return 3 * static_cast<Eigen::Index>(num_vertices) + 1;
}

/// y = A x at some vertices, whose y alone is set; x must be zero at all others. Independent row by row, so
/// the same bits for any number of threads. active: ascending; x, y: of paddedSize().
template <class Scalar>
void multiply(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix,
              const std::vector<int>& active, const Scalar* x, Scalar* y, int num_threads = 1);

/// Diagonal block A_ii = S_i - sum of A_ij, without ties.
template <class Scalar>
Eigen::Matrix3d diagonalBlock(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix, int vertex);

/// The same matrix on a pattern that has all its blocks.
void convert(const RowPattern& rows, const DifferenceMatrix<double>& matrix, const BlockPattern& pattern,
             Blocks& blocks);

/// The blocks of rows on and below the diagonal.
BlockPattern toBlockPattern(const RowPattern& rows);

extern template void addHold<float>(const RowPattern&, const Hold&, DifferenceMatrix<float>&);
extern template void addHold<double>(const RowPattern&, const Hold&, DifferenceMatrix<double>&);
extern template void multiply<float>(const RowPattern&, const DifferenceMatrix<float>&,
                                     const std::vector<int>&, const float*, float*, int);
extern template void multiply<double>(const RowPattern&, const DifferenceMatrix<double>&,
                                      const std::vector<int>&, const double*, double*, int);
extern template Eigen::Matrix3d diagonalBlock<float>(const RowPattern&, const DifferenceMatrix<float>&, int);
extern template Eigen::Matrix3d diagonalBlock<double>(const RowPattern&, const DifferenceMatrix<double>&,
                                                      int);

}  // namespace polyscalpel
