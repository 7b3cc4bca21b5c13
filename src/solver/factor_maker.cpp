// SPDX-License-Identifier: BSD-3-Clause
#include "factor_maker.hpp"

#include <utility>

namespace polyscalpel {

FactorMaker::Plain FactorMaker::factorise(const RowPattern& rows, const DifferenceMatrix<double>& matrix,
                                          const std::vector<bool>& fixed, std::size_t most_values,
                                          Ordering ordering) {
  const BlockPattern pattern = toBlockPattern(rows);
  Blocks blocks;
  convert(rows, matrix, pattern, blocks);
  Plain plain;
  plain.ordering = ordering;
  SymbolicFactor symbolic;
  plain.status = analyse(pattern, fixed, plain.ordering, symbolic);
  if (plain.status != SolveStatus::kSolved) return plain;
  if (symbolic.numValues() > most_values) {
    plain.status = SolveStatus::kOutOfMemory;
    return plain;
  }
  plain.status = plain.factor.factorise(std::move(symbolic), pattern, blocks);
  return plain;
}

FactorMaker::Made FactorMaker::finish(Plain plain, const std::vector<bool>& fixed,
                                      const std::vector<float>& rotations) {
  Made made;
  made.status = plain.status;
  if (made.status == SolveStatus::kSolved) made.factor.emplace(std::move(plain.factor), fixed, rotations);
  return made;
}

FactorMaker::Made FactorMaker::make(const Body& body, std::size_t most_values) {
  Plain plain = factorise(body.pattern, body.matrix, body.fixed, most_values, ordering_);
  ordering_ = plain.ordering;
  return finish(std::move(plain), body.fixed, body.rotations);
}

FactorMaker::Made FactorMaker::makeAtOnce(const Body& body) {
  dropped_ = std::move(next_);
  return finish(factorise(body.pattern, body.matrix, body.fixed, kAnySize, Ordering::kMinimumDegree),
                body.fixed, body.rotations);
}

void FactorMaker::begin(const Body& body) {
  next_fixed_ = body.fixed;
  next_rotations_ = body.rotations;
  next_added_.clear();
  next_touched_.clear();
  next_ = std::async(std::launch::async,
                     [rows = body.pattern, matrix = body.matrix, fixed = body.fixed, ordering = ordering_] {
                       return factorise(rows, matrix, fixed, kAnySize, ordering);
                     });
}

FactorMaker::Made FactorMaker::take() {
  Made made = finish(next_.get(), next_fixed_, next_rotations_);
  if (made.factor && wasCutSince()) made.factor->follow(next_added_, next_touched_);
  return made;
}

void FactorMaker::follow(const std::vector<AddedVertex>& added, const std::vector<int>& touched) {
  if (!isUnderWay()) return;
  next_added_.insert(next_added_.end(), added.begin(), added.end());
  next_touched_.insert(next_touched_.end(), touched.begin(), touched.end());
}

}  // namespace polyscalpel
