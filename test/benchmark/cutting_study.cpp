// SPDX-License-Identifier: BSD-3-Clause
//
// The same cut body as polyhedra and as tetrahedra.
#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>

#include "benchmark/cut_bodies.hpp"
#include "benchmark/fine_reference.hpp"
#include "benchmark/held_tetrahedra.hpp"
#include "benchmark/report.hpp"
#include "benchmark/spectrum.hpp"
#include "benchmark/timing.hpp"
#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/static_solution.hpp"
#include "polyscalpel/simulation/time_integration.hpp"

namespace polyscalpel::report {
namespace {

/// One way to go on with a cut body.
struct Variant {
  std::string name;
  PolyhedralMesh mesh;
  std::vector<bool> fixed;
  Row row = Row::object();
  // For the timing of steps.
  std::unique_ptr<Assembly> assembly;
  std::unique_ptr<ImplicitEuler> integrator;
  SimulationState state;
};

double volumeOf(const PolyhedralMesh& mesh) {
  return volume(mesh, mesh.restPositions());
}

double sagOf(const PolyhedralMesh& mesh, const std::vector<bool>& fixed, const CutBody& body, Row& row) {
  ElementConfig config;
  config.strain = Strain::kLinear;
  Assembly assembly(mesh, body.material, config, 0);
  const Eigen::Matrix3Xd forces = body.gravity_m_s2 * assembly.vertexMasses().transpose();
  const StaticSolution solution = solveStatic(mesh, assembly, fixed, forces);
  if (solution.status != SolveStatus::kSolved) holdFailed(row, "static sag: " + solution.message);
  return meanSag(solution.displacements, assembly.vertexMasses(), fixed, body.gravity_m_s2);
}

/// The finest sag to measure the others against [m].
double findReference(const CutBody& body, const Context& context, const Tetrahedra& fewest, Row& row) {
  if (body.name == "block") {
    const CutBody fine = makeCutBlock(context.byMode(12, 24, 24));
    row["reference"] = std::to_string(fine.mesh.numCells()) + " hexahedra with the cuts along their faces";
    return sagOf(fine.mesh, fine.fixed, fine, row);
  }
  const SagReference reference =
      findSagReference(fewest, heldPoints(body, fewest), body.material, body.gravity_m_s2);
  if (!reference.message.empty()) holdFailed(row, "reference: " + reference.message);
  row["reference"] =
      "the fewest tetrahedra, each divided into eight: " + std::to_string(reference.fine_cells);
  return reference.fine_sag_m;
}

void addSpectra(Variant& variant, const CutBody& body, double floor_kg) {
  ElementConfig config;
  config.strain = Strain::kLinear;
  Assembly assembly(variant.mesh, body.material, config, 0);
  assembly.lineariseAtRest();
  Blocks stiffness;
  assembly.assemble(0, 1, stiffness);
  const Spectrum plain = findSpectrum(assembly.pattern(), stiffness, assembly.vertexMasses(), variant.fixed);
  const Spectrum floored =
      findSpectrum(assembly.pattern(), stiffness, assembly.vertexMasses().cwiseMax(floor_kg), variant.fixed);
  if (!plain.message.empty()) holdFailed(variant.row, "spectrum: " + plain.message);
  variant.row["condition"] = plain.condition;
  variant.row["stable_step_s"] = plain.stable_step_s;
  variant.row["stable_step_with_mass_floor_s"] = floored.stable_step_s;
}

void timeSteps(std::vector<Variant>& variants, const CutBody& body, int rounds) {
  IntegrationConfig integration;
  integration.gravity_m_s2 = body.gravity_m_s2;
  std::vector<std::function<void()>> tasks;
  for (Variant& variant : variants) {
    variant.assembly = std::make_unique<Assembly>(variant.mesh, body.material, ElementConfig(), 0);
    variant.integrator = std::make_unique<ImplicitEuler>(integration);
    variant.state = {variant.mesh.restPositions(),
                     Eigen::Matrix3Xd::Zero(3, variant.mesh.numVertices()),
                     variant.fixed,
                     {}};
    tasks.push_back([&variant] {
      const IntegrationResult result = variant.integrator->step(variant.state, *variant.assembly, {});
      if (result.status != SolveStatus::kSolved) holdFailed(variant.row, toString(result.status));
    });
  }
  const std::vector<double> times = medianSeconds(tasks, rounds);
  for (std::size_t i = 0; i < variants.size(); ++i) variants[i].row["step_ms"] = 1e3 * times[i];
}

Rows studyBody(const CutBody& body, const Context& context) {
  Progress& progress = *context.progress;
  const std::vector<std::pair<Retessellation, std::string>> rules = {
      {Retessellation::kFewest, "tetrahedra, fewest"},
      {Retessellation::kMiddles, "tetrahedra, with middles"}};
  std::vector<Variant> variants(1);
  variants[0].name = "polyhedra";
  variants[0].mesh = body.mesh;
  variants[0].fixed = body.fixed;
  Tetrahedra fewest;
  for (const auto& [rule, name] : rules) {
    Variant& variant = variants.emplace_back();
    variant.name = name;
    Tetrahedra tetrahedra;
    const double seconds = secondsOf([&, rule = rule] { tetrahedra = retessellate(body.mesh, rule); });
    variant.fixed = heldPoints(body, tetrahedra);
    variant.mesh = toHeldMesh(tetrahedra, variant.fixed);
    variant.row["retessellation_ms"] = 1e3 * seconds;
    if (rule == Retessellation::kFewest) fewest = std::move(tetrahedra);
  }
  progress.beginTask(body.name + ", reference");
  Row reference_row = Row::object();
  const double reference_sag = findReference(body, context, fewest, reference_row);

  for (Variant& variant : variants) {
    progress.beginTask(body.name + ", " + variant.name);
    Row values = Row::object();
    values["body"] = body.name;
    values["method"] = variant.name;
    values["cuts"] = body.cuts;
    values["cells_before"] = body.cells_before;
    values["cells"] = variant.mesh.numCells();
    values["unknowns"] = 3 * static_cast<int>(std::count(variant.fixed.begin(), variant.fixed.end(), false));
    int tetrahedra = 0;
    for (const CellId id : variant.mesh.cells()) tetrahedra += variant.mesh.cell(id).vertices.size() == 4;
    values["part_of_tetrahedra"] = static_cast<double>(tetrahedra) / variant.mesh.numCells();
    values["pieces"] = body.pieces;
    values["loose_pieces"] = body.loose_pieces;
    values["cells_left_whole"] = body.cells_left_whole;
    values["cutting_ms_per_cut"] = 1e3 * body.cutting_s / body.cuts;
    values.update(variant.row);
    values.update(reference_row);
    variant.row = std::move(values);
    const double sag = sagOf(variant.mesh, variant.fixed, body, variant.row);
    variant.row["sag_m"] = sag;
    variant.row["reference_sag_m"] = reference_sag;
    variant.row["sag_error"] = sag / reference_sag - 1;
    addSpectra(variant, body, body.mass_floor_kg);
    if (variant.name == "polyhedra") {
      variant.row["mesh_violations"] = body.violations;
      variant.row["volume_error"] = std::abs(body.volume_error);
      holdEqual(variant.row, "mesh_violations", 0);
      holdAtMost(variant.row, "volume_error", 1e-3);
      if (body.name == "block") holdEqual(variant.row, "cells", 60);
    } else {
      // Bent faces alone make a difference: diagonals bend them otherwise than a fan does.
      variant.row["volume_against_polyhedra"] = std::abs(volumeOf(variant.mesh) / volumeOf(body.mesh) - 1);
      holdAtMost(variant.row, "volume_against_polyhedra", 1e-3);
    }
  }
  progress.beginTask(body.name + ", steps");
  timeSteps(variants, body, context.byMode(3, 5, 15));
  Rows rows;
  for (const Variant& variant : variants) rows.push_back(variant.row);
  return rows;
}

}  // namespace

Rows studyCutting(const Context& context) {
  constexpr int kTasksPerBody = 6;
  const bool has_bunny = !context.bunny_mesh.empty();
  context.progress->beginSection("cutting", kTasksPerBody * (has_bunny ? 3 : 2));
  Rows rows;
  const auto study = [&](const std::string& name, const auto& make) {
    context.progress->beginTask(name + ", cuts");
    try {
      const Rows of_body = studyBody(make(), context);
      rows.insert(rows.end(), of_body.begin(), of_body.end());
    } catch (const std::exception& error) {  // the other bodies' rows are not lost
      Row row;
      row["body"] = name;
      holdFailed(row, error.what());
      rows.push_back(row);
    }
  };
  study("block", [] { return makeCutBlock(3); });
  study("ball", [&] { return makeCutBall(context.byMode(3, 6, 6), context.byMode(5, 17, 17)); });
  if (has_bunny) {
    study("bunny", [&] { return makeCutFile("bunny", context.bunny_mesh, context.byMode(2, 17, 17)); });
    for (Row& row : rows)
      if (row["body"] == "bunny") row["note"] = context.bunny_note;
  } else {
    Row row;
    row["body"] = "bunny";
    row["method"] = "not measured";
    row["note"] = context.bunny_note;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace polyscalpel::report
