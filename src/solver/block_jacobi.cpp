// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/block_jacobi.hpp"

#include <Eigen/LU>

#include "polyscalpel/core/parallel.hpp"
#include "polyscalpel/core/quad.hpp"

namespace polyscalpel {

namespace {
constexpr int kVerticesAChunk = 512;
}

template <class Scalar>
void BlockJacobi::update(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix,
                         const std::vector<int>& active, int num_threads) {
  active_ = &active;
  inverses_.resize(9 * active.size() + 1);
  const auto invert = [&](std::size_t k, const Eigen::Matrix3d& block) {
    Eigen::Map<Eigen::Matrix3f> inverse(&inverses_[9 * k]);
    inverse = block.inverse().cast<float>();
  };
  parallelChunks(static_cast<int>(active.size()), kVerticesAChunk, num_threads, [&](int first, int last) {
    for (int k = first; k < last; ++k) invert(k, diagonalBlock(pattern, matrix, active[k]));
  });
  if (matrix.ties.empty()) return;
  // Several ties may hold one vertex: all of a vertex's count at once.
  std::vector<int> place(pattern.numVertices(), -1);
  for (std::size_t k = 0; k < active.size(); ++k) place[active[k]] = static_cast<int>(k);
  std::vector<Eigen::Matrix3d> blocks(matrix.ties.size(), Eigen::Matrix3d::Zero());
  std::vector<int> first(pattern.numVertices(), -1);
  for (std::size_t t = 0; t < matrix.ties.size(); ++t) {
    const int vertex = matrix.ties[t].vertex;
    if (first[vertex] < 0) {
      first[vertex] = static_cast<int>(t);
      blocks[t] = diagonalBlock(pattern, matrix, vertex);
    }
    blocks[first[vertex]] += matrix.ties[t].stiffness;
  }
  for (std::size_t t = 0; t < matrix.ties.size(); ++t) {
    const int vertex = matrix.ties[t].vertex;
    if (first[vertex] == static_cast<int>(t) && place[vertex] >= 0) invert(place[vertex], blocks[t]);
  }
}

template void BlockJacobi::update<float>(const RowPattern&, const DifferenceMatrix<float>&,
                                         const std::vector<int>&, int);
template void BlockJacobi::update<double>(const RowPattern&, const DifferenceMatrix<double>&,
                                          const std::vector<int>&, int);

void BlockJacobi::apply(const float* residual, float* result) {
  const float* inverse = inverses_.data();
  for (const int i : *active_) {
    const Quad<float> r = loadQuad(residual + 3 * static_cast<std::ptrdiff_t>(i));
    storeThree(result + 3 * static_cast<std::ptrdiff_t>(i),
               Quad<float>(loadQuad(inverse) * spread<0>(r) + loadQuad(inverse + 3) * spread<1>(r) +
                           loadQuad(inverse + 6) * spread<2>(r)));
    inverse += 9;
  }
}

}  // namespace polyscalpel
