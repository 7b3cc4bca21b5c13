// SPDX-License-Identifier: BSD-3-Clause
//
// How many cells many curved cuts leave, and how many tetrahedra the same cuts would have left.
#include <array>
#include <cmath>
#include <exception>
#include <functional>

#include "benchmark/cut_bodies.hpp"
#include "benchmark/report.hpp"
#include "benchmark/retessellation.hpp"

namespace polyscalpel::report {
namespace {

/// Cells with more vertices are counted together.
constexpr std::size_t kMostVertices = 12;

void addHistogram(const PolyhedralMesh& mesh, Row& row) {
  std::array<int, kMostVertices + 2> counts = {};
  for (const CellId id : mesh.cells()) ++counts[std::min(mesh.cell(id).vertices.size(), kMostVertices + 1)];
  for (std::size_t n = 4; n <= kMostVertices; ++n)
    row["cells_of_" + std::to_string(n) + "_vertices"] = counts[n];
  row["cells_of_more_vertices"] = counts[kMostVertices + 1];
}

Row countCells(const CutBody& body, const std::string& cuts) {
  Row row;
  const int cells = body.mesh.numCells();
  row["body"] = body.name;
  row["blades"] = cuts;
  row["cuts"] = body.cuts;
  row["cells_before"] = body.cells_before;
  row["cells"] = cells;
  int tetrahedra = 0;
  for (const CellId id : body.mesh.cells()) tetrahedra += body.mesh.cell(id).vertices.size() == 4;
  row["part_of_tetrahedra"] = static_cast<double>(tetrahedra) / cells;
  for (const auto& [rule, name] :
       {std::pair(Retessellation::kFewest, "fewest"), std::pair(Retessellation::kMiddles, "with_middles")}) {
    const auto count = static_cast<double>(retessellate(body.mesh, rule).cells.size());
    row[std::string("tetrahedra_") + name] = count;
    row[std::string("times_") + name] = count / cells;
  }
  addHistogram(body.mesh, row);
  row["pieces"] = body.pieces;
  row["cells_left_whole"] = body.cells_left_whole;
  row["cutting_ms_per_cut"] = 1e3 * body.cutting_s / body.cuts;
  row["volume_error"] = std::abs(body.volume_error);
  row["mesh_violations"] = body.violations;
  holdEqual(row, "mesh_violations", 0);
  return row;
}

}  // namespace

Rows studyCellCounts(const Context& context) {
  const int cuts = context.byMode(5, 17, 17), half_count = context.byMode(3, 6, 6);
  const std::string& bunny = context.bunny_mesh;
  struct Subject {
    std::string body, blades;
    std::function<CutBody()> make;
  };
  const std::string hairpin = "bent like hairpins, of ";
  std::vector<Subject> subjects = {{"ball", "bowed", [&] { return makeCutBall(half_count, cuts); }},
                                   {"ball", hairpin + std::to_string(kHairpinsInBall.legs) + " legs",
                                    [&] { return makeHairpinCutBall(half_count, cuts, kHairpinsInBall); }}};
  if (!bunny.empty()) {
    const int bunny_cuts = context.byMode(2, 17, 17);
    subjects.push_back(
        {"bunny", "bowed", [&, bunny_cuts] { return makeCutFile("bunny", bunny, bunny_cuts); }});
    subjects.push_back({"bunny", hairpin + std::to_string(kHairpinsInBunny.legs) + " legs", [&, bunny_cuts] {
                          return makeHairpinCutFile("bunny", bunny, bunny_cuts, kHairpinsInBunny);
                        }});
  }
  context.progress->beginSection("cell counts", static_cast<int>(subjects.size()));
  Rows rows;
  for (const Subject& subject : subjects) {
    context.progress->beginTask(subject.body + ", " + subject.blades);
    try {
      rows.push_back(countCells(subject.make(), subject.blades));
    } catch (const std::exception& error) {  // the other bodies' rows are not lost
      Row row;
      row["body"] = subject.body;
      row["blades"] = subject.blades;
      holdFailed(row, error.what());
      rows.push_back(row);
    }
  }
  if (bunny.empty()) {
    Row row;
    row["body"] = "bunny";
    row["blades"] = "not measured: " + context.bunny_note;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace polyscalpel::report
