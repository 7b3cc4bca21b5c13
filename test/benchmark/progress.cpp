// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace polyscalpel::report {

Progress::Progress(int num_sections)
    : is_terminal_(isatty(STDERR_FILENO) == 1), num_sections_(num_sections) {}

void Progress::beginSection(const std::string& name, int num_tasks) {
  ++section_;
  section_name_ = name;
  num_tasks_ = std::max(num_tasks, 1);
  task_ = 0;
}

void Progress::beginTask(const std::string& name) {
  ++task_;
  const double in_section = std::min(1.0, (task_ - 1.0) / num_tasks_);
  draw(section_name_ + ": " + name, (section_ - 1 + in_section) / num_sections_);
}

void Progress::finish() {
  draw("done", 1);
  if (is_terminal_) std::fputc('\n', stderr);
}

void Progress::draw(const std::string& text, double done) const {
  const auto elapsed = std::chrono::steady_clock::now() - start_;
  const int seconds = static_cast<int>(std::chrono::duration_cast<std::chrono::seconds>(elapsed).count());
  char clock[32];
  std::snprintf(clock, sizeof clock, "%2d:%02d", seconds / 60, seconds % 60);
  if (!is_terminal_) {
    std::fprintf(stderr, "%s %3.0f %% %s\n", clock, 100 * done, text.c_str());
    return;
  }
  constexpr int kWidth = 24;
  const int filled = static_cast<int>(kWidth * done);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  // Back to the line's start, and what an earlier, longer text left is erased.
  std::fprintf(stderr, "\r%s [%s] %s\033[K", clock, bar.c_str(), text.substr(0, 70).c_str());
  std::fflush(stderr);
}

}  // namespace polyscalpel::report
