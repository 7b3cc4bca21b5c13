// SPDX-License-Identifier: BSD-3-Clause
//
// What one thread of this machine moves through memory, to hold the stages of a step against.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace polyscalpel::report {

/// A line of a cache, in parts of the size of a register: of larger ones GCC keeps sums in memory.
struct alignas(64) Line {
  std::uint64_t __attribute__((vector_size(32))) low, high;
};

/// An array to read from end to end: where it fits a cache, it comes from there the next time.
class ReadArray {
 public:
  /// bytes: rounded up to whole lines of 64.
  explicit ReadArray(std::size_t bytes);
  std::size_t bytes() const { return lines_.size() * sizeof(Line); }
  /// Reads all of it, once.
  void read();

 private:
  std::vector<Line> lines_;
};

/// Three arrays of 128 MB, more than a core's caches hold: a_i = b_i + s c_i.
class Triad {
 public:
  Triad();
  /// What a run moves as STREAM counts it (J. D. McCalpin, "Memory Bandwidth and Machine Balance in Current
  /// High Performance Computers", 1995): without reading the lines of `a` before they are written.
  double movedBytes() const { return 3.0 * sizeof(double) * static_cast<double>(a_.size()); }
  void run();

 private:
  std::vector<double> a_, b_, c_;
};

}  // namespace polyscalpel::report
