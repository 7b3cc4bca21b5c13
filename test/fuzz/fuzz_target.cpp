// SPDX-License-Identifier: BSD-3-Clause
//
// What libFuzzer calls. Run: cut_fuzzer -max_total_time=3600 <folder for new inputs> test/fuzz/corpus
#include <cstdio>
#include <cstdlib>

#include "fuzz/cut_fuzzer.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string wrong = polyscalpel::cutFromBytes(data, size);
  if (!wrong.empty()) {
    std::fprintf(stderr, "%s\n", wrong.c_str());
    std::abort();
  }
  return 0;
}
