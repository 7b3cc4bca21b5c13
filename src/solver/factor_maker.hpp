// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <future>
#include <limits>
#include <optional>
#include <vector>

#include "polyscalpel/core/difference_matrix.hpp"
#include "polyscalpel/solver/symbolic_factor.hpp"
#include "polyscalpel/solver/turned_factor.hpp"

namespace polyscalpel {

/// Makes the factors of a body that is cut again and again, at once or beside the caller's steps.
class FactorMaker {
 public:
  /// What a factor is made of.
  struct Body {
    const RowPattern& pattern;
    const DifferenceMatrix<double>& matrix;
    const std::vector<bool>& fixed;       ///< one flag a vertex
    const std::vector<float>& rotations;  ///< as TurnedFactor takes them
  };
  struct Made {
    SolveStatus status = SolveStatus::kSolved;
    std::optional<TurnedFactor> factor;  ///< there if the status is kSolved
  };

  static constexpr std::size_t kAnySize = std::numeric_limits<std::size_t>::max();

  /// A factor of more than most_values numbers is not made: kOutOfMemory.
  Made make(const Body& body, std::size_t most_values = kAnySize);
  /// In half the time, by the ordering that is found fastest. One under way is dropped: it is of an older
  /// body.
  Made makeAtOnce(const Body& body);

  /// Begins one in a thread of its own; nothing of the body is needed any more.
  void begin(const Body& body);
  bool isUnderWay() const { return next_.valid(); }
  /// Whether follow() was called since begin().
  bool wasCutSince() const { return !next_touched_.empty(); }
  /// The one that was begun, with the cuts since as its patch; waits for it.
  Made take();

  /// As TurnedFactor::follow(), which is to be told for the factor in use besides; of no use to one not under
  /// way.
  void follow(const std::vector<AddedVertex>& added, const std::vector<int>& touched);

 private:
  struct Plain {
    SolveStatus status = SolveStatus::kSolved;
    SingleFactor factor;
    Ordering ordering = Ordering::kUndecided;  // by which it was made
  };
  static Plain factorise(const RowPattern& rows, const DifferenceMatrix<double>& matrix,
                         const std::vector<bool>& fixed, std::size_t most_values, Ordering ordering);
  static Made finish(Plain plain, const std::vector<bool>& fixed, const std::vector<float>& rotations);

  Ordering ordering_ = Ordering::kUndecided;  // of the body when it was whole
  // The factor under way, of a body as it was, and what has been cut since.
  std::future<Plain> next_;
  std::future<Plain> dropped_;  // not waited for until the next one is dropped
  std::vector<bool> next_fixed_;
  std::vector<float> next_rotations_;
  std::vector<AddedVertex> next_added_;
  std::vector<int> next_touched_;
};

}  // namespace polyscalpel
