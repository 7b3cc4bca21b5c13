// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace polyscalpel {

/// Calls run(first, last) for consecutive chunks of [0, count), each of `chunk` indices but for the last, by
/// at most num_threads threads (OpenMP). run must not depend on the order of the chunks. Chunks are the same
/// for any number of threads: what a chunk sums up is, too.
template <class Run>
void parallelChunks(int count, int chunk, int num_threads, const Run& run) {
  const int num_chunks = (count + chunk - 1) / chunk;
  const auto runChunk = [&](int k) { run(k * chunk, count - k * chunk < chunk ? count : (k + 1) * chunk); };
  if (num_threads <= 1 || num_chunks <= 1) {
    for (int k = 0; k < num_chunks; ++k) runChunk(k);
    return;
  }
#pragma omp parallel for schedule(static) num_threads(num_threads)
  for (int k = 0; k < num_chunks; ++k) runChunk(k);
}

}  // namespace polyscalpel
