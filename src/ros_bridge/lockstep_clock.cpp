// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/lockstep_clock.hpp"

#include <algorithm>
#include <limits>

namespace polyscalpel {

LockstepClock::LockstepClock(double time_step_s, double tool_timeout_s)
    : time_step_s_(time_step_s), tool_timeout_ns_(toNanoseconds(tool_timeout_s)) {}

bool LockstepClock::takeAnchor(const std::vector<ToolTracker>& trackers, const StampClock& clock) {
  if (clock.latestEpoch() < epoch_) return false;
  // Every tool's first stamp must be known, or the order of arrival would decide on t_0.
  const bool is_past = clock.latestEpoch() > epoch_;
  const bool timed_out = clock.newest_ns(epoch_) - clock.first_ns(epoch_) > tool_timeout_ns_;
  if (!is_past && !timed_out) {
    for (std::size_t i = 0; i < trackers.size(); ++i)
      if (!trackers[i].hasReached(epoch_)) waiting_for_.push_back(static_cast<int>(i));
    if (!waiting_for_.empty()) return false;
  }
  anchor_ns_ = clock.first_ns(epoch_);
  steps_ = 0;
  return true;
}

std::optional<LockstepInput> LockstepClock::next(std::vector<ToolTracker>& trackers,
                                                 const StampClock& clock) {
  waiting_for_.clear();
  while (true) {
    if (!anchor_ns_ && !takeAnchor(trackers, clock)) return std::nullopt;
    const std::int64_t time_ns = *anchor_ns_ + toNanoseconds(static_cast<double>(steps_ + 1) * time_step_s_);
    const bool is_past = clock.latestEpoch() > epoch_;
    // Once a later epoch is under way, who is still silent in this one will stay so.
    const bool later_timed_out =
        is_past && clock.newest_ns(epoch_ + 1) - clock.first_ns(epoch_ + 1) > tool_timeout_ns_;
    const std::int64_t horizon_ns =
        later_timed_out ? std::numeric_limits<std::int64_t>::max() / 2 : clock.newest_ns(epoch_);

    LockstepInput input;
    input.stamp.fromNSec(static_cast<std::uint64_t>(time_ns));
    for (std::size_t i = 0; i < trackers.size(); ++i) {
      const TrackedPose pose = trackers[i].at(epoch_, time_ns, *anchor_ns_, horizon_ns);
      if (pose.state == TrackedPose::State::kWaiting) waiting_for_.push_back(static_cast<int>(i));
      const bool present = pose.state == TrackedPose::State::kPresent;
      input.T_world_tool.push_back(present ? std::optional<Eigen::Isometry3d>(pose.T_world_tool)
                                           : std::nullopt);
    }
    if (!waiting_for_.empty()) return std::nullopt;
    if (clock.newest_ns(epoch_) >= time_ns) {
      ++steps_;
      for (ToolTracker& tracker : trackers) tracker.forgetBefore(epoch_, time_ns);
      return input;
    }
    if (!is_past) return std::nullopt;
    ++epoch_;
    anchor_ns_.reset();
  }
}

double LockstepClock::lead_s(const StampClock& clock) const {
  if (!anchor_ns_ || epoch_ > clock.latestEpoch()) return 0;
  const std::int64_t time_ns = *anchor_ns_ + toNanoseconds(static_cast<double>(steps_) * time_step_s_);
  return std::max(0.0, static_cast<double>(clock.newest_ns(epoch_) - time_ns) * 1e-9);
}

void LockstepClock::clear() {
  epoch_ = 0;
  anchor_ns_.reset();
  steps_ = 0;
  waiting_for_.clear();
}

}  // namespace polyscalpel
