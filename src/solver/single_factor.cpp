// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/single_factor.hpp"

#include <algorithm>
#include <new>
#include <utility>

#include <Eigen/Core>

#include "blas.hpp"
#include "multifrontal.hpp"
#include "panel_kernels.hpp"
#include "polyscalpel/solver/symbolic_factor.hpp"

namespace polyscalpel {

namespace {

int roundUp(int value, int to) {
  return (value + to - 1) / to * to;
}

template <class Scalar>
bool isFinite(const std::vector<Scalar>& values) {
  Scalar zero = 0;  // turns into NaN at the first value that is not finite
  for (const Scalar value : values) zero += value * 0;
  return zero == 0;
}

/// Where less than this part of a diagonal entry is left, single precision may have left its rounding alone.
constexpr float kSmallestSinglePivot = 1e-6F;

}  // namespace

// L21 L11^-1 in place of L21, then L11^-1 in place of L11.
template <class Scalar>
void SingleFactor::invertDiagonal(const Supernode& node, Scalar* panel, std::vector<Scalar>& room) {
  const int columns = node.num_columns, leading = node.leading;
  if (node.num_rows > 0) solveRight(node.num_rows, columns, panel, leading, panel + columns, leading);
  room.assign(static_cast<std::size_t>(columns) * columns, Scalar(0));
  for (int k = 0; k < columns; ++k) room[k * (columns + std::size_t(1))] = 1;
  solveLeft(columns, columns, panel, leading, room.data(), columns);
  for (int k = 0; k < columns; ++k) {
    Scalar* const to = panel + static_cast<std::ptrdiff_t>(k) * leading;
    std::fill_n(to, k, Scalar(0));
    std::copy_n(room.data() + static_cast<std::ptrdiff_t>(k) * columns + k, columns - k, to + k);
  }
}

template <class Scalar>
SolveStatus SingleFactor::fill(const SymbolicFactor& symbolic, const BlockPattern& pattern,
                               const Blocks& blocks, Scalar smallest_pivot, std::vector<Scalar>& values) try {
  std::vector<PanelPlace> panels;
  std::size_t size = 0;
  for (const Supernode& node : supernodes_) {
    panels.push_back({node.first_value, node.leading});
    size = node.first_value + static_cast<std::size_t>(node.leading) * node.padded_columns;
  }
  values.assign(size, Scalar(0));
  const SolveStatus status = factorMultifrontal(symbolic, pattern, blocks, panels, smallest_pivot, values);
  if (status != SolveStatus::kSolved) return status;
  std::vector<Scalar> room;
  for (const Supernode& node : supernodes_) invertDiagonal(node, &values[node.first_value], room);
  return isFinite(values) ? SolveStatus::kSolved : SolveStatus::kNotFinite;
} catch (const std::bad_alloc&) {
  return SolveStatus::kOutOfMemory;
}

SolveStatus SingleFactor::factorise(const BlockPattern& pattern, const Blocks& blocks,
                                    const std::vector<bool>& fixed, Ordering ordering) {
  SymbolicFactor symbolic;
  const SolveStatus status = analyse(pattern, fixed, ordering, symbolic);
  return status == SolveStatus::kSolved ? factorise(std::move(symbolic), pattern, blocks) : status;
}

SolveStatus SingleFactor::factorise(SymbolicFactor symbolic, const BlockPattern& pattern,
                                    const Blocks& blocks) {
  order_.clear();
  supernodes_.clear();
  int most_columns = 0, most_rows = 0;
  std::size_t size = 0;
  for (const SymbolicFactor::Supernode& given : symbolic.supernodes) {
    Supernode node;
    node.first_column = 3 * given.first_column;
    node.num_columns = 3 * given.num_columns;
    node.first_row = given.first_row;
    node.num_rows = 3 * given.num_rows;
    node.leading = roundUp(node.num_columns + node.num_rows, kPanelLanes);
    node.padded_columns = roundUp(node.num_columns, kPanelColumns);
    node.first_value = size;
    size += static_cast<std::size_t>(node.leading) * node.padded_columns;
    most_columns = std::max(most_columns, node.padded_columns);
    most_rows = std::max(most_rows, node.leading);
    supernodes_.push_back(node);
  }
  SolveStatus status = fill(symbolic, pattern, blocks, kSmallestSinglePivot, values_);
  if (status == SolveStatus::kNotPositiveDefinite || status == SolveStatus::kNotFinite) {
    std::vector<double> values;
    status = fill(symbolic, pattern, blocks, 0.0, values);
    std::copy(values.begin(), values.end(), values_.begin());
    if (status == SolveStatus::kSolved && !isFinite(values_)) status = SolveStatus::kNotFinite;
  }
  if (status != SolveStatus::kSolved) {
    *this = {};
    return status;
  }
  order_ = std::move(symbolic.order);
  rows_ = std::move(symbolic.rows);
  permuted_.assign(3 * order_.size() + most_columns, 0.0F);
  column_room_.assign(most_columns, 0.0F);
  row_room_.assign(most_rows, 0.0F);
  return SolveStatus::kSolved;
}

void SingleFactor::solve(float* values) {
  const PanelKernels& kernels = panelKernels();
  float* const x = permuted_.data();
  float* const column = column_room_.data();
  float* const row = row_room_.data();
  for (std::size_t k = 0; k < order_.size(); ++k) {
    for (int c = 0; c < 3; ++c) x[3 * k + c] = values[3 * order_[k] + c];
  }
  // A panel's columns beyond its last are zero, so what of the next supernode they read plays no part.
  for (const Supernode& node : supernodes_) {
    float* const own = x + node.first_column;
    kernels.multiply(&values_[node.first_value], node.leading, node.padded_columns, own, row);
    std::copy(row, row + node.num_columns, own);
    const int* const below = rows_.data() + node.first_row;
    const float* left = row + node.num_columns;
    for (int i = 0; 3 * i < node.num_rows; ++i, left += 3) {
      for (int c = 0; c < 3; ++c) x[3 * below[i] + c] -= left[c];
    }
  }
  for (auto node = supernodes_.rbegin(); node != supernodes_.rend(); ++node) {
    float* const own = x + node->first_column;
    std::copy(own, own + node->num_columns, row);
    const int* const below = rows_.data() + node->first_row;
    float* to = row + node->num_columns;
    for (int i = 0; 3 * i < node->num_rows; ++i, to += 3) {
      for (int c = 0; c < 3; ++c) to[c] = -x[3 * below[i] + c];
    }
    std::fill(row + node->num_columns + node->num_rows, row + node->leading, 0.0F);
    kernels.multiplyTransposed(&values_[node->first_value], node->leading, node->padded_columns, row, column);
    std::copy(column, column + node->num_columns, own);
  }
  for (std::size_t k = 0; k < order_.size(); ++k) {
    for (int c = 0; c < 3; ++c) values[3 * order_[k] + c] = x[3 * k + c];
  }
}

}  // namespace polyscalpel
