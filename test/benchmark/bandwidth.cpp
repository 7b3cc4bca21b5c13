// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/bandwidth.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
// As the stages' kernels do, by the widest registers that this processor has.
#define POLYSCALPEL_BY_PROCESSOR __attribute__((target_clones("avx2", "default")))
#else
#define POLYSCALPEL_BY_PROCESSOR
#endif

namespace polyscalpel::report {
namespace {

/// Where results go, so that nothing is left out.
volatile std::uint64_t sink = 0;

POLYSCALPEL_BY_PROCESSOR
void sumLines(const Line* lines, std::size_t count, std::uint64_t* sum) {
  // Several sums, so that none waits for the addition before it.
  Line even = {}, odd = {};
  std::size_t i = 0;
  for (; i + 2 <= count; i += 2) {
    even.low += lines[i].low;
    even.high += lines[i].high;
    odd.low += lines[i + 1].low;
    odd.high += lines[i + 1].high;
  }
  if (i < count) {
    even.low += lines[i].low;
    even.high += lines[i].high;
  }
  const auto all = (even.low + odd.low) + (even.high + odd.high);
  *sum = all[0] + all[1] + all[2] + all[3];
}

POLYSCALPEL_BY_PROCESSOR
void addScaled(double* a, const double* b, const double* c, std::size_t size) {
  constexpr double kScale = 3;
  for (std::size_t i = 0; i < size; ++i) a[i] = b[i] + kScale * c[i];
}

constexpr std::size_t kTriadSize = (std::size_t{128} << 20) / sizeof(double);

}  // namespace

ReadArray::ReadArray(std::size_t bytes) : lines_((bytes + sizeof(Line) - 1) / sizeof(Line), Line{}) {}

void ReadArray::read() {
  std::uint64_t sum = 0;
  sumLines(lines_.data(), lines_.size(), &sum);
  sink = sum;
}

Triad::Triad() : a_(kTriadSize, 0.0), b_(a_.size(), 1.0), c_(a_.size(), 2.0) {}

void Triad::run() {
  addScaled(a_.data(), b_.data(), c_.data(), a_.size());
  sink = static_cast<std::uint64_t>(a_.back());
}

}  // namespace polyscalpel::report
