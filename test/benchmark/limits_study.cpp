// SPDX-License-Identifier: BSD-3-Clause
//
// How far the stages of a step are from what memory traffic alone would let them take.
#include <list>

#include "benchmark/bandwidth.hpp"
#include "benchmark/report.hpp"
#include "benchmark/step_stages.hpp"
#include "benchmark/timing.hpp"

namespace polyscalpel::report {
namespace {

/// A bound that is beaten twofold is a wrong bound.
constexpr double kLeastRatio = 0.5;

/// Work of the thread for one run [s], with what the runs before have left in the caches.
double warmSeconds(const std::function<void()>& run) {
  constexpr int kRuns = 3;
  run();
  const double start = threadSeconds();
  for (int i = 0; i < kRuns; ++i) run();
  return (threadSeconds() - start) / kRuns;
}

struct MeasuredStage {
  const StageSubject* subject = nullptr;
  const BentBody* bent = nullptr;
  StepStage stage;
  StageTraffic traffic;
  ReadArray array;  // as large as what the stage has to hold
  std::vector<double> stage_s = {}, read_s = {};
};

Row describe(const MeasuredStage& measured, double memory_bytes_per_s) {
  const StageTraffic& traffic = measured.traffic;
  const double time_s = median(measured.stage_s);
  const double bytes_per_s = static_cast<double>(measured.array.bytes()) / median(measured.read_s);
  const double bound_s = traffic.moved_bytes / bytes_per_s;
  Row row;
  row["subject"] = measured.subject->name;
  row["body"] = measured.bent->body.name;
  row["cells"] = measured.bent->body.mesh.numCells();
  row["stage"] = measured.stage.name;
  row["item"] = traffic.item;
  row["items"] = traffic.items;
  row["least_mb"] = 1e-6 * traffic.moved_bytes;
  row["held_mb"] = 1e-6 * traffic.held_bytes;
  row["bandwidth_gb_s"] = 1e-9 * bytes_per_s;
  row["bound_ms"] = 1e3 * bound_s;
  row["time_ms"] = 1e3 * time_s;
  row["ratio"] = time_s / bound_s;
  row["memory_bound_ms"] = 1e3 * traffic.moved_bytes / memory_bytes_per_s;
  holdAtLeast(row, "ratio", kLeastRatio);
  return row;
}

}  // namespace

Rows studyLimits(const Context& context) {
  const int rounds = context.byMode(7, 21, 51);
  // Beside those that the generator makes, cells of all kinds.
  constexpr int kHalfCutBall = 4, kCuts = 9;
  std::vector<StageSubject> subjects = stageSubjects();
  subjects.push_back({"cut_ball", "aggregates", [] { return makeCutStepBall(kHalfCutBall, kCuts); }});
  context.progress->beginSection("limits", static_cast<int>(subjects.size()) + 1);

  std::list<StepBody> bodies;
  std::list<BentBody> bent;
  std::vector<MeasuredStage> stages;
  for (const StageSubject& subject : subjects) {
    context.progress->beginTask(subject.name);
    bodies.push_back(subject.make());
    bent.emplace_back(bodies.back());
    for (StepStage& stage : stepStages(subject.preconditioner, bent.back())) {
      const StageTraffic traffic = stage.traffic();
      ReadArray array(static_cast<std::size_t>(traffic.held_bytes));
      stages.push_back({&subject, &bent.back(), std::move(stage), traffic, std::move(array)});
    }
  }
  context.progress->beginTask("rounds");
  Triad triad;
  std::vector<double> triad_s;
  triad.run();
  for (int round = 0; round < rounds; ++round) {
    for (MeasuredStage& measured : stages) {
      measured.stage_s.push_back(warmSeconds(measured.stage.run));
      measured.read_s.push_back(warmSeconds([&] { measured.array.read(); }));
    }
    const double start = threadSeconds();
    triad.run();
    triad_s.push_back(threadSeconds() - start);
  }

  const double memory_bytes_per_s = triad.movedBytes() / median(triad_s);
  Rows rows;
  for (const MeasuredStage& measured : stages) rows.push_back(describe(measured, memory_bytes_per_s));
  Row row;
  row["body"] = "three arrays in memory";
  row["stage"] = "triad";
  row["held_mb"] = 1e-6 * triad.movedBytes();
  row["bandwidth_gb_s"] = 1e-9 * memory_bytes_per_s;
  rows.push_back(std::move(row));
  return rows;
}

}  // namespace polyscalpel::report
