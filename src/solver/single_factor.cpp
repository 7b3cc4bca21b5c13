// SPDX-License-Identifier: BSD-3-Clause
//
// Y. Chen, T. Davis, W. Hager, S. Rajamanickam, "Algorithm 887: CHOLMOD, Supernodal Sparse Cholesky
// Factorization and Update/Downdate", ACM Transactions on Mathematical Software 35(3), 2008.
#include "polyscalpel/solver/single_factor.hpp"

#include <algorithm>

#include <Eigen/Dense>

#include "panel_kernels.hpp"

namespace polyscalpel {

namespace {

int roundUp(int value, int to) {
  return (value + to - 1) / to * to;
}

}  // namespace

SolveStatus SingleFactor::factorise(const BlockPattern& pattern, const Blocks& blocks,
                                    const std::vector<bool>& fixed, std::size_t most_values) {
  *this = {};
  DirectSolver solver;
  SolveStatus status = solver.analyse(pattern, fixed);
  if (status == SolveStatus::kSolved && solver.factorSize() > most_values) status = SolveStatus::kOutOfMemory;
  if (status == SolveStatus::kSolved) status = solver.factorise(pattern, blocks);
  if (status != SolveStatus::kSolved) return status;
  const FactorPanels panels = solver.panels();
  places_ = panels.places;
  int most_columns = 0, most_rows = 0;
  std::size_t size = 0;
  for (const FactorPanels::Supernode& given : panels.supernodes) {
    Supernode node;
    node.first_column = given.first_column;
    node.num_columns = given.num_columns;
    node.first_row = static_cast<int>(rows_.size());
    node.num_rows = static_cast<int>(given.rows.size()) - given.num_columns;
    node.leading = roundUp(static_cast<int>(given.rows.size()), kPanelLanes);
    node.padded_columns = roundUp(given.num_columns, kPanelColumns);
    node.first_value = size;
    size += static_cast<std::size_t>(node.leading) * node.padded_columns;
    rows_.insert(rows_.end(), given.rows.begin() + given.num_columns, given.rows.end());
    most_columns = std::max(most_columns, node.padded_columns);
    most_rows = std::max(most_rows, node.leading);
    supernodes_.push_back(node);
  }
  values_.assign(size, 0.0F);
  for (std::size_t s = 0; s < supernodes_.size(); ++s) {
    const Supernode& node = supernodes_[s];
    const Eigen::Map<const Eigen::MatrixXd> panel(panels.values.data() + panels.supernodes[s].first_value,
                                                  node.num_columns + node.num_rows, node.num_columns);
    const auto diagonal = panel.topRows(node.num_columns).triangularView<Eigen::Lower>();
    Eigen::Map<Eigen::MatrixXf> target(values_.data() + node.first_value, node.leading, node.padded_columns);
    const Eigen::MatrixXd inverse =
        diagonal.solve(Eigen::MatrixXd::Identity(node.num_columns, node.num_columns));
    target.topLeftCorner(node.num_columns, node.num_columns) = inverse.cast<float>();
    if (node.num_rows == 0) continue;
    target.block(node.num_columns, 0, node.num_rows, node.num_columns) =
        (panel.bottomRows(node.num_rows) * inverse.triangularView<Eigen::Lower>()).cast<float>();
  }
  permuted_.assign(places_.size() + most_columns, 0.0F);
  column_room_.assign(most_columns, 0.0F);
  row_room_.assign(most_rows, 0.0F);
  return values_.empty() || Eigen::Map<const Eigen::VectorXf>(values_.data(), values_.size()).allFinite()
             ? SolveStatus::kSolved
             : SolveStatus::kNotFinite;
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
