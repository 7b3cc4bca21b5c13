// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace polyscalpel {

/// What failed is not tried again for some steps, twice as many each time.
class Ban {
 public:
  bool holds() const { return steps_left_ > 0; }
  void beginStep() { steps_left_ = std::max(0, steps_left_ - 1); }
  void noteFailure() {
    steps_left_ = length_;
    length_ = std::min(2 * length_, kLongest);
  }
  void noteSuccess() { length_ = kShortest; }

 private:
  static constexpr int kShortest = 8, kLongest = 256;
  int steps_left_ = 0, length_ = kShortest;
};

}  // namespace polyscalpel
