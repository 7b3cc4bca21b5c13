// SPDX-License-Identifier: BSD-3-Clause
//
// The table of hard cases: what happens in each, and the limit where it stops holding. The tests run a short
// form of each row, the report the full one.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace polyscalpel {

/// A row of the table.
struct HardCase {
  std::string name;
  std::string what_happens;  ///< one plain sentence with the figures
  std::string limit;         ///< where it stops holding
  std::string quantity;      ///< what value is, with its unit
  double value = 0;
  double bound = 0;
  bool held = false;  ///< value <= bound, and as_said
  /// Whether all else that the row says was found so: every step solved, everything finite, no cell inverted.
  /// True in a row where we lose as well; false where anything was thrown.
  bool as_said = false;
  /// False in a row where we lose: it then says what happens instead.
  bool expected_to_hold = true;
};

enum class Extent {
  kShort,  ///< seconds for the whole table; limits as given, not measured
  kFull,   ///< minutes for the whole table; limits measured
};

/// A row before it has been run.
struct HardCaseEntry {
  std::string name;
  std::function<HardCase(Extent)> run;  ///< throws nothing: an exception is a row that did not hold
};

/// Every row, in the order of the table.
std::vector<HardCaseEntry> hardCaseEntries();

/// Runs every row. progress: called with each row as it ends; may be empty.
std::vector<HardCase> runHardCases(Extent extent, const std::function<void(const HardCase&)>& progress);

}  // namespace polyscalpel
