// SPDX-License-Identifier: BSD-3-Clause
//
// What each formulation costs, and how far off it is.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "benchmark/report.hpp"
#include "benchmark/timing.hpp"
#include "polyscalpel/simulation/time_integration.hpp"
#include "support/cantilever.hpp"
#include "support/manufactured_solution.hpp"
#include "support/study_meshes.hpp"

namespace polyscalpel::report {
namespace {

struct NamedFormulation {
  std::string name;
  ElementConfig config;
  bool passes_patch_test = true;
};

std::vector<NamedFormulation> formulationsFor(BodyKind kind) {
  ElementConfig config;
  if (kind == BodyKind::kTetrahedra) return {{"tetrahedron, closed form", config, true}};
  std::vector<NamedFormulation> formulations;
  for (const int points : {1, 4, 11}) {
    config.quadrature_points = points;
    formulations.push_back(
        {"mean value, " + std::to_string(points) + (points == 1 ? " point" : " points"), config, true});
  }
  config.quadrature_points = 4;
  config.gradient_correction = false;
  formulations.push_back({"mean value, 4 points, uncorrected", config, false});
  config.gradient_correction = true;
  config.formulation = Formulation::kVirtual;
  formulations.push_back({"virtual element", config, true});
  return formulations;
}

/// Patch test: with a linear field at the boundary the inside must take it too. Largest deviation of a
/// vertex over the field's largest value.
double patchError(const PolyhedralMesh& mesh, ElementConfig config) {
  config.strain = Strain::kLinear;
  Assembly assembly(mesh, {1, 0.3, 1}, config, 0);
  assembly.lineariseAtRest();
  const Eigen::Matrix3d gradient = (Eigen::Matrix3d() << 0.3, -0.1, 0.2,  //
                                    0.15, 0.25, -0.05,                    //
                                    -0.2, 0.1, 0.4)
                                       .finished();
  const Eigen::Matrix3Xd field = gradient * mesh.restPositions();
  std::vector<bool> fixed(mesh.numVertices(), false);
  for (int f = 0; f < mesh.faceCapacity(); ++f) {
    const Face& face = mesh.face(FaceId(f));
    if (!face.isAlive() || !face.isBoundary()) continue;
    for (const VertexId vertex : face.loop) fixed[vertex.index()] = true;
  }
  Eigen::Matrix3Xd forces;
  assembly.internalForces(mesh.restPositions() + field, forces);
  const StaticSolution deviation = solveStatic(mesh, assembly, fixed, -forces);
  if (deviation.status != SolveStatus::kSolved) return NAN;
  return deviation.displacements.colwise().norm().maxCoeff() / field.colwise().norm().maxCoeff();
}

/// Wall time of one step of the bending beam, for a row of formulations in turns [s].
std::vector<double> timeSteps(const PolyhedralMesh& mesh, const std::vector<NamedFormulation>& formulations,
                              int rounds) {
  struct Body {
    Assembly assembly;
    ImplicitEuler integrator;
    SimulationState state;
  };
  std::vector<std::unique_ptr<Body>> bodies;
  std::vector<std::function<void()>> tasks;
  for (const NamedFormulation& formulation : formulations) {
    bodies.push_back(std::make_unique<Body>(Body{Assembly(mesh, {1e5, 0.3, 1000}, formulation.config, 0),
                                                 ImplicitEuler(IntegrationConfig()),
                                                 makeRestState(mesh, {FixedBox{{0, -1, -1}, {0, 1, 1}}})}));
    Body& body = *bodies.back();
    tasks.push_back([&body] {
      const IntegrationResult result = body.integrator.step(body.state, body.assembly, {});
      if (result.status != SolveStatus::kSolved) throw std::runtime_error(toString(result.status));
    });
  }
  return medianSeconds(tasks, rounds);
}

/// Wall time to make the matrices of one cell, mean over the mesh's cells, or over the first `most` of them
/// that are evenly spread [s].
std::vector<double> timeMatrices(const PolyhedralMesh& mesh,
                                 const std::vector<NamedFormulation>& formulations, int most, int rounds) {
  const std::vector<CellId> cells = mesh.cells();
  const std::size_t stride = std::max<std::size_t>(1, cells.size() / most);
  std::vector<CellSurface> surfaces;
  for (std::size_t i = 0; i < cells.size(); i += stride)
    surfaces.push_back(makeCellSurface(mesh, cells[i], mesh.restPositions()));
  std::vector<std::function<void()>> tasks;
  double sink = 0;
  for (const NamedFormulation& formulation : formulations)
    tasks.push_back([&surfaces, &sink, maker = CellFormulation(formulation.config)] {
      for (const CellSurface& surface : surfaces)
        sink += maker.makeMatrices(surface, {1e5, 0.3, 1000}).volume;
    });
  std::vector<double> times = medianSeconds(tasks, rounds);
  for (double& time : times) time /= static_cast<double>(surfaces.size());
  return times;
}

}  // namespace

Rows studyFormulations(const Context& context) {
  // Cubes along the edge of the cube with the known solution, and along the short edge of the beam.
  const std::vector<std::pair<int, int>> sizes =
      context.byMode<std::vector<std::pair<int, int>>>({{4, 2}}, {{4, 2}, {8, 4}}, {{4, 2}, {8, 4}, {12, 6}});
  const std::vector<BodyKind> kinds = {BodyKind::kHexahedra, BodyKind::kTetrahedra, BodyKind::kVoronoi,
                                       BodyKind::kSlicedHexahedra, BodyKind::kSlicedTetrahedra};
  context.progress->beginSection("formulations", static_cast<int>(sizes.size() * kinds.size()));
  Rows rows;
  for (const auto& [cube, beam] : sizes) {
    for (const BodyKind kind : kinds) {
      context.progress->beginTask(toString(kind) + ", n = " + std::to_string(cube));
      const std::vector<NamedFormulation> formulations = formulationsFor(kind);
      const PolyhedralMesh cube_mesh = makeManufacturedMesh(kind, cube);
      const PolyhedralMesh beam_mesh = makeCantileverMesh(kind, beam, beam);
      const std::vector<double> step_s = timeSteps(beam_mesh, formulations, context.byMode(5, 15, 101));
      const std::vector<double> matrix_s =
          timeMatrices(beam_mesh, formulations, context.byMode(100, 300, 1000), context.byMode(3, 7, 31));
      for (std::size_t i = 0; i < formulations.size(); ++i) {
        const NamedFormulation& formulation = formulations[i];
        const ConvergencePoint point = solveManufactured(cube_mesh, formulation.config);
        const CantileverResult bending = bendCantilever(beam_mesh, 0.3, formulation.config);
        const CantileverResult soft = bendCantilever(beam_mesh, 0.49, formulation.config);
        Row row;
        row["formulation"] = formulation.name;
        row["mesh"] = toString(kind);
        row["cube_cells"] = point.cells;
        row["cube_unknowns"] = point.unknowns;
        row["h_m"] = point.h;
        row["patch_error"] = patchError(cube_mesh, formulation.config);
        row["l2_error"] = point.l2_error;
        row["energy_error"] = point.energy_error;
        row["beam_cells"] = bending.cells;
        row["beam_unknowns"] = bending.unknowns;
        row["tip_error"] = bending.error;
        row["tip_error_poisson_049"] = soft.error;
        row["matrix_us_per_cell"] = 1e6 * matrix_s[i];
        row["step_ms"] = 1e3 * step_s[i];
        if (formulation.passes_patch_test) holdAtMost(row, "patch_error", 1e-9);
        rows.push_back(std::move(row));
      }
    }
  }
  return rows;
}

}  // namespace polyscalpel::report
