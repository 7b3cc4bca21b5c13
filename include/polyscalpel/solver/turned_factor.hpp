// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "polyscalpel/solver/preconditioner.hpp"
#include "polyscalpel/solver/single_factor.hpp"

namespace polyscalpel {

/// R A_0^-1 R^T, A_0 the matrix in the rest shape and R the rotation of each vertex: a corotated matrix is
/// near R A_0 R^T, however far the body has bent, so a handful of iterations is left (60 without R on a beam
/// that has swung down).
class TurnedFactor final : public Preconditioner {
 public:
  explicit TurnedFactor(SingleFactor factor) : factor_(std::move(factor)) {}
  /// rotations: 9 a vertex, column by column; active: ascending. Both must live on.
  void update(const std::vector<float>& rotations, const std::vector<int>& active) {
    rotations_ = rotations.data();
    active_ = &active;
  }
  void apply(const float* residual, float* result) override;

 private:
  SingleFactor factor_;
  const float* rotations_ = nullptr;
  const std::vector<int>* active_ = nullptr;
};

}  // namespace polyscalpel
