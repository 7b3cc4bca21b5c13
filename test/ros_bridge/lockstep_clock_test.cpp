// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/lockstep_clock.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "ros_bridge/pose_messages.hpp"

namespace polyscalpel {
namespace {

using testing::poseAt;

constexpr double kStep_s = 0.01;

/// Tools, their messages and the steps that came of them.
class Line {
 public:
  explicit Line(int num_tools) : clock_(num_tools, 1, 60) {
    for (int i = 0; i < num_tools; ++i)
      trackers_.emplace_back(i, "tool" + std::to_string(i), 0.5, 0.2, clock_, transforms_);
  }
  void add(int tool, double stamp_s, double x) {
    trackers_[static_cast<std::size_t>(tool)].add(poseAt(stamp_s, x), ros::Time(stamp_s));
  }
  void run() {
    for (ToolTracker& tracker : trackers_) tracker.resolveByStamps();
    while (std::optional<LockstepInput> input = lockstep_.next(trackers_, clock_)) steps_.push_back(*input);
  }
  const std::vector<LockstepInput>& steps() const { return steps_; }
  const LockstepClock& lockstep() const { return lockstep_; }
  const StampClock& clock() const { return clock_; }

 private:
  StampClock clock_;
  TransformTree transforms_{"world", 1};
  std::vector<ToolTracker> trackers_;
  LockstepClock lockstep_{kStep_s, 0.5};
  std::vector<LockstepInput> steps_;
};

bool same(const std::vector<LockstepInput>& a, const std::vector<LockstepInput>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].stamp != b[i].stamp || a[i].T_world_tool.size() != b[i].T_world_tool.size()) return false;
    for (std::size_t j = 0; j < a[i].T_world_tool.size(); ++j) {
      if (a[i].T_world_tool[j].has_value() != b[i].T_world_tool[j].has_value()) return false;
      if (a[i].T_world_tool[j] && a[i].T_world_tool[j]->matrix() != b[i].T_world_tool[j]->matrix())
        return false;
    }
  }
  return true;
}

TEST(LockstepClock, StepsAsFarAsThePosesReach) {
  Line line(1);
  line.run();
  EXPECT_TRUE(line.steps().empty()) << "no pose, no time";
  line.add(0, 100, 0);
  line.run();
  EXPECT_TRUE(line.steps().empty());
  line.add(0, 100.1, 1);
  line.run();
  ASSERT_EQ(line.steps().size(), 10u);
  EXPECT_EQ(line.steps()[0].stamp, ros::Time(100.01));
  EXPECT_NEAR(line.steps()[2].T_world_tool[0]->translation().x(), 0.3, 1e-9);
  EXPECT_NEAR(line.steps()[9].T_world_tool[0]->translation().x(), 1, 1e-12);
  line.run();
  EXPECT_EQ(line.steps().size(), 10u) << "a tool that fell silent alone holds time";
}

TEST(LockstepClock, WaitsForEveryTool) {
  Line line(2);
  for (int i = 0; i <= 20; ++i) line.add(0, 100 + 0.02 * i, i);
  line.run();
  EXPECT_TRUE(line.steps().empty()) << "the first stamp of the second tool is not known";
  EXPECT_EQ(line.lockstep().waitingFor(), std::vector<int>{1});
  line.add(1, 100.1, 0);
  line.run();
  ASSERT_EQ(line.steps().size(), 10u);
  EXPECT_FALSE(line.steps()[8].T_world_tool[1].has_value()) << "before its first pose";
  EXPECT_TRUE(line.steps()[9].T_world_tool[1].has_value());
  EXPECT_NEAR(line.lockstep().lead_s(line.clock()), 0.3, 1e-9);
}

TEST(LockstepClock, LetsGoOfASilentTool) {
  Line line(2);
  line.add(1, 100, 0);
  line.add(1, 100.05, 0);
  for (int i = 0; i <= 60; ++i) line.add(0, 100 + 0.01 * i, i);
  line.run();
  // 100.60 is more than 0.5 s after the second tool's last pose, so all steps that the first tool's poses
  // allow run.
  ASSERT_EQ(line.steps().size(), 60u);
  EXPECT_TRUE(line.steps()[4].T_world_tool[1].has_value());
  EXPECT_FALSE(line.steps()[5].T_world_tool[1].has_value());
}

TEST(LockstepClock, TheOrderOfArrivalDoesNotMatter) {
  struct Message {
    int tool;
    double stamp_s, x;
  };
  std::vector<Message> first, second;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 200; ++i) first.push_back({0, 50 + 0.011 * i, unit(random)});
  for (int i = 0; i < 150; ++i) second.push_back({1, 50.003 + 0.013 * i, unit(random)});
  std::vector<LockstepInput> expected;
  for (int run = 0; run < 20; ++run) {
    // Each tool's messages stay in order; how those of the two mix, and when steps are looked for, is random.
    // None lags by more than the timeout.
    Line line(2);
    std::size_t i = 0, j = 0;
    while (i < first.size() || j < second.size()) {
      const double lead =
          (i < first.size() ? first[i].stamp_s : 1e9) - (j < second.size() ? second[j].stamp_s : 1e9);
      const bool take_first =
          j == second.size() || (i < first.size() && (lead < -0.2 || (lead < 0.2 && unit(random) < 0.5)));
      const Message& message = take_first ? first[i++] : second[j++];
      line.add(message.tool, message.stamp_s, message.x);
      if (unit(random) < 0.3) line.run();
    }
    line.run();
    if (run == 0) expected = line.steps();
    EXPECT_GT(line.steps().size(), 190u);
    EXPECT_TRUE(same(line.steps(), expected)) << "run " << run;
  }
}

TEST(LockstepClock, PlaysEachLoopOfABagToItsEnd) {
  Line line(2);
  for (int loop = 0; loop < 3; ++loop) {
    for (int i = 0; i <= 300; ++i) {
      line.add(0, 20 + 0.01 * i, i);
      line.add(1, 20.005 + 0.01 * i, i);
    }
    if (loop == 1) line.run();  // late: two loops have come in by then
  }
  line.run();
  ASSERT_GE(line.steps().size(), 900u);
  // Each loop: t_0 = 20, then steps to 23.00 (both tools' last poses are at 23.000 and 23.005).
  EXPECT_EQ(line.steps()[0].stamp, ros::Time(20.01));
  EXPECT_EQ(line.steps()[299].stamp, ros::Time(23.0));
  EXPECT_EQ(line.steps()[300].stamp, ros::Time(20.01));
  for (std::size_t i = 0; i < 300; ++i) {
    ASSERT_EQ(line.steps()[i].T_world_tool[0].has_value(), line.steps()[300 + i].T_world_tool[0].has_value());
    if (line.steps()[i].T_world_tool[0]) {
      EXPECT_EQ(line.steps()[i].T_world_tool[0]->matrix(), line.steps()[300 + i].T_world_tool[0]->matrix());
    }
  }
}

TEST(LockstepClock, LongSilenceOfAllIsSkipped) {
  Line line(1);
  line.add(0, 100, 0);
  line.add(0, 100.02, 0);
  line.add(0, 4000, 0);
  line.add(0, 4000.03, 0);
  line.run();
  ASSERT_EQ(line.steps().size(), 5u);
  EXPECT_EQ(line.steps()[2].stamp, ros::Time(4000.01));
}

TEST(LockstepClock, ShortSilenceIsSimulatedWithoutTheTool) {
  Line line(1);
  line.add(0, 100, 0);
  line.add(0, 102, 0);
  line.run();
  ASSERT_EQ(line.steps().size(), 200u);
  EXPECT_FALSE(line.steps()[100].T_world_tool[0].has_value());
  EXPECT_TRUE(line.steps()[199].T_world_tool[0].has_value());
}

TEST(LockstepClock, TimeStepsDoNotAddUpRounding) {
  StampClock clock(1, 1, 60);
  TransformTree transforms("world", 1);
  std::vector<ToolTracker> trackers;
  trackers.emplace_back(0, "tool", 5, 0.2, clock, transforms);
  LockstepClock lockstep(1.0 / 3, 5);
  for (int i = 0; i <= 1000; ++i) trackers[0].add(poseAt(1 + i, 0), ros::Time(1 + i));
  trackers[0].resolveByStamps();
  ros::Time last;
  int steps = 0;
  while (const std::optional<LockstepInput> input = lockstep.next(trackers, clock)) {
    last = input->stamp;
    ++steps;
  }
  EXPECT_EQ(steps, 3000);
  EXPECT_EQ(last, ros::Time(1001));
}

TEST(StampClock, TellsBackFromJumps) {
  StampClock clock(2, 1, 60);
  const auto judge = [&](int tool, double stamp_s) { return clock.judge(tool, toNanoseconds(stamp_s)); };
  EXPECT_EQ(judge(0, 10), StampVerdict::kFollows);
  EXPECT_EQ(judge(0, 10), StampVerdict::kBack);
  EXPECT_EQ(judge(0, 12), StampVerdict::kFollows);
  EXPECT_EQ(judge(0, 11), StampVerdict::kBack) << "exactly clock_jump_s back";
  EXPECT_EQ(judge(1, 9), StampVerdict::kFollows) << "another tool's stamps are its own";
  EXPECT_EQ(judge(0, 72), StampVerdict::kFollows) << "exactly longest_gap_s ahead";
  EXPECT_EQ(judge(0, 70.9), StampVerdict::kJump);
  EXPECT_EQ(clock.latestEpoch(), 1);
  EXPECT_EQ(clock.epoch(1), 0);
  EXPECT_EQ(judge(0, 131), StampVerdict::kJump) << "more than longest_gap_s ahead";
}

TEST(StampClock, KeepsLateMessagesInTheirEpoch) {
  StampClock clock(2, 1, 60);
  const auto judge = [&](int tool, double stamp_s) { return clock.judge(tool, toNanoseconds(stamp_s)); };
  judge(0, 20);
  judge(1, 20);
  judge(0, 30);
  judge(0, 20);  // the bag loops; the second tool's last messages are still under way
  EXPECT_EQ(judge(1, 29.9), StampVerdict::kFollows);
  EXPECT_EQ(clock.epoch(1), 0);
  EXPECT_EQ(judge(1, 20.1), StampVerdict::kJump);
  EXPECT_EQ(clock.epoch(1), 1);
  EXPECT_EQ(clock.latestEpoch(), 1) << "the same loop, not another";
}

}  // namespace
}  // namespace polyscalpel
