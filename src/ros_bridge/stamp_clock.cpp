// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/stamp_clock.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace polyscalpel {

std::int64_t toNanoseconds(double seconds) {
  return std::llround(seconds * 1e9);
}

StampClock::StampClock(int num_tools, double clock_jump_s, double longest_gap_s)
    : clock_jump_ns_(toNanoseconds(clock_jump_s)),
      longest_gap_ns_(toNanoseconds(longest_gap_s)),
      tools_(static_cast<std::size_t>(num_tools)) {}

void StampClock::accept(Tool& tool, int epoch, std::int64_t stamp_ns) {
  if (epoch == static_cast<int>(epochs_.size())) epochs_.push_back({stamp_ns, stamp_ns});
  Epoch& stamps = epochs_[static_cast<std::size_t>(epoch)];
  stamps.first_ns = std::min(stamps.first_ns, stamp_ns);
  stamps.newest_ns = std::max(stamps.newest_ns, stamp_ns);
  tool = {epoch, stamp_ns};
}

StampVerdict StampClock::judge(int tool_index, std::int64_t stamp_ns) {
  Tool& tool = tools_[static_cast<std::size_t>(tool_index)];
  const int latest = latestEpoch();
  if (latest < 0) {
    accept(tool, 0, stamp_ns);
    return StampVerdict::kFollows;
  }
  const bool lags = tool.epoch >= 0 && tool.epoch < latest;
  if (lags && stamp_ns > tool.newest_ns &&
      std::abs(stamp_ns - newest_ns(tool.epoch)) <= std::abs(stamp_ns - newest_ns(latest))) {
    accept(tool, tool.epoch, stamp_ns);  // sent before another tool's clock was set, arrived after
    return StampVerdict::kFollows;
  }
  if (tool.epoch == latest && stamp_ns <= tool.newest_ns) {
    if (tool.newest_ns - stamp_ns <= clock_jump_ns_) return StampVerdict::kBack;
    accept(tool, latest + 1, stamp_ns);
    return StampVerdict::kJump;
  }
  if (stamp_ns - newest_ns(latest) > longest_gap_ns_) {
    accept(tool, latest + 1, stamp_ns);
    return StampVerdict::kJump;
  }
  accept(tool, latest, stamp_ns);
  return lags ? StampVerdict::kJump : StampVerdict::kFollows;
}

void StampClock::clear() {
  epochs_.clear();
  std::fill(tools_.begin(), tools_.end(), Tool());
}

}  // namespace polyscalpel
