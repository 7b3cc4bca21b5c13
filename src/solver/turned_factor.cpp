// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/turned_factor.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "polyscalpel/core/checks.hpp"
#include "vertex_turns.hpp"

namespace polyscalpel {

TurnedFactor::TurnedFactor(SingleFactor factor, const std::vector<bool>& fixed, std::vector<float> rotations)
    : factor_(std::move(factor), static_cast<int>(fixed.size())),
      num_vertices_(static_cast<int>(fixed.size())),
      is_fixed_(fixed),
      first_share_(1, 0),
      base_(std::move(rotations)) {
  POLYSCALPEL_ASSERT(base_.empty() || base_.size() == 9 * fixed.size());
  // Fixed vertices have no rotation of their own, but may be parents of some that move.
  for (std::size_t i = 0; i < fixed.size() && !base_.empty(); ++i) {
    if (fixed[i]) Eigen::Map<Eigen::Matrix3f>(&base_[9 * i]).setIdentity();
  }
  coarse_.assign(3 * fixed.size(), 0.0F);
}

// P: visit(vertex of the factor, weight).
template <class Visit>
void TurnedFactor::forEachShare(int vertex, const Visit& visit) const {
  if (vertex < num_vertices_) return visit(vertex, 1.0F);
  const int k = vertex - num_vertices_;
  for (int s = first_share_[k]; s < first_share_[k + 1]; ++s) visit(shares_[s].vertex, shares_[s].weight);
}

void TurnedFactor::follow(const std::vector<AddedVertex>& added, const std::vector<int>& touched) {
  for (const AddedVertex& vertex : added) {
    POLYSCALPEL_ASSERT(vertex.vertex == num_vertices_ + static_cast<int>(first_share_.size()) - 1);
    std::vector<Share> shares;
    const auto add = [&](int of, double weight) {
      const auto known =
          std::find_if(shares.begin(), shares.end(), [&](const Share& share) { return share.vertex == of; });
      if (known != shares.end()) {
        known->weight += static_cast<float>(weight);
      } else {
        shares.push_back({of, static_cast<float>(weight)});
      }
    };
    for (int side = 0; side < 2; ++side) {
      const double weight = side == 0 ? 1 - vertex.weight : vertex.weight;
      const int parent = vertex.parents[side];
      if (weight == 0) continue;
      forEachShare(parent, [&](int of, float share) { add(of, weight * share); });
    }
    shares_.insert(shares_.end(), shares.begin(), shares.end());
    first_share_.push_back(static_cast<int>(shares_.size()));
    if (base_.empty()) continue;
    base_.resize(base_.size() + 9);
    std::copy_n(&base_[9 * vertex.nearerParent()], 9, &base_[base_.size() - 9]);
  }
  patch_.insert(patch_.end(), touched.begin(), touched.end());
  std::sort(patch_.begin(), patch_.end());
  patch_.erase(std::unique(patch_.begin(), patch_.end()), patch_.end());
  is_patch_factored_ = false;
}

SolveStatus TurnedFactor::update(const RowPattern& pattern, const DifferenceMatrix<float>& matrix,
                                 const std::vector<float>& rotations, const std::vector<int>& active) {
  pattern_ = &pattern;
  matrix_ = &matrix;
  rotations_ = rotations.data();
  active_ = &active;
  turnCoarse();
  const SolveStatus status = holdCoarse();
  if (status != SolveStatus::kSolved) return status;
  // Held softer than it is, the patch would be corrected twice too far.
  const bool is_held = isPatchHeld();
  if (is_held || was_patch_held_) is_patch_factored_ = false;
  was_patch_held_ = is_held;
  is_patch_old_ = is_patch_factored_;
  return is_patch_factored_ ? SolveStatus::kSolved : factorPatch();
}

void TurnedFactor::turnCoarse() {
  coarse_turns_ = rotations_;
  if (base_.empty()) return;
  turns_.resize(base_.size());
  for (const int i : *active_) {
    Eigen::Map<Eigen::Matrix3f>(&turns_[9 * i]).noalias() =
        Eigen::Map<const Eigen::Matrix3f>(rotations_ + 9 * i) *
        Eigen::Map<const Eigen::Matrix3f>(&base_[9 * i]).transpose();
  }
  coarse_turns_ = turns_.data();
}

bool TurnedFactor::isPatchHeld() const {
  return std::any_of(matrix_->ties.begin(), matrix_->ties.end(), [&](const auto& tie) {
    return std::binary_search(patch_.begin(), patch_.end(), tie.vertex);
  });
}

// Of a point at sum of w x, J = P^T R^T w.
SolveStatus TurnedFactor::holdCoarse() {
  std::vector<HeldFactor::HeldPoint> points;
  for (const Hold& hold : matrix_->holds) {
    HeldFactor::HeldPoint& point = points.emplace_back();
    point.stiffness = hold.stiffness;
    for (const Hold::Share& share : hold.shares) {
      const Eigen::Map<const Eigen::Matrix3f> R(coarse_turns_ + 9 * share.vertex);
      const Eigen::Matrix3d turned = share.weight * R.cast<double>().transpose();
      forEachShare(share.vertex, [&](int of, float weight) {
        if (!is_fixed_[of]) point.parts.push_back({of, weight * turned});
      });
    }
  }
  return factor_.hold(points);
}

SolveStatus TurnedFactor::factorPatch() {
  patch_active_.clear();
  std::set_intersection(patch_.begin(), patch_.end(), active_->begin(), active_->end(),
                        std::back_inserter(patch_active_));
  std::vector<int> place(pattern_->numVertices(), -1);
  for (std::size_t k = 0; k < patch_active_.size(); ++k) place[patch_active_[k]] = static_cast<int>(k);
  BlockPattern pattern;
  Blocks blocks;
  beside_ = patch_active_;
  patch_rotations_.resize(9 * patch_active_.size());
  for (std::size_t k = 0; k < patch_active_.size(); ++k) {
    const int i = patch_active_[k];
    std::copy(rotations_ + 9 * i, rotations_ + 9 * (i + 1), &patch_rotations_[9 * k]);
    pattern.row.push_back(static_cast<int>(k));
    blocks.push_back(diagonalBlock(*pattern_, *matrix_, i));
    const RowPattern::Row& row = pattern_->rows[i];
    for (int entry = row.first; entry < row.first + row.count; ++entry) {
      const int other = place[pattern_->column[entry]];
      if (other < 0) beside_.push_back(pattern_->column[entry]);
      if (other <= static_cast<int>(k)) continue;
      pattern.row.push_back(other);
      blocks.push_back(
          Eigen::Map<const Eigen::Matrix3f>(&matrix_->blocks[9 * static_cast<std::size_t>(entry)])
              .transpose()
              .cast<double>());
    }
    pattern.column_start.push_back(pattern.numBlocks());
  }
  for (const auto& tie : matrix_->ties) {
    if (place[tie.vertex] >= 0) blocks[pattern.column_start[place[tie.vertex]]] += tie.stiffness;
  }
  std::sort(beside_.begin(), beside_.end());
  beside_.erase(std::unique(beside_.begin(), beside_.end()), beside_.end());
  patch_values_.assign(3 * patch_active_.size(), 0.0F);
  moved_.assign(paddedSize(pattern_->numVertices()), 0.0F);
  left_.assign(paddedSize(pattern_->numVertices()), 0.0F);
  is_patch_factored_ = true;
  if (patch_active_.empty()) return SolveStatus::kSolved;
  const SolveStatus status = patch_factor_.factorise(
      pattern, blocks, std::vector<bool>(patch_active_.size(), false), Ordering::kMinimumDegree);
  // Between two corrections by S the coarse one keeps B positive only where no eigenvalue of S A reaches 2;
  // slivers may be too much for single precision. Added up, S and the coarse one are always positive.
  constexpr double kExact = 1.3;
  is_patch_factored_ = status == SolveStatus::kSolved;
  if (is_patch_factored_ && largestOfPatch() > kExact) beside_.clear();
  return status;
}

// Estimate of the largest eigenvalue of S A within the patch, by power iteration. Just factored, so S needs
// no turning.
double TurnedFactor::largestOfPatch() {
  constexpr int kSteps = 6;
  double length = 0;
  for (std::size_t k = 0; k < patch_values_.size(); ++k) {
    patch_values_[k] = static_cast<float>(static_cast<int>(k * 7919 % 1009) - 504);
    length += patch_values_[k] * patch_values_[k];
  }
  double largest = 0;
  for (int step = 0; step < kSteps; ++step) {
    const double scale = length > 0 ? 1 / std::sqrt(length) : 0;
    for (std::size_t k = 0; k < patch_active_.size(); ++k) {
      for (int c = 0; c < 3; ++c)
        left_[3 * patch_active_[k] + c] = static_cast<float>(scale * patch_values_[3 * k + c]);
    }
    multiply(*pattern_, *matrix_, patch_active_, left_.data(), moved_.data());
    for (std::size_t k = 0; k < patch_active_.size(); ++k) {
      for (int c = 0; c < 3; ++c) patch_values_[3 * k + c] = moved_[3 * patch_active_[k] + c];
    }
    patch_factor_.solve(patch_values_.data());
    length = 0;
    for (const float value : patch_values_) length += static_cast<double>(value) * value;
    largest = std::isfinite(length) ? std::sqrt(length) : std::numeric_limits<double>::infinity();
  }
  return largest;
}

// result += R P A_0^-1 P^T R^T residual.
void TurnedFactor::addCoarse(const float* residual, float* result) {
  std::fill(coarse_.begin(), coarse_.end(), 0.0F);
  for (const int i : *active_) {
    float r[3];
    turnBack(coarse_turns_ + 9 * i, residual + 3 * i, r);
    forEachShare(i, [&](int of, float weight) {
      if (is_fixed_[of]) return;
      for (int c = 0; c < 3; ++c) coarse_[3 * of + c] += weight * r[c];
    });
  }
  factor_.solve(coarse_.data());
  for (const int i : *active_) {
    float z[3] = {0, 0, 0};
    forEachShare(i, [&](int of, float weight) {
      for (int c = 0; c < 3; ++c) z[c] += weight * coarse_[3 * of + c];
    });
    turn(coarse_turns_ + 9 * i, z, z);
    for (int c = 0; c < 3; ++c) result[3 * i + c] += z[c];
  }
}

// result += S residual, S turned from the patch's rotations then to those of now.
void TurnedFactor::addPatch(const float* residual, float* result) {
  for (std::size_t k = 0; k < patch_active_.size(); ++k) {
    const int i = patch_active_[k];
    float r[3];
    turnBack(rotations_ + 9 * i, residual + 3 * i, r);
    turn(&patch_rotations_[9 * k], r, &patch_values_[3 * k]);
  }
  patch_factor_.solve(patch_values_.data());
  for (std::size_t k = 0; k < patch_active_.size(); ++k) {
    const int i = patch_active_[k];
    float z[3];
    turnBack(&patch_rotations_[9 * k], &patch_values_[3 * k], z);
    turn(rotations_ + 9 * i, z, z);
    for (int c = 0; c < 3; ++c) result[3 * i + c] += z[c];
  }
}

void TurnedFactor::apply(const float* residual, float* result) {
  for (const int i : *active_) {
    for (int c = 0; c < 3; ++c) result[3 * i + c] = 0;
  }
  if (patch_active_.empty()) return addCoarse(residual, result);
  addPatch(residual, result);
  if (beside_.empty()) return addCoarse(residual, result);
  std::copy(residual, residual + left_.size(), left_.begin());
  multiply(*pattern_, *matrix_, beside_, result, moved_.data());
  for (const int i : beside_) {
    for (int c = 0; c < 3; ++c) left_[3 * i + c] -= moved_[3 * i + c];
  }
  addCoarse(left_.data(), result);
  multiply(*pattern_, *matrix_, patch_active_, result, moved_.data());
  for (const int i : patch_active_) {
    for (int c = 0; c < 3; ++c) left_[3 * i + c] = residual[3 * i + c] - moved_[3 * i + c];
  }
  addPatch(left_.data(), result);
}

}  // namespace polyscalpel
