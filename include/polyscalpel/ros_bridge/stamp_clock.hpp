// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace polyscalpel {

/// What a stamp means after those before it.
enum class StampVerdict {
  kFollows,  ///< newer than the tool's last one
  kBack,     ///< not newer, by clock_jump_s at most: to be dropped
  kJump,     ///< the clock behind the stamps was set (a bag loops): the tool's time begins anew
};

/// Orders the stamps of several tools into epochs. Within an epoch the stamps of each tool rise; a new epoch
/// begins when the clock behind them was set. Stamps are nanoseconds, so that differences are exact.
class StampClock {
 public:
  /// clock_jump_s: a stamp further back than this starts an epoch; longest_gap_s: as does one further ahead
  /// of all others.
  StampClock(int num_tools, double clock_jump_s, double longest_gap_s);

  /// Judges the next stamp of a tool and, unless it is kBack, takes note of it.
  StampVerdict judge(int tool, std::int64_t stamp_ns);

  /// Forgets all stamps.
  void clear();

  /// Epoch of the tool's newest stamp, or -1 when it has none.
  int epoch(int tool) const { return tools_[static_cast<std::size_t>(tool)].epoch; }
  /// Latest epoch, or -1 when there is no stamp.
  int latestEpoch() const { return static_cast<int>(epochs_.size()) - 1; }
  /// First by value and newest stamp of an epoch over all tools [ns].
  std::int64_t first_ns(int epoch) const { return epochs_[static_cast<std::size_t>(epoch)].first_ns; }
  std::int64_t newest_ns(int epoch) const { return epochs_[static_cast<std::size_t>(epoch)].newest_ns; }
  int numTools() const { return static_cast<int>(tools_.size()); }

 private:
  struct Tool {
    int epoch = -1;
    std::int64_t newest_ns = 0;
  };
  struct Epoch {
    std::int64_t first_ns = 0;
    std::int64_t newest_ns = 0;
  };
  void accept(Tool& tool, int epoch, std::int64_t stamp_ns);

  std::int64_t clock_jump_ns_;
  std::int64_t longest_gap_ns_;
  std::vector<Tool> tools_;
  std::vector<Epoch> epochs_;
};

/// Seconds to whole nanoseconds.
std::int64_t toNanoseconds(double seconds);

}  // namespace polyscalpel
