// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace polyscalpel {

/// Adds the wall time between its construction and destruction to a sum [s].
class StageTimer {
 public:
  explicit StageTimer(double& sum_s) : sum_s_(sum_s), start_(Clock::now()) {}
  ~StageTimer() { sum_s_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& sum_s_;
  Clock::time_point start_;
};

}  // namespace polyscalpel
