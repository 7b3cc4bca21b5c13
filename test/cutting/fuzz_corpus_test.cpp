// SPDX-License-Identifier: BSD-3-Clause
//
// Every input that the fuzzer is started from, and some of random bytes.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fuzz/cut_fuzzer.hpp"

namespace polyscalpel {
namespace {

TEST(FuzzCorpus, EveryInputLeavesAValidMesh) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(POLYSCALPEL_FUZZ_CORPUS)) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
    EXPECT_EQ(cutFromBytes(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), "")
        << entry.path();
    ++count;
  }
  EXPECT_GE(count, 8);
}

TEST(FuzzCorpus, RandomBytesLeaveAValidMesh) {
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    std::vector<std::uint8_t> bytes(20 + random() % 150);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    EXPECT_EQ(cutFromBytes(bytes.data(), bytes.size()), "") << "input " << i;
  }
}

TEST(FuzzCorpus, NoBytesAreAnInputToo) {
  EXPECT_EQ(cutFromBytes(nullptr, 0), "");
}

}  // namespace
}  // namespace polyscalpel
