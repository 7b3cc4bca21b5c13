// SPDX-License-Identifier: BSD-3-Clause
#include "factor_maker.hpp"

#include <algorithm>
#include <utility>

#include "polyscalpel/solver/elimination_order.hpp"

namespace polyscalpel {

FactorMaker::Plain FactorMaker::factorise(const RowPattern& rows, const DifferenceMatrix<double>& matrix,
                                          const std::vector<bool>& fixed, std::size_t most_values,
                                          const std::vector<int>& order) {
  const BlockPattern pattern = toBlockPattern(rows);
  Blocks blocks;
  convert(rows, matrix, pattern, blocks);
  Plain plain;
  plain.status = plain.factor.factorise(pattern, blocks, fixed, most_values, order);
  return plain;
}

FactorMaker::Made FactorMaker::finish(Plain plain, const std::vector<bool>& fixed,
                                      const std::vector<float>& rotations) {
  Made made;
  made.status = plain.status;
  if (made.status != SolveStatus::kSolved) return made;
  order_ = plain.factor.order();
  added_since_order_.clear();
  made.factor.emplace(std::move(plain.factor), fixed, rotations);
  return made;
}

FactorMaker::Made FactorMaker::make(const Body& body, std::size_t most_values) {
  return finish(factorise(body.pattern, body.matrix, body.fixed, most_values, {}), body.fixed,
                body.rotations);
}

FactorMaker::Made FactorMaker::makeInLastOrder(const Body& body) {
  dropped_ = std::move(next_);
  std::vector<int> order = followCuts(order_, added_since_order_);
  order.erase(std::remove_if(order.begin(), order.end(), [&](int vertex) { return body.fixed[vertex]; }),
              order.end());
  const auto num_free = std::count(body.fixed.begin(), body.fixed.end(), false);
  if (static_cast<std::ptrdiff_t>(order.size()) != num_free) order.clear();  // one is found anew
  return finish(factorise(body.pattern, body.matrix, body.fixed, SingleFactor::kAnySize, order), body.fixed,
                body.rotations);
}

void FactorMaker::begin(const Body& body) {
  next_fixed_ = body.fixed;
  next_rotations_ = body.rotations;
  next_added_.clear();
  next_touched_.clear();
  next_ = std::async(std::launch::async, [rows = body.pattern, matrix = body.matrix, fixed = body.fixed] {
    return factorise(rows, matrix, fixed, SingleFactor::kAnySize, {});
  });
}

FactorMaker::Made FactorMaker::take() {
  Made made = finish(next_.get(), next_fixed_, next_rotations_);
  if (!made.factor) return made;
  added_since_order_ = next_added_;
  if (wasCutSince()) made.factor->follow(next_added_, next_touched_);
  return made;
}

void FactorMaker::follow(const std::vector<AddedVertex>& added, const std::vector<int>& touched) {
  added_since_order_.insert(added_since_order_.end(), added.begin(), added.end());
  if (!isUnderWay()) return;
  next_added_.insert(next_added_.end(), added.begin(), added.end());
  next_touched_.insert(next_touched_.end(), touched.begin(), touched.end());
}

}  // namespace polyscalpel
