// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/tool_tracker.hpp"

#include <cmath>
#include <utility>

#include "polyscalpel/cutting/blade_sweep.hpp"
#include "polyscalpel/ros_bridge/geometry_conversions.hpp"

namespace polyscalpel {

ToolTracker::ToolTracker(int tool, std::string tool_frame, double tool_timeout_s, double tf_timeout_s,
                         StampClock& clock, const TransformTree& transforms)
    : tool_(tool),
      tool_frame_(std::move(tool_frame)),
      tool_timeout_ns_(toNanoseconds(tool_timeout_s)),
      tf_timeout_ns_(toNanoseconds(tf_timeout_s)),
      clock_(clock),
      transforms_(transforms) {}

bool ToolTracker::add(const geometry_msgs::PoseStamped& message, const ros::Time& now) {
  ++counters_.received;
  switch (checkPose(message.pose)) {
    case PoseCheck::kNotFinite:
      ++counters_.not_finite;
      return false;
    case PoseCheck::kBadQuaternion:
      ++counters_.bad_quaternion;
      return false;
    case PoseCheck::kGood:
      break;
  }
  if (message.header.frame_id.empty() || message.header.frame_id == tool_frame_ ||
      message.header.frame_id == "/" + tool_frame_) {
    ++counters_.no_transform;
    return false;
  }
  const auto stamp_ns = static_cast<std::int64_t>(message.header.stamp.toNSec());
  const StampVerdict verdict = stamp_ns == 0 ? StampVerdict::kBack : clock_.judge(tool_, stamp_ns);
  if (verdict == StampVerdict::kBack) {
    ++counters_.bad_stamp;
    return false;
  }
  if (verdict == StampVerdict::kJump) ++counters_.clock_jumps;
  waiting_.push_back({clock_.epoch(tool_), now, message});
  return verdict == StampVerdict::kJump;
}

bool ToolTracker::addFollowed(const StampedTransform& pose, const ros::Time& now) {
  if (pose.stamp.isZero()) {
    always_ = pose.T_world_frame;
    return false;
  }
  always_.reset();
  const auto stamp_ns = static_cast<std::int64_t>(pose.stamp.toNSec());
  const StampVerdict verdict = clock_.judge(tool_, stamp_ns);
  if (verdict == StampVerdict::kBack) return false;  // tf had nothing new
  ++counters_.received;
  if (verdict == StampVerdict::kJump) ++counters_.clock_jumps;
  samples_.push_back({clock_.epoch(tool_), stamp_ns, now, pose.T_world_frame});
  return verdict == StampVerdict::kJump;
}

void ToolTracker::resolve(const Expired& expired) {
  // In order, so that a pose whose transform comes late is not overtaken.
  while (!waiting_.empty()) {
    const Waiting& front = waiting_.front();
    const ros::Time& stamp = front.message.header.stamp;
    const auto stamp_ns = static_cast<std::int64_t>(stamp.toNSec());
    const std::optional<StampedTransform> T_world_frame =
        transforms_.find(front.message.header.frame_id, stamp);
    if (T_world_frame) {
      samples_.push_back(
          {front.epoch, stamp_ns, front.arrival, T_world_frame->T_world_frame * fromMsg(front.message.pose)});
    } else if (expired(front.epoch, stamp_ns, front.arrival)) {
      ++counters_.no_transform;
    } else {
      return;
    }
    waiting_.pop_front();
  }
}

void ToolTracker::resolveByTime(const ros::Time& now) {
  resolve([&](int, std::int64_t, const ros::Time& arrival) {
    return static_cast<std::int64_t>((now - arrival).toNSec()) >= tf_timeout_ns_;
  });
}

void ToolTracker::resolveByStamps() {
  resolve([&](int epoch, std::int64_t stamp_ns, const ros::Time&) {
    return epoch < clock_.latestEpoch() || clock_.newest_ns(epoch) - stamp_ns >= tf_timeout_ns_;
  });
}

std::optional<Eigen::Isometry3d> ToolTracker::latest(const ros::Time& now) {
  if (always_) return always_;
  if (samples_.empty()) return std::nullopt;
  samples_.erase(samples_.begin(), samples_.end() - 1);
  const Sample& sample = samples_.back();
  if ((now - sample.arrival).toNSec() <= tool_timeout_ns_) {
    timed_out_ = false;
    return sample.T_world_tool;
  }
  if (!timed_out_) ++counters_.timeouts;
  timed_out_ = true;
  return std::nullopt;
}

TrackedPose ToolTracker::at(int epoch, std::int64_t time_ns, std::int64_t anchor_ns,
                            std::int64_t horizon_ns) {
  using State = TrackedPose::State;
  if (always_) return {State::kPresent, *always_};
  const Sample* before = nullptr;
  for (const Sample& sample : samples_) {
    if (sample.epoch < epoch) continue;
    if (sample.epoch > epoch) break;
    if (sample.stamp_ns <= time_ns) {
      before = &sample;
      if (sample.stamp_ns < time_ns) continue;
      timed_out_ = false;
      return {State::kPresent, sample.T_world_tool};
    }
    const bool joined = before != nullptr && sample.stamp_ns - before->stamp_ns <= tool_timeout_ns_;
    if (!joined) return {State::kAbsent, Eigen::Isometry3d::Identity()};
    timed_out_ = false;
    const double s = static_cast<double>(time_ns - before->stamp_ns) /
                     static_cast<double>(sample.stamp_ns - before->stamp_ns);
    return {State::kPresent, interpolate(before->T_world_tool, sample.T_world_tool, s)};
  }
  for (const Waiting& waiting : waiting_)
    if (waiting.epoch == epoch) return {};
  if (clock_.epoch(tool_) > epoch) return {State::kAbsent, Eigen::Isometry3d::Identity()};
  const std::int64_t last_ns = before != nullptr ? before->stamp_ns : anchor_ns;
  if (horizon_ns - last_ns <= tool_timeout_ns_) return {};
  if (!timed_out_ && before != nullptr) ++counters_.timeouts;
  timed_out_ = true;
  return {State::kAbsent, Eigen::Isometry3d::Identity()};
}

void ToolTracker::forgetBefore(int epoch, std::int64_t time_ns) {
  // One pose before the time stays: the next is interpolated from it, and it tells since when the tool is
  // silent.
  while (!samples_.empty() && samples_.front().epoch < epoch) samples_.pop_front();
  while (samples_.size() > 1 && samples_[1].epoch == epoch && samples_[1].stamp_ns <= time_ns)
    samples_.pop_front();
}

bool ToolTracker::hasReached(int epoch) const {
  return always_ || clock_.epoch(tool_) >= epoch;
}

void ToolTracker::clear(bool counters) {
  waiting_.clear();
  samples_.clear();
  always_.reset();
  timed_out_ = false;
  if (counters) counters_ = PoseCounters();
}

}  // namespace polyscalpel
