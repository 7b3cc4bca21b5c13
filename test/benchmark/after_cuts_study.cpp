// SPDX-License-Identifier: BSD-3-Clause
//
// Steps of a body after many curved cuts: as polyhedra, as the tetrahedra of our own baseline by the same
// stepper, and as those by a stepper that factors in every step.
#include <algorithm>

#include "benchmark/held_tetrahedra.hpp"
#include "benchmark/report.hpp"
#include "benchmark/step_rows.hpp"

namespace polyscalpel::report {
namespace {

StepBody stepBody(const std::string& name, const CutBody& cut, PolyhedralMesh mesh, std::vector<bool> fixed) {
  StepBody body;
  body.name = name;
  body.mesh = std::move(mesh);
  body.fixed = std::move(fixed);
  body.material = cut.material;
  body.gravity_m_s2 = cut.gravity_m_s2;
  body.consistent_mass = false;
  return body;
}

/// The same without a hand on what the foot does not hold.
CutBody withLoosePiecesFalling(CutBody cut) {
  cut.name += ", loose pieces fall";
  cut.loose_pieces = 0;
  for (int i = 0; i < cut.mesh.numVertices(); ++i)
    cut.fixed[i] = cut.mesh.restPosition(VertexId(i)).z() <= cut.foot_z_m;
  return cut;
}

Rows studyCutBody(const CutBody& cut, const Context& context) {
  const Tetrahedra fewest = retessellate(cut.mesh, Retessellation::kFewest);
  std::vector<bool> held = heldPoints(cut, fewest);
  PolyhedralMesh tetrahedra = toHeldMesh(fewest, held);
  const StepBody polyhedra = stepBody("polyhedra", cut, cut.mesh, cut.fixed);
  const StepBody baseline = stepBody("tetrahedra, fewest", cut, std::move(tetrahedra), std::move(held));

  constexpr int kSteps = kGateSteps[1];
  const int rounds = context.byMode(1, 3, 5);
  const GateAnswers of_polyhedra = gateAnswers(polyhedra, kSteps),
                    of_baseline = gateAnswers(baseline, kSteps);
  std::vector<StepEntry> entries = {{&polyhedra, ours("auto"), kSteps, rounds, of_polyhedra},
                                    {&polyhedra, ours("auto", 2), kSteps, rounds, of_polyhedra},
                                    {&baseline, ours("auto"), kSteps, rounds, of_baseline},
                                    {&baseline, ours("direct"), kSteps, 1, of_baseline}};
  runInTurns(entries);
  Rows rows;
  for (const StepEntry& entry : entries) {
    const Row steps = describeSteps(entry);
    Row row;
    row["body"] = cut.name;
    row["method"] = entry.body->name;
    row["cuts"] = cut.cuts;
    row["cells_before"] = cut.cells_before;
    row["pieces"] = cut.pieces;
    row["loose_pieces"] = cut.loose_pieces;
    for (const auto& [key, value] : steps.items())
      if (key != "body") row[key] = value;
    holdAtMost(row, "gate_error", 1e-4);
    if (row.contains("step_ms")) row["steps_per_s"] = 1e3 / row["step_ms"].get<double>();
    if (!rows.empty() && row.contains("step_ms") && rows.front().contains("step_ms")) {
      const auto times = [&](const char* key) {
        return row[key].get<double>() / rows.front()[key].get<double>();
      };
      row["times_cells"] = times("cells");
      row["times_unknowns"] = times("unknowns");
      row["times_step"] = times("step_ms");
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Rows studyAfterCuts(const Context& context) {
  const int cuts = context.byMode(5, 17, 17), half_count = context.byMode(3, 6, 6);
  const bool has_bunny = !context.bunny_mesh.empty() && context.mode == Mode::kFull;
  context.progress->beginSection("after cuts", has_bunny ? 2 : 1);
  const auto study = [&](const CutBody& cut) {
    Rows both = studyCutBody(cut, context);
    const Rows falling = studyCutBody(withLoosePiecesFalling(cut), context);
    both.insert(both.end(), falling.begin(), falling.end());
    return both;
  };
  context.progress->beginTask("ball");
  Rows rows = study(makeHairpinCutBall(half_count, cuts, kHairpinsInBall));
  if (has_bunny) {
    context.progress->beginTask("bunny");
    const Rows more = study(makeHairpinCutFile("bunny", context.bunny_mesh, cuts, kHairpinsInBunny));
    rows.insert(rows.end(), more.begin(), more.end());
  }
  return rows;
}

}  // namespace polyscalpel::report
