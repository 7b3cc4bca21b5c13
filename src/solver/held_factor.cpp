// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/held_factor.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Eigenvalues>

namespace polyscalpel {

namespace {
/// Beyond so many the small matrix costs more than a new factor of the large one.
constexpr std::size_t kMostNodes = 192;
/// That columns are kept of; 36 bytes each for every node of the factor.
constexpr std::size_t kMostColumns = 512;
bool isPositiveSemidefinite(const Eigen::Matrix3d& stiffness) {
  constexpr double kRounding = 1e-9;
  const Eigen::Vector3d values =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(stiffness, Eigen::EigenvaluesOnly).eigenvalues();
  return values.minCoeff() >= -kRounding * values.maxCoeff();
}

}  // namespace

HeldFactor::HeldFactor(SingleFactor factor, int num_nodes)
    : factor_(std::move(factor)), num_nodes_(num_nodes), place_of_node_(num_nodes, -1) {}

const std::vector<float>& HeldFactor::columnsOf(int node) {
  int& place = place_of_node_[node];
  if (place < 0) {
    place = static_cast<int>(columns_.size());
    const std::size_t size = 3 * static_cast<std::size_t>(num_nodes_);
    float* const made = columns_.emplace_back(3 * size, 0.0F).data();
    for (int c = 0; c < 3; ++c) {
      made[c * size + 3 * node + c] = 1;
      factor_.solve(made + c * size);
    }
  }
  return columns_[place];
}

// Where columns of nodes_ do not find room beside what is kept, that goes.
void HeldFactor::makeRoom() {
  const auto num_new =
      std::count_if(nodes_.begin(), nodes_.end(), [&](int node) { return place_of_node_[node] < 0; });
  if (columns_.size() + static_cast<std::size_t>(num_new) <= kMostColumns) return;
  columns_.clear();
  std::fill(place_of_node_.begin(), place_of_node_.end(), -1);
}

SolveStatus HeldFactor::hold(const std::vector<HeldPoint>& points) {
  nodes_.clear();
  for (const HeldPoint& point : points) {
    for (const Part& part : point.parts) nodes_.push_back(part.node);
  }
  std::sort(nodes_.begin(), nodes_.end());
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  if (nodes_.empty()) return SolveStatus::kSolved;
  const auto fail = [&](SolveStatus status) {
    nodes_.clear();
    return status;
  };
  // The correction would be exact all the same, and conjugate gradients not see what a factor does.
  for (const HeldPoint& point : points) {
    if (!isPositiveSemidefinite(point.stiffness)) return fail(SolveStatus::kNotPositiveDefinite);
  }
  if (nodes_.size() > kMostNodes) return fail(SolveStatus::kInaccurate);
  makeRoom();
  const std::size_t size = 3 * static_cast<std::size_t>(num_nodes_);
  const Eigen::Index inner_size = 3 * static_cast<Eigen::Index>(nodes_.size());
  Eigen::MatrixXd flexibility(inner_size, inner_size);
  for (std::size_t q = 0; q < nodes_.size(); ++q) {
    const float* const columns = columnsOf(nodes_[q]).data();
    for (std::size_t p = 0; p < nodes_.size(); ++p) {
      for (int k = 0; k < 9; ++k)
        flexibility(3 * p + k % 3, 3 * q + k / 3) = columns[k / 3 * size + 3 * nodes_[p] + k % 3];
    }
  }
  flexibility = 0.5 * (flexibility + flexibility.transpose()).eval();
  stiffness_.setZero(inner_size, inner_size);
  Eigen::MatrixXd inner = Eigen::MatrixXd::Identity(inner_size, inner_size);
  for (const HeldPoint& point : points) {
    for (const Part& column : point.parts) {
      const auto place = [&](int node) {
        return 3 * (std::lower_bound(nodes_.begin(), nodes_.end(), node) - nodes_.begin());
      };
      const Eigen::Matrix3d right = point.stiffness * column.J.transpose();
      for (const Part& row : point.parts) {
        const Eigen::Matrix3d block = row.J * right;
        stiffness_.block<3, 3>(place(row.node), place(column.node)) += block;
        inner.middleCols<3>(place(column.node)).noalias() +=
            flexibility.middleCols<3>(place(row.node)) * block;
      }
    }
  }
  if (!inner.allFinite()) return fail(SolveStatus::kNotFinite);
  inner_.compute(inner);
  inner_values_.resize(inner_size);
  return SolveStatus::kSolved;
}

void HeldFactor::solve(float* values) {
  factor_.solve(values);
  if (nodes_.empty()) return;
  for (std::size_t p = 0; p < nodes_.size(); ++p) {
    for (int c = 0; c < 3; ++c) inner_values_[3 * p + c] = values[3 * nodes_[p] + c];
  }
  const Eigen::VectorXf loads = (stiffness_ * inner_.solve(inner_values_)).cast<float>();
  // By the columns, or once more through the factor, whichever is less to read.
  const std::size_t size = 3 * static_cast<std::size_t>(num_nodes_);
  if (3 * size * nodes_.size() > 2 * factor_.numValues()) {
    loads_.assign(size, 0.0F);
    for (std::size_t p = 0; p < nodes_.size(); ++p) {
      for (int c = 0; c < 3; ++c) loads_[3 * nodes_[p] + c] = loads[3 * p + c];
    }
    factor_.solve(loads_.data());
    for (std::size_t k = 0; k < size; ++k) values[k] -= loads_[k];
    return;
  }
  for (std::size_t p = 0; p < nodes_.size(); ++p) {
    const float* const x = columnsOf(nodes_[p]).data();
    const Eigen::Vector3f load = loads.segment<3>(3 * p);
    for (std::size_t k = 0; k < size; ++k)
      values[k] -= x[k] * load[0] + x[size + k] * load[1] + x[2 * size + k] * load[2];
  }
}

}  // namespace polyscalpel
