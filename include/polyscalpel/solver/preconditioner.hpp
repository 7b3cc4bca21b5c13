// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace polyscalpel {

/// A symmetric positive definite matrix near A^-1, in single precision.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  /// result = B residual; 3 numbers a vertex, and one more. Both are zero at vertices that are not active.
  virtual void apply(const float* residual, float* result) = 0;
};

}  // namespace polyscalpel
