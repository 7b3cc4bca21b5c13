// SPDX-License-Identifier: BSD-3-Clause
//
// Hard cases of whole bodies at rest: cuts near what is there, thin and uneven meshes, extreme materials.
#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/simulation/equilibrium.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"
#include "polyscalpel/simulation/static_solution.hpp"
#include "polyscalpel/simulation/time_integration.hpp"
#include "support/hard_cases_parts.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// The larger one, or NaN where one is.
double larger(double a, double b) {
  return std::isnan(a) || a > b ? a : b;
}

ElementConfig linearElement() {
  ElementConfig config;
  config.strain = Strain::kLinear;
  return config;
}

/// The exponent of the hardest level up to which `error` stays within a percent, going on from `held`.
int findLimit(int held, int most, const std::function<double(int)>& error) {
  while (held < most && error(held + 1) < 0.01) ++held;
  return held;
}

// --- cuts near vertices, edges and faces
// ---------------------------------------------------------------------

HardCase cutBodies(double snap_tolerance, bool all_part, double bound, Extent extent) {
  HardCase row;
  double worst = 0;
  int splits = 0, left_whole = 0, in_two = 0, cuts = 0;
  bool sound = true;
  const Vector3d normals[] = {{1, 1.1, 0.9}, {1, 0.8, 0}, {1, 0, 0}};
  const char* const kinds[] = {"a vertex", "an edge", "a face"};
  const int stride = extent == Extent::kFull ? 1 : 3;
  std::string whole;  // from where on cells are left whole
  for (int kind = 0; kind < 3; ++kind) {
    const Vector3d& normal = normals[kind];
    bool is_first = true;
    for (int digits = 1; digits <= 10; digits += stride) {
      PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d::Constant(3), Eigen::Vector3i::Constant(3));
      CuttingConfig config;
      config.snap_tolerance = snap_tolerance;
      const PlaneCut plane{Vector3d::Ones() + std::pow(10, -digits) * normal.normalized(), normal};
      const Matrix3Xd positions = mesh.restPositions();
      const CutResult cut = cutMesh(mesh, positions, plane, config, 1);
      ++cuts;
      splits += cut.cells_split;
      left_whole += cut.cells_left_whole;
      if (cut.cells_left_whole > 0 && is_first) {
        whole += (whole.empty() ? "1e-" : ", 1e-") + std::to_string(digits) + " of " + kinds[kind];
        is_first = false;
      }
      in_two += cut.pieces_after == 2;
      sound = sound && checkMesh(mesh).empty();
      std::vector<bool> is_held(mesh.numVertices());
      for (int i = 0; i < mesh.numVertices(); ++i) {
        const Vector3d X = mesh.restPosition(VertexId(i));
        is_held[i] = X.minCoeff() < 1e-12 || X.maxCoeff() > 3 - 1e-12;
      }
      worst = larger(worst, patchTestError(mesh, is_held, {1.0, 0.3, 1.0}));
    }
  }
  row.quantity = "displacement error of the patch test";
  judge(row, worst, bound, sound && (!all_part || (in_two == cuts && left_whole == 0)));
  row.what_happens = "27 hexahedra cut at 1e-1 to 1e-10 of a cell from a vertex, an edge, a face: " +
                     std::to_string(in_two) + " of " + std::to_string(cuts) +
                     " cuts part the body in two, every mesh is valid; " + std::to_string(splits) +
                     " splits, " + std::to_string(left_whole) + " cells left whole.";
  if (!whole.empty()) row.limit = "The first cells left whole: at " + whole + ".";
  return row;
}

HardCase cutsSnapped(Extent extent) {
  // The thinnest cell is 0.05 h, so the stiffnesses differ by some (1 / 0.05)^2 times the 27 cells: eps times
  // that. A cut also has to part the body wherever it lies.
  HardCase row = cutBodies(CuttingConfig().snap_tolerance, true, 1e-11, extent);
  row.limit =
      "None: nearer than 0.05 of a cell the cut goes through the vertex, and its place is off by that.";
  return row;
}

HardCase cutsHardlySnapped(Extent extent) {
  // A slab of thickness 1e-6 is 1e6 times as stiff as the cell beside it: eps times that times the some 100
  // vertices.
  HardCase row = cutBodies(1e-6, false, 1e-7, extent);
  row.limit =
      "Parts with a sub-tet below 1e-8 of h^3, or of their extent's cube, are refused; the cell stays whole "
      "and is counted. " +
      row.limit;
  return row;
}

// --- thin and uneven meshes
// ----------------------------------------------------------------------------------

/// A box without lateral contraction, held at its lowest x and pulled: u_x = x exactly. Relative error.
double pullError(const PolyhedralMesh& mesh) {
  Assembly assembly(mesh, {1.0, 0.0, 1.0}, linearElement(), 0);
  const Eigen::Matrix3d stress = Vector3d(1, 0, 0).asDiagonal();
  const StaticSolution solution = solveStatic(mesh, assembly, lowestX(mesh), boundaryLoads(mesh, stress));
  if (solution.status != SolveStatus::kSolved) return kInfinity;
  Matrix3Xd error = solution.displacements;
  error.row(0) -= mesh.restPositions().row(0);
  return error.norm() / mesh.restPositions().row(0).norm();
}

/// A cube with a layer of cells as thin as that in its middle.
double layerError(int digits) {
  const std::vector<double> even = evenly(0, 1, 3);
  return pullError(makeGridBox(even, even, {0, 0.5, 0.5 + std::pow(10, -digits), 1}));
}

HardCase thinLayer(Extent extent) {
  HardCase row;
  row.quantity = "displacement error";
  // The layer is 1e6 times as stiff across as the cells beside it; some 100 degrees of freedom.
  judge(row, layerError(6), kEpsilon * 1e6 * 100);
  row.what_happens =
      "A cube with a layer of cells 1e-6 thin in its middle stretches as it should when pulled.";
  row.limit = "Rounding: eps over the thickness.";
  if (extent == Extent::kFull) {
    const int digits = findLimit(6, 14, layerError);
    row.limit = "The error stays below 1 % down to a thickness of 1e-" + std::to_string(digits) +
                (digits < 14 ? "; the solver refuses thinner ones or is further off." : ".");
  }
  return row;
}

PolyhedralMesh makeSlab(int digits) {
  return makeHexBox({0, 0, 0}, {1, 1, std::pow(10, -digits)}, {4, 4, 1});
}
double slabError(int digits) {
  return pullError(makeSlab(digits));
}

HardCase freeSlab(Extent) {
  HardCase row;
  row.quantity = "displacement error at rest (inf: refused)";
  // In motion its own inertia holds it.
  const PolyhedralMesh mesh = makeSlab(6);
  Assembly assembly(mesh, {1e4, 0.3, 1000}, ElementConfig(), 0);
  SimulationState state = makeRestState(mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}});
  ImplicitEuler integrator{IntegrationConfig()};
  bool moves = true;
  for (int step = 0; step < 30; ++step) {
    moves = moves && integrator.step(state, assembly, {}).status == SolveStatus::kSolved &&
            state.positions.allFinite();
  }
  // As of a thick body: a user needs 1 %.
  judge(row, slabError(6), 0.01, moves && slabError(6) == kInfinity);
  row.expected_to_hold = false;
  int digits = 0;
  digits = findLimit(digits, 6, slabError);
  row.what_happens =
      "A slab of 4 x 4 x 1 cells, 1e-6 as thick as wide, held at one side only: at rest it is "
      "refused as not positive definite; 30 steps under gravity are all solved.";
  row.limit = "At rest the error stays below 1 % down to a thickness of 1e-" + std::to_string(digits) +
              ": bending and squeezing differ in stiffness by the fourth power of the thickness.";
  return row;
}

double gradedError(int digits) {
  std::vector<double> steps = {0};
  for (int i = -digits; i <= 0; ++i) steps.push_back(std::pow(10, i));
  return pullError(makeGridBox(steps, steps, steps));
}

HardCase sizeRatio(Extent extent) {
  HardCase row;
  row.quantity = "displacement error";
  // A plate of 1 x 1 x 1e-6 is 1e12 times as stiff as a cube of 1e-6.
  judge(row, gradedError(6), kEpsilon * 1e12);
  row.what_happens =
      "A cube of 1 m in 343 cells, 1e-6 m wide in one corner and ten times more from each to "
      "the next in all directions, stretches as it should when pulled.";
  row.limit = "Rounding: eps times the squared ratio.";
  if (extent == Extent::kFull) {
    const int digits = findLimit(6, 10, gradedError);
    row.limit = "The error stays below 1 % up to a ratio of 1e" + std::to_string(digits) +
                (digits < 10 ? "; beyond it the solver refuses or is further off." : ".");
  }
  return row;
}

// --- beams
// ---------------------------------------------------------------------------------------------------

constexpr double kBeamLength = 0.4, kBeamWidth = 0.05;
/// Stiffness ratio of the beam of 16 x 2 x 2 cells, its stretching over its bending, by (16 cells)^2 times
/// the squared slenderness: what turns a residual into an error of displacement.
constexpr double kBeamCondition = 2e4;

/// The beam, notched, bent down by its weight by a third of its length: positions over the scale.
Matrix3Xd bentBeam(double scale) {
  PolyhedralMesh mesh =
      makeHexBox({0, 0, 0}, scale * Vector3d(kBeamLength, kBeamWidth, kBeamWidth), {16, 2, 2});
  const Matrix3Xd notch =
      scale * (Matrix3Xd(3, 4) << 0.103, 0.117, 0.117, 0.103, -1, -1, 1, 1, 0.02, 0.2, 0.2, 0.02).finished();
  if (notch.cwiseAbs().maxCoeff() > kLargestCoordinate_m) return {};  // no cut is taken so far out
  const Matrix3Xd rest = mesh.restPositions();
  if (cutMesh(mesh, rest, PolygonCut{notch}, CuttingConfig(), 1).status != CutStatus::kCut) return {};
  Assembly assembly(mesh, {1e5, 0.4, 1000}, ElementConfig(), 0);
  Matrix3Xd positions = mesh.restPositions();
  const Matrix3Xd weights = Vector3d(0, 0, -9.81 / scale) * assembly.vertexMasses().transpose();
  IntegrationConfig config;
  config.equilibrium_tolerance = 1e-10;
  if (!findEquilibrium(mesh, assembly, lowestX(mesh), weights, {}, config, positions).converged) return {};
  return positions / scale;
}

HardCase bodySizes(Extent extent) {
  HardCase row;
  row.quantity = "difference of positions over the length, from the body of 0.4 m";
  const Matrix3Xd expected = bentBeam(1);
  const auto error = [&](double length) {
    const Matrix3Xd positions = bentBeam(length / kBeamLength);
    if (positions.cols() != expected.cols() || expected.cols() == 0) return kInfinity;
    return (positions - expected).colwise().norm().maxCoeff() / kBeamLength;
  };
  // The tolerance of the equilibrium times the beam's condition.
  judge(row, larger(error(1e-6), error(1e3)), 1e-10 * kBeamCondition);
  row.what_happens =
      "A notched beam of 1e-6 m and one of 1e3 m, gravity scaled with them, are cut into the "
      "same cells and hang in the same shape.";
  row.limit = "1e-6 and 1e3 m are the sizes tried.";
  if (extent == Extent::kFull) {
    int small = 6, large = 3;
    while (small < 60 && error(std::pow(10, -small - 3)) < 1e-6) small += 3;
    while (large < 60 && error(std::pow(10, large + 3)) < 1e-6) large += 3;
    row.limit = "Same shape from 1e-" + std::to_string(small) + " to 1e" + std::to_string(large) + " m.";
  }
  return row;
}

HardCase stiffnessesAtRest(Extent extent) {
  HardCase row;
  row.quantity = "difference of u E from that at 1e5 Pa";
  const PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {kBeamLength, kBeamWidth, kBeamWidth}, {16, 2, 2});
  const auto scaled = [&](double E) -> Matrix3Xd {
    Assembly assembly(mesh, {E, 0.4, 1000}, linearElement(), 0);
    const Matrix3Xd weights = Vector3d(0, 0, -9.81) * assembly.vertexMasses().transpose();
    const StaticSolution solution = solveStatic(mesh, assembly, lowestX(mesh), weights);
    if (solution.status != SolveStatus::kSolved) {
      return Matrix3Xd::Constant(3, mesh.numVertices(), kInfinity);
    }
    return E * solution.displacements;
  };
  const Matrix3Xd expected = scaled(1e5);
  const auto error = [&](int exponent) {
    return (scaled(std::pow(10, exponent)) - expected).norm() / expected.norm();
  };
  double worst = 0;
  for (int exponent = 1; exponent <= 12; ++exponent) worst = larger(worst, error(exponent));
  // Both solutions carry the backward error of their factorisation, times the condition: the roundings of
  // sums of some hundred terms, which grow with the root of that.
  constexpr double kRoundings = 10;
  judge(row, worst, 2 * kRoundings * kEpsilon * kBeamCondition);
  row.what_happens = "From 1e1 to 1e12 Pa a beam's displacements under its weight go with 1 / E.";
  row.limit = "1e1 and 1e12 Pa are the moduli tried.";
  if (extent == Extent::kFull) {
    int low = 1, high = 12;
    while (low > -140 && error(low - 10) < 1e-6) low -= 10;
    while (high < 140 && error(high + 10) < 1e-6) high += 10;
    row.limit = "Same from 1e" + std::to_string(low) + " to 1e" + std::to_string(high) + " Pa.";
  }
  return row;
}

/// A bar of two halves, pulled: relative error of displacement.
double contrastError(const PolyhedralMesh& mesh, double first_pa, double second_pa) {
  CellKinds kinds;
  kinds.kinds = {{{first_pa, 0.0, 1.0}, linearElement()}, {{second_pa, 0.0, 1.0}, linearElement()}};
  kinds.of_cell.resize(mesh.cellCapacity());
  for (const CellId cell : mesh.cells()) {
    const CellSurface surface = makeCellSurface(mesh, cell, mesh.restPositions());
    kinds.of_cell[cell.index()] = starCentre(surface).x() > 0.5;
  }
  Assembly assembly(mesh, kinds, 0);
  const Eigen::Matrix3d stress = Vector3d(1, 0, 0).asDiagonal();
  const StaticSolution solution = solveStatic(mesh, assembly, lowestX(mesh), boundaryLoads(mesh, stress));
  if (solution.status != SolveStatus::kSolved) return kInfinity;
  Matrix3Xd exact = Matrix3Xd::Zero(3, mesh.numVertices());
  for (int i = 0; i < mesh.numVertices(); ++i) {
    const double x = mesh.restPosition(VertexId(i)).x();
    exact(0, i) = std::min(x, 0.5) / first_pa + std::max(x - 0.5, 0.0) / second_pa;
  }
  return (solution.displacements - exact).norm() / exact.norm();
}

HardCase contrast(Extent extent) {
  HardCase row;
  row.quantity = "displacement error";
  const PolyhedralMesh mesh = makeHexBox({0, 0, 0}, {1, 0.25, 0.25}, {8, 2, 2});
  const auto error = [&](int digits) {
    const double ratio = std::pow(10, digits);
    return larger(contrastError(mesh, 1, ratio), contrastError(mesh, ratio, 1));
  };
  // The contrast times the bar's own condition, (8 cells)^2 times the squared slenderness 4^2, times eps.
  judge(row, error(6), kEpsilon * 1e6 * 1e3);
  row.what_happens =
      "A bar whose halves differ in E by 1e6, held at the stiff or at the soft end and pulled, "
      "stretches as it should.";
  row.limit = "Rounding: eps times the contrast times the condition of the bar.";
  if (extent == Extent::kFull) {
    const int digits = findLimit(6, 18, error);
    row.limit = "The error stays below 1 % up to a contrast of 1e" + std::to_string(digits) +
                (digits < 18 ? "; beyond it the solver refuses or is further off." : ".");
  }
  return row;
}

/// Tip deflection of the cantilever under a shear force at its end, over Timoshenko's theory.
double deflection(const PolyhedralMesh& mesh, double nu) {
  const IsotropicMaterial material{1e5, nu, 1000};
  Assembly assembly(mesh, material, linearElement(), 0);
  // A uniform shear traction on the end face alone.
  const double area = kBeamWidth * kBeamWidth, force = 1;
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
  stress(2, 0) = force / area;  // acts on faces whose normal has an x
  const StaticSolution solution = solveStatic(mesh, assembly, lowestX(mesh), boundaryLoads(mesh, stress));
  if (solution.status != SolveStatus::kSolved) return kInfinity;
  const double E = material.youngs_modulus_pa, I = area * area / 12, L = kBeamLength;
  const double theory =
      force * L * L * L / (3 * E * I) + force * L / (5.0 / 6 * shearModulus(material) * area);
  double tip = 0;
  int count = 0;
  for (int i = 0; i < mesh.numVertices(); ++i) {
    if (mesh.restPosition(VertexId(i)).x() < L * (1 - 1e-9)) continue;
    tip += solution.displacements(2, i);
    ++count;
  }
  return tip / count / theory;
}

/// Locking: what of the deflection is lost on the way from nu = 0.3 to nearly 0.5. How stiff the mesh is by
/// itself, against theory, stands in the sentence.
HardCase nearlyIncompressible(const PolyhedralMesh& mesh, const std::string& cells) {
  HardCase row;
  row.quantity = "part of the tip's deflection lost from nu = 0.3 on";
  const double compressible = deflection(mesh, 0.3);
  double worst = 0;
  std::string found = figure(100 * (compressible - 1)) + " % at nu = 0.3";
  for (const double nu : {0.45, 0.49, 0.499, 0.4999}) {
    const double ratio = deflection(mesh, nu);
    worst = larger(worst, 1 - ratio / compressible);
    std::ostringstream text;
    text << ", " << figure(100 * (ratio - 1)) << " % at " << nu;
    found += text.str();
  }
  // What a user needs.
  judge(row, worst, 0.1, std::isfinite(worst));
  row.what_happens = "Tip of a cantilever of " + cells + " against Timoshenko's theory: " + found + ".";
  return row;
}

HardCase incompressibleHexes(Extent) {
  HardCase row = nearlyIncompressible(
      makeHexBox({0, 0, 0}, {kBeamLength, kBeamWidth, kBeamWidth}, {16, 2, 2}), "16 x 2 x 2 hexahedra");
  row.limit = "nu < 0.5: at 0.5 lambda is infinite, which is refused. Two cells across are stiff at any nu.";
  return row;
}

HardCase incompressibleTets(Extent) {
  HardCase row = nearlyIncompressible(
      makeTetBox({0, 0, 0}, {kBeamLength, kBeamWidth, kBeamWidth}, {16, 2, 2}), "320 tetrahedra");
  row.limit = "Linear tetrahedra lock: take other polyhedra above nu = 0.45.";
  row.expected_to_hold = false;
  return row;
}

}  // namespace

std::vector<HardCaseEntry> bodyCases() {
  return {{"body cut near vertices, edges and faces", cutsSnapped},
          {"the same, snap tolerance 1e-6", cutsHardlySnapped},
          {"slab 1e-6 thin inside a body", thinLayer},
          {"slab 1e-6 thin by itself, at rest", freeSlab},
          {"size ratio 1e6 in one mesh", sizeRatio},
          {"bodies of 1e-6 m and 1e3 m", bodySizes},
          {"E from 1e1 to 1e12 Pa at rest", stiffnessesAtRest},
          {"contrast of E 1e6 across a face", contrast},
          {"nu to 0.4999, polyhedra", incompressibleHexes},
          {"nu to 0.4999, tetrahedra", incompressibleTets}};
}

}  // namespace polyscalpel
