// SPDX-License-Identifier: BSD-3-Clause
#include "support/hard_cases.hpp"

#include <cctype>
#include <set>

#include <gtest/gtest.h>

namespace polyscalpel {
namespace {

class HardCasesTest : public testing::TestWithParam<HardCaseEntry> {};

// The short form of each row. Where we lose, what happens instead has to be what the row says: losing in
// another way, or not losing any more, fails as well.
TEST_P(HardCasesTest, IsAsTheTableSays) {
  const HardCase row = GetParam().run(Extent::kShort);
  EXPECT_TRUE(row.as_said) << row.what_happens;
  EXPECT_EQ(row.held, row.expected_to_hold)
      << row.quantity << ": " << row.value << ", bound " << row.bound << "\n"
      << row.what_happens << "\n"
      << row.limit;
  EXPECT_GT(row.bound, 0);
  for (const std::string& text : {row.what_happens, row.limit, row.quantity}) EXPECT_FALSE(text.empty());
}

std::string nameOf(const testing::TestParamInfo<HardCaseEntry>& info) {
  std::string name;
  bool starts_word = true;
  for (const char c : info.param.name) {
    if (std::isalnum(static_cast<unsigned char>(c))) {
      name += static_cast<char>(starts_word ? std::toupper(static_cast<unsigned char>(c)) : c);
    }
    starts_word = c == ' ';
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(Table, HardCasesTest, testing::ValuesIn(hardCaseEntries()), nameOf);

TEST(HardCases, NamesAreDistinct) {
  std::set<std::string> names;
  for (const HardCaseEntry& entry : hardCaseEntries()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
  }
}

}  // namespace
}  // namespace polyscalpel
