// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/aggregates.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/quad.hpp"
#include "vertex_turns.hpp"

namespace polyscalpel {

namespace {

using Coarse = Eigen::Matrix<double, 6, 6>;

Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d result;
  result << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return result;
}

/// block += P_i^T A P_j, P = (I, -[arm]_x).
void addBetween(const Eigen::Vector3d& arm_i, const Eigen::Matrix3d& A, const Eigen::Vector3d& arm_j,
                Coarse& block) {
  const Eigen::Matrix3d turned = -A * crossMatrix(arm_j);
  const Eigen::Matrix3d back = crossMatrix(arm_i);
  block.topLeftCorner<3, 3>() += A;
  block.topRightCorner<3, 3>() += turned;
  block.bottomLeftCorner<3, 3>().noalias() += back * A;
  block.bottomRightCorner<3, 3>().noalias() += back * turned;
}

/// Of points, their fourth components being bystanders.
Quad<float> crossProduct(const Quad<float>& a, const Quad<float>& b) {
  return pick<1, 2, 0, 3>(a, a) * pick<2, 0, 1, 3>(b, b) - pick<2, 0, 1, 3>(a, a) * pick<1, 2, 0, 3>(b, b);
}

void storeQuad(float* to, const Quad<float>& quad) {
  std::memcpy(to, &quad, sizeof quad);
}

}  // namespace

std::vector<int> makeAggregates(const RowPattern& pattern, const std::vector<int>& active, int size,
                                int& num_groups) {
  constexpr int kOut = -1, kOpen = -2;
  std::vector<int> group(pattern.numVertices(), kOut);
  for (const int i : active) group[i] = kOpen;
  std::vector<std::vector<int>> members;
  std::vector<int> seeds;  // neighbours of groups, by which the next ones grow beside them
  std::size_t next_seed = 0;
  const auto forEachNeighbour = [&](int i, const auto& visit) {
    const RowPattern::Row& row = pattern.rows[i];
    for (int k = row.first; k < row.first + row.count; ++k) visit(pattern.column[k]);
  };
  for (const int start : active) {
    if (group[start] != kOpen) continue;
    seeds.push_back(start);
    while (next_seed < seeds.size()) {
      const int seed = seeds[next_seed++];
      if (group[seed] != kOpen) continue;
      const int number = static_cast<int>(members.size());
      std::vector<int> queue = {seed};
      group[seed] = number;
      for (std::size_t k = 0; k < queue.size(); ++k) {
        forEachNeighbour(queue[k], [&](int other) {
          if (group[other] != kOpen) return;
          if (static_cast<int>(queue.size()) < size) {
            group[other] = number;
            queue.push_back(other);
          } else {
            seeds.push_back(other);
          }
        });
      }
      members.push_back(std::move(queue));
    }
  }
  // Small leftovers join the neighbour they have most to do with.
  std::vector<int> links(members.size(), 0);
  for (std::size_t g = 0; g < members.size(); ++g) {
    if (3 * static_cast<int>(members[g].size()) >= size) continue;
    std::vector<int> around;
    for (const int i : members[g]) {
      forEachNeighbour(i, [&](int other) {
        const int of = group[other];
        if (of < 0 || of == static_cast<int>(g)) return;
        if (links[of]++ == 0) around.push_back(of);
      });
    }
    int best = -1;
    for (const int of : around) {
      if (best < 0 || links[of] > links[best] || (links[of] == links[best] && of < best)) best = of;
    }
    for (const int of : around) links[of] = 0;
    if (best < 0) continue;
    for (const int i : members[g]) group[i] = best;
    members[best].insert(members[best].end(), members[g].begin(), members[g].end());
    members[g].clear();
  }
  std::vector<int> number(members.size(), -1);
  num_groups = 0;
  for (std::size_t g = 0; g < members.size(); ++g) {
    if (!members[g].empty()) number[g] = num_groups++;
  }
  for (int& of : group) {
    if (of >= 0) of = number[of];
  }
  return group;
}

int AggregatePreconditioner::groupSize(int num_active) {
  constexpr int kSmallest = 30;
  constexpr double kOfRoot = 0.4;  // a ball of 230,000 cells: 85 vertices, a fifth less time than with 30
  return std::max(kSmallest, static_cast<int>(kOfRoot * std::sqrt(static_cast<double>(num_active))));
}

SolveStatus AggregatePreconditioner::make(const RowPattern& pattern,
                                          const DifferenceMatrix<double>& rest_matrix,
                                          const Eigen::Ref<const Eigen::Matrix3Xd>& rest_positions,
                                          const std::vector<int>& active) {
  group_ = makeAggregates(pattern, active, groupSize(static_cast<int>(active.size())), num_groups_);
  std::vector<std::vector<int>> members(num_groups_);
  for (const int i : active) members[group_[i]].push_back(i);

  middle_of_group_.clear();
  group_middles_.resize(3, num_groups_);
  group_lengths_.resize(num_groups_);
  // Arms in the group's size, so that turns weigh as much as shifts.
  Eigen::Matrix3Xd arms = Eigen::Matrix3Xd::Zero(3, pattern.numVertices());
  for (int g = 0; g < num_groups_; ++g) {
    const std::vector<int>& group = members[g];
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const int i : group) middle += rest_positions.col(i);
    middle /= static_cast<double>(group.size());
    double square = 0;
    for (const int i : group) square += (rest_positions.col(i) - middle).squaredNorm();
    const double length = square > 0 ? std::sqrt(square / static_cast<double>(group.size())) : 1;
    int nearest = group.front();
    for (const int i : group) {
      arms.col(i) = (rest_positions.col(i) - middle) / length;
      if (arms.col(i).squaredNorm() < arms.col(nearest).squaredNorm()) nearest = i;
    }
    middle_of_group_.push_back(nearest);
    group_middles_.col(g) = middle;
    group_lengths_[g] = length;
  }
  group_rotations_.resize(9 * static_cast<std::size_t>(num_groups_));
  arms_.assign(paddedSize(pattern.numVertices()), 0.0F);
  Eigen::Map<Eigen::VectorXf>(arms_.data(), arms.size()) = arms.reshaped().cast<float>();
  coarse_values_.assign(6 * static_cast<std::size_t>(num_groups_), 0.0F);
  group_sums_.assign(8 * static_cast<std::size_t>(num_groups_), 0.0F);

  // P^T A_0 P on and below the diagonal, column by column; two block rows a group.
  BlockPattern coarse;
  Blocks blocks;
  std::vector<int> place(num_groups_, -1);
  std::vector<int> around;
  std::vector<Coarse> column;
  for (int g = 0; g < num_groups_; ++g) {
    around.assign(1, g);
    column.assign(1, Coarse::Zero());
    place[g] = 0;
    for (const int j : members[g]) {
      Eigen::Matrix3d diagonal = diagonalBlock(pattern, rest_matrix, j);
      addBetween(arms.col(j), diagonal, arms.col(j), column[0]);
      const RowPattern::Row& row = pattern.rows[j];
      for (int k = row.first; k < row.first + row.count; ++k) {
        const int i = pattern.column[k], of = group_[i];
        if (of < g) continue;  // inactive, or above the diagonal
        if (place[of] < 0) {
          place[of] = static_cast<int>(around.size());
          around.push_back(of);
          column.push_back(Coarse::Zero());
        }
        // The row of j has A_ji; wanted is A_ij.
        const Eigen::Matrix3d A =
            Eigen::Map<const Eigen::Matrix3d>(&rest_matrix.blocks[9 * static_cast<std::size_t>(k)])
                .transpose();
        addBetween(arms.col(i), A, arms.col(j), column[place[of]]);
      }
    }
    // A group of one vertex or of a line does not feel all turns.
    constexpr double kSupport = 1e-9;
    column[0].diagonal().array() += kSupport * column[0].diagonal().maxCoeff();
    std::vector<int> order(around.begin() + 1, around.end());
    std::sort(order.begin(), order.end());
    for (int half = 0; half < 2; ++half) {
      for (int part = half; part < 2; ++part) {
        coarse.row.push_back(2 * g + part);
        blocks.push_back(column[0].block<3, 3>(3 * part, 3 * half));
      }
      for (const int of : order) {
        for (int part = 0; part < 2; ++part) {
          coarse.row.push_back(2 * of + part);
          blocks.push_back(column[place[of]].block<3, 3>(3 * part, 3 * half));
        }
      }
      coarse.column_start.push_back(coarse.numBlocks());
    }
    for (const int of : around) place[of] = -1;
  }
  if (num_groups_ == 0) return SolveStatus::kSolved;
  SingleFactor factor;
  const SolveStatus status = factor.factorise(coarse, blocks, std::vector<bool>(2 * num_groups_, false));
  coarse_ = HeldFactor(std::move(factor), 2 * num_groups_);
  return status;
}

bool AggregatePreconditioner::follow(const std::vector<AddedVertex>& added,
                                     const Eigen::Ref<const Eigen::Matrix3Xd>& rest_positions) {
  for (const AddedVertex& vertex : added) {
    POLYSCALPEL_ASSERT(vertex.vertex == static_cast<int>(group_.size()));
    const int nearer = group_[vertex.nearerParent()];
    const int group = nearer >= 0 ? nearer : group_[vertex.fartherParent()];
    if (group < 0) return false;  // both parents are fixed
    group_.push_back(group);
    const Eigen::Vector3d arm =
        (rest_positions.col(vertex.vertex) - group_middles_.col(group)) / group_lengths_[group];
    arms_.pop_back();  // the padding
    for (int c = 0; c < 3; ++c) arms_.push_back(static_cast<float>(arm[c]));
    arms_.push_back(0);
  }
  return true;
}

// A group turns as the vertex nearest to its middle does; arms turn with their own vertices.
void AggregatePreconditioner::turnGroups(const std::vector<float>& rotations) {
  turned_arms_.resize(arms_.size());
  for (const int i : *active_) turn(&rotations[9 * i], &arms_[3 * i], &turned_arms_[3 * i]);
  for (int g = 0; g < num_groups_; ++g)
    std::copy_n(&rotations[9 * middle_of_group_[g]], 9, &group_rotations_[9 * g]);
}

SolveStatus AggregatePreconditioner::holdCoarse(const std::vector<Hold>& holds) {
  std::vector<HeldFactor::HeldPoint> points;
  for (const Hold& hold : holds) {
    HeldFactor::HeldPoint& point = points.emplace_back();
    point.stiffness = hold.stiffness;
    for (const Hold::Share& share : hold.shares) {
      const int i = share.vertex, group = group_[i];
      if (group < 0) continue;
      const Eigen::Map<const Eigen::Matrix3f> R(&group_rotations_[9 * group]);
      const Eigen::Map<const Eigen::Vector3f> arm(&turned_arms_[3 * i]);
      const Eigen::Matrix3d turned = share.weight * R.cast<double>().transpose();
      point.parts.push_back({2 * group, turned});
      point.parts.push_back({2 * group + 1, turned * crossMatrix(arm.cast<double>())});
    }
  }
  return coarse_.hold(points);
}

void AggregatePreconditioner::apply(const float* residual, float* result) {
  std::fill(group_sums_.begin(), group_sums_.end(), 0.0F);
  for (const std::ptrdiff_t i : *active_) {
    const Quad<float> r = loadQuad(residual + 3 * i), arm = loadQuad(&turned_arms_[3 * i]);
    float* const sum = &group_sums_[8 * static_cast<std::ptrdiff_t>(group_[i])];
    storeQuad(sum, loadQuad(sum) + r);
    storeQuad(sum + 4, loadQuad(sum + 4) + crossProduct(arm, r));
  }
  for (int half = 0; half < 2 * num_groups_; ++half)
    turnBack(&group_rotations_[9 * (half / 2)], &group_sums_[4 * half], &coarse_values_[3 * half]);
  if (num_groups_ > 0) coarse_.solve(coarse_values_.data());
  for (int half = 0; half < 2 * num_groups_; ++half)
    turn(&group_rotations_[9 * (half / 2)], &coarse_values_[3 * half], &group_sums_[4 * half]);
  jacobi_.apply(residual, result);
  for (const std::ptrdiff_t i : *active_) {
    const float* const motion = &group_sums_[8 * static_cast<std::ptrdiff_t>(group_[i])];
    const Quad<float> arm = loadQuad(&turned_arms_[3 * i]);
    float* const z = result + 3 * i;
    storeThree(z, Quad<float>(loadQuad(z) + loadQuad(motion) + crossProduct(loadQuad(motion + 4), arm)));
  }
}

}  // namespace polyscalpel
