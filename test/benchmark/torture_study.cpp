// SPDX-License-Identifier: BSD-3-Clause
//
// Random cuts of every kind over several bodies, counted.
#include <algorithm>

#include "benchmark/report.hpp"
#include "support/torture.hpp"

namespace polyscalpel::report {
namespace {

constexpr int kCutsPerBody = 25;
constexpr int kCutsPerBunny = 10;  // each costs as much as all of a small body

/// Sum over all kinds, one row a mesh.
TortureRow sumOf(const std::vector<TortureRow>& rows) {
  TortureRow sum = rows.front();
  sum.kind = "all";
  for (std::size_t i = 1; i < rows.size(); ++i) addTortureRow(rows[i], sum);
  return sum;
}

Row toRow(const TortureRow& counted) {
  Row row;
  row["mesh"] = counted.mesh;
  row["kind"] = counted.kind;
  row["cuts"] = counted.cuts;
  row["splits"] = counted.splits;
  row["left_whole"] = counted.left_whole;
  row["invalid"] = counted.invalid;
  row["pieces_missing"] = counted.pieces_missing;
  row["pieces_torn"] = counted.pieces_torn;
  row["volume_error"] = counted.volume_error;
  row["shortest_edge"] = counted.shortest_edge;
  holdEqual(row, "invalid", 0);
  if (counted.kind == "all") {
    row["left_whole_per_split"] =
        counted.splits > 0 ? static_cast<double>(counted.left_whole) / counted.splits : 0;
    holdAtMost(row, "volume_error", 1e-12);
  }
  return row;
}

}  // namespace

Rows studyTorture(const Context& context) {
  const std::vector<TortureSubject> subjects = tortureSubjects(TortureSize::kUsual, context.bunny_mesh);
  const int cuts = context.byMode(200, 2000, 10000);
  context.progress->beginSection("torture", static_cast<int>(subjects.size()));
  Rows rows;
  for (const TortureSubject& subject : subjects) {
    context.progress->beginTask(subject.name);
    const bool is_bunny = subject.name == "bunny";
    TorturePlan plan;
    // The bunny gets one cut in forty, the others the rest in equal parts.
    plan.cuts_per_body = is_bunny ? kCutsPerBunny : kCutsPerBody;
    plan.bodies = is_bunny ? std::max(1, cuts / 40 / kCutsPerBunny) : std::max(1, cuts / 3 / kCutsPerBody);
    std::vector<TortureFailure> failures;
    const std::vector<TortureRow> counted = torture(subject, plan, failures);
    rows.push_back(toRow(sumOf(counted)));
    for (const TortureRow& row : counted) rows.push_back(toRow(row));
  }
  return rows;
}

}  // namespace polyscalpel::report
