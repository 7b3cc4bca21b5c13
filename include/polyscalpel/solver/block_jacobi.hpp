// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "polyscalpel/core/difference_matrix.hpp"
#include "polyscalpel/solver/preconditioner.hpp"

namespace polyscalpel {

/// The inverse of each 3 x 3 diagonal block.
class BlockJacobi final : public Preconditioner {
 public:
  /// Takes the blocks of the active vertices; the list must live on.
  template <class Scalar>
  void update(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix,
              const std::vector<int>& active, int num_threads);
  void apply(const float* residual, float* result) override;

 private:
  const std::vector<int>* active_ = nullptr;
  std::vector<float> inverses_;  // 9 an active vertex, column by column, and one more
};

}  // namespace polyscalpel
