// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/report.hpp"
#include "support/hard_cases.hpp"

namespace polyscalpel::report {

Rows studyHardCases(const Context& context) {
  const std::vector<HardCaseEntry> entries = hardCaseEntries();
  context.progress->beginSection("hard cases", static_cast<int>(entries.size()));
  const Extent extent = context.byMode(Extent::kShort, Extent::kFull, Extent::kFull);
  Rows rows;
  for (const HardCaseEntry& entry : entries) {
    context.progress->beginTask(entry.name);
    const HardCase result = entry.run(extent);
    Row row;
    row["case"] = result.name;
    row["what_happens"] = result.what_happens;
    row["limit"] = result.limit;
    row["quantity"] = result.quantity;
    row["value"] = result.value;
    row["bound"] = result.bound;
    row["outcome"] = result.held ? "holds" : result.expected_to_hold ? "BROKEN" : "we lose";
    if (result.expected_to_hold) {
      holdAtMost(row, "value", result.bound);
    }
    if (!result.as_said) holdFailed(row, "it happens as the row says");
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace polyscalpel::report
