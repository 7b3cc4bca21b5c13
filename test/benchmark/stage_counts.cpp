// SPDX-License-Identifier: BSD-3-Clause
//
// Runs the stages of a step for callgrind, which counts each of them alone: polyscalpel_stage_counts SUBJECT.
// Without an argument it names the subjects. Bodies come from the generator: no cut, since valgrind knows
// only one rounding mode and exact predicates ask for others. `./run report` calls it.
#include <cstdio>
#include <exception>
#include <iostream>
#include <stdexcept>

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#define POLYSCALPEL_HAS_CALLGRIND
#endif

#include "benchmark/step_stages.hpp"

namespace polyscalpel::report {
namespace {

#if defined(POLYSCALPEL_HAS_CALLGRIND)
/// One dump a stage, named like it: of its second run, so that the first one leaves in the caches what the
/// third would find there too.
void countStages(const StageSubject& subject) {
  const StepBody body = subject.make();
  BentBody bent(body);
  for (const StepStage& stage : stepStages(subject.preconditioner, bent)) {
    CALLGRIND_START_INSTRUMENTATION;
    stage.run();
    CALLGRIND_ZERO_STATS;
    stage.run();
    CALLGRIND_DUMP_STATS_AT(stage.name.c_str());
    CALLGRIND_STOP_INSTRUMENTATION;
  }
}
#else
void countStages(const StageSubject&) {
  throw std::runtime_error("built without valgrind's headers");
}
#endif

int run(int argc, char** argv) {
  const std::vector<StageSubject> subjects = stageSubjects();
  if (argc == 1) {
    for (const StageSubject& subject : subjects) std::cout << subject.name << '\n';
    return 0;
  }
  for (const StageSubject& subject : subjects) {
    if (argc != 2 || subject.name != argv[1]) continue;
    countStages(subject);
#if defined(__x86_64__)
    std::cout << (__builtin_cpu_supports("avx2") ? "AVX2" : "SSE2") << '\n';
#else
    std::cout << "the processor's\n";
#endif
    return 0;
  }
  throw std::invalid_argument("must be given one subject's name");
}

}  // namespace
}  // namespace polyscalpel::report

int main(int argc, char** argv) {
  try {
    return polyscalpel::report::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "polyscalpel_stage_counts: " << error.what() << '\n';
    return 2;
  }
}
