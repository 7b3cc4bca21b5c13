// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/timing.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>

namespace polyscalpel::report {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

double threadSeconds() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double secondsOf(const std::function<void()>& task) {
  const double start = wallSeconds();
  task();
  return wallSeconds() - start;
}

std::vector<double> medianSeconds(const std::vector<std::function<void()>>& tasks, int rounds) {
  std::vector<std::vector<double>> times(tasks.size());
  for (int round = 0; round <= rounds; ++round) {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      const double time = secondsOf(tasks[i]);
      if (round > 0) times[i].push_back(time);
    }
  }
  std::vector<double> medians;
  for (const std::vector<double>& of_task : times) medians.push_back(median(of_task));
  return medians;
}

}  // namespace polyscalpel::report
