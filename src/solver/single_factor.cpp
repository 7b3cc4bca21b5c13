// SPDX-License-Identifier: BSD-3-Clause
//
// Y. Chen, T. Davis, W. Hager, S. Rajamanickam, "Algorithm 887: CHOLMOD, Supernodal Sparse Cholesky
// Factorization and Update/Downdate", ACM Transactions on Mathematical Software 35(3), 2008.
#include "polyscalpel/solver/single_factor.hpp"

#include <algorithm>
#include <utility>

#include <cblas.h>
#include <Eigen/Core>

#include "panel_kernels.hpp"

namespace polyscalpel {

namespace {

int roundUp(int value, int to) {
  return (value + to - 1) / to * to;
}

}  // namespace

SolveStatus SingleFactor::factorise(const BlockPattern& pattern, const Blocks& blocks,
                                    const std::vector<bool>& fixed, std::size_t most_values,
                                    const std::vector<int>& order) {
  *this = {};
  DirectSolver solver;
  SolveStatus status = order.empty() ? solver.analyse(pattern, fixed) : solver.analyse(pattern, fixed, order);
  if (status == SolveStatus::kSolved && solver.factorSize() > most_values) status = SolveStatus::kOutOfMemory;
  if (status == SolveStatus::kSolved) status = solver.factorise(pattern, blocks);
  if (status != SolveStatus::kSolved) return status;
  FactorPanels panels = solver.panels();
  places_ = std::move(panels.places);
  int most_columns = 0, most_rows = 0;
  std::size_t size = 0;
  for (const FactorPanels::Supernode& given : panels.supernodes) {
    Supernode node;
    node.first_column = given.first_column;
    node.num_columns = given.num_columns;
    node.first_row = static_cast<int>(rows_.size());
    node.num_rows = given.num_rows - given.num_columns;
    node.leading = roundUp(given.num_rows, kPanelLanes);
    node.padded_columns = roundUp(given.num_columns, kPanelColumns);
    node.first_value = size;
    size += static_cast<std::size_t>(node.leading) * node.padded_columns;
    rows_.insert(rows_.end(), given.rows + given.num_columns, given.rows + given.num_rows);
    most_columns = std::max(most_columns, node.padded_columns);
    most_rows = std::max(most_rows, node.leading);
    supernodes_.push_back(node);
  }
  values_.assign(size, 0.0F);
  for (std::size_t s = 0; s < supernodes_.size(); ++s) takePanel(panels.supernodes[s], supernodes_[s]);
  permuted_.assign(places_.size() + most_columns, 0.0F);
  column_room_.assign(most_columns, 0.0F);
  row_room_.assign(most_rows, 0.0F);
  return values_.empty() || Eigen::Map<const Eigen::VectorXf>(values_.data(), values_.size()).allFinite()
             ? SolveStatus::kSolved
             : SolveStatus::kNotFinite;
}

// L21 L11^-1 in place of L21, then L11^-1.
void SingleFactor::takePanel(const FactorPanels::Supernode& given, const Supernode& node) {
  const int columns = given.num_columns;
  double* const below = given.values + columns;
  Eigen::Map<Eigen::MatrixXd> panel(given.values, given.num_rows, columns);
  Eigen::Map<Eigen::MatrixXf> target(&values_[node.first_value], node.leading, node.padded_columns);
  if (node.num_rows > 0) {
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, node.num_rows, columns, 1,
                given.values, given.num_rows, below, given.num_rows);
    target.block(columns, 0, node.num_rows, columns) = panel.bottomRows(node.num_rows).cast<float>();
  }
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(columns, columns);
  cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, columns, columns, 1,
              given.values, given.num_rows, inverse.data(), columns);
  target.topLeftCorner(columns, columns) = inverse.cast<float>();
}

std::vector<int> SingleFactor::order() const {
  std::vector<int> order;
  order.reserve(places_.size() / 3);
  for (const int place : places_) {
    if (place % 3 == 0) order.push_back(place / 3);
  }
  return order;
}

void SingleFactor::solve(float* values) {
  const PanelKernels& kernels = panelKernels();
  float* const x = permuted_.data();
  float* const column = column_room_.data();
  float* const row = row_room_.data();
  for (std::size_t k = 0; k < places_.size(); ++k) x[k] = values[places_[k]];
  // A panel's columns beyond its last are zero, so what of the next supernode they read plays no part.
  for (const Supernode& node : supernodes_) {
    float* const own = x + node.first_column;
    kernels.multiply(&values_[node.first_value], node.leading, node.padded_columns, own, row);
    std::copy(row, row + node.num_columns, own);
    const int* const below = rows_.data() + node.first_row;
    for (int i = 0; i < node.num_rows; ++i) x[below[i]] -= row[node.num_columns + i];
  }
  for (auto node = supernodes_.rbegin(); node != supernodes_.rend(); ++node) {
    float* const own = x + node->first_column;
    std::copy(own, own + node->num_columns, row);
    const int* const below = rows_.data() + node->first_row;
    for (int i = 0; i < node->num_rows; ++i) row[node->num_columns + i] = -x[below[i]];
    std::fill(row + node->num_columns + node->num_rows, row + node->leading, 0.0F);
    kernels.multiplyTransposed(&values_[node->first_value], node->leading, node->padded_columns, row, column);
    std::copy(column, column + node->num_columns, own);
  }
  for (std::size_t k = 0; k < places_.size(); ++k) values[places_[k]] = x[k];
}

}  // namespace polyscalpel
