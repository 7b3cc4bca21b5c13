// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

namespace polyscalpel::report {

/// Tells on stderr how far the report is: a bar that is drawn anew in place on a terminal, elsewhere one line
/// a task.
class Progress {
 public:
  explicit Progress(int num_sections);

  /// The next section, of so many tasks.
  void beginSection(const std::string& name, int num_tasks);
  /// The next task of the section begins.
  void beginTask(const std::string& name);
  /// Everything is done.
  void finish();

 private:
  void draw(const std::string& text, double done) const;

  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  bool is_terminal_ = false;
  int num_sections_ = 1;
  int section_ = 0;  // counted from 1
  int num_tasks_ = 1;
  int task_ = 0;  // counted from 1
  std::string section_name_;
};

}  // namespace polyscalpel::report
