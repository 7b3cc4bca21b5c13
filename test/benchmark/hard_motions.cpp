// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/hard_motions.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include <Eigen/Geometry>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "support/hard_cases_parts.hpp"
#include "support/torture.hpp"

namespace polyscalpel::report {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

Assembly assemblyOf(const StepBody& body) {
  return {body.mesh, body.material, stepElement(body), 0};
}

/// What is left of weight and elastic forces at vertices that move, over the weight.
double forceOutOfBalance(const StepBody& body, const Matrix3Xd& positions) {
  Assembly assembly = assemblyOf(body);
  Matrix3Xd forces;
  assembly.linearise(positions);
  assembly.internalForces(positions, forces);
  const Matrix3Xd weight = body.gravity_m_s2 * assembly.vertexMasses().transpose();
  double left = 0, all = 0;
  for (int i = 0; i < positions.cols(); ++i) {
    if (body.fixed[i]) continue;
    left += (weight.col(i) - forces.col(i)).squaredNorm();
    all += weight.col(i).squaredNorm();
  }
  return std::sqrt(left / all);
}

double volumeChange(const StepBody& body, const Matrix3Xd& positions) {
  return std::abs(volume(body.mesh, positions) / volume(body.mesh, body.mesh.restPositions()) - 1);
}

/// Largest distance of a vertex from its rest position over the body's length.
double distanceFromRest(const StepBody& body, const Matrix3Xd& positions) {
  const auto rest = body.mesh.restPositions();
  return (positions - rest).colwise().norm().maxCoeff() / (rest.row(0).maxCoeff() - rest.row(0).minCoeff());
}

double invertedCells(const StepBody& body, const Matrix3Xd& positions) {
  return countInverted(body, positions);
}

// --- twist

constexpr double kTwistLength = 0.4, kTwistWidth = 0.05, kTurns = 2, kWholeTurn = 2 * EIGEN_PI;

/// Vertices of each cross-section, from one end to the other.
std::vector<std::vector<int>> crossSections(const PolyhedralMesh& mesh) {
  std::vector<std::pair<double, int>> vertices;
  for (int i = 0; i < mesh.numVertices(); ++i) vertices.emplace_back(mesh.restPosition(VertexId(i)).x(), i);
  std::sort(vertices.begin(), vertices.end());
  std::vector<std::vector<int>> sections;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (i == 0 || vertices[i].first - vertices[i - 1].first > 1e-6 * kTwistLength) sections.emplace_back();
    sections.back().push_back(vertices[i].second);
  }
  return sections;
}

/// A straight bar under twist turns evenly along its length. A row of cells that slips by a whole turn lacks
/// half of it.
double unevenTurn(const StepBody& body, const Matrix3Xd& positions) {
  const std::vector<std::vector<int>> sections = crossSections(body.mesh);
  double turn = 0, before = 0, worst = 0;
  for (std::size_t s = 0; s < sections.size(); ++s) {
    double sine = 0, cosine = 0;
    for (const int i : sections[s]) {
      const Vector3d X = body.mesh.restPosition(VertexId(i)), x = positions.col(i);
      sine += X.y() * x.z() - X.z() * x.y();
      cosine += X.y() * x.y() + X.z() * x.z();
    }
    const double angle = std::atan2(sine, cosine);
    if (s > 0) turn += std::remainder(angle - before, kWholeTurn);
    before = angle;
    const double even = kTurns * s / (sections.size() - 1);
    worst = std::max(worst, std::abs(turn / kWholeTurn - even) / kTurns);
  }
  return worst;
}

HardMotion twist(const Context& context) {
  // A straight bar under twist buckles, to a side that rounding picks: this one past 720 degrees, finer,
  // thinner, stretched or more slowly turned ones before.
  constexpr int kSteps = 120;  // of 6 degrees
  const int n = context.byMode(3, 5, 5);
  HardMotion motion;
  StepBody& body = motion.body;
  body.mesh = makeHexBox({0, -kTwistWidth / 2, -kTwistWidth / 2}, {kTwistLength, kTwistWidth, kTwistWidth},
                         {8 * n, n, n});
  body.fixed = makeRestState(body.mesh, {FixedBox{{0, -1, -1}, {0, 1, 1}},
                                         FixedBox{{kTwistLength, -1, -1}, {kTwistLength, 1, 1}}})
                   .fixed;
  body.material = {1e5, 0.3, 1000};
  body.gravity_m_s2.setZero();
  body.consistent_mass = false;
  body.time_step_s = 0.05;
  body.drive = [end = crossSections(body.mesh).back(), rest = Matrix3Xd(body.mesh.restPositions())](
                   int step, Matrix3Xd& positions) {
    const Eigen::AngleAxisd turn(kTurns * kWholeTurn * step / kSteps, Vector3d::UnitX());
    for (const int i : end) positions.col(i) = turn * rest.col(i);
  };
  motion.steps = kSteps;
  motion.quantity = "largest lead or lag of a cross-section, over the whole turn";
  motion.value = unevenTurn;
  motion.bound = 0.1;
  return motion;
}

// --- steps, stiffness, Poisson's ratio

HardMotion largeSteps(const Context& context) {
  HardMotion motion;
  motion.body = makeTetBeam(context.byMode(4, 7, 8));
  motion.body.time_step_s = 0.1;
  motion.steps = 60;
  motion.quantity = "force out of balance at the end, over the weight";
  motion.value = forceOutOfBalance;
  motion.bound = 1e-3;
  return motion;
}

HardMotion stiff(const Context& context) {
  HardMotion motion;
  motion.body = makeTetBeam(context.byMode(4, 7, 8));
  motion.body.material.youngs_modulus_pa = 1e9;
  motion.steps = 30;
  motion.quantity = "force out of balance at the end, over the weight";
  motion.value = forceOutOfBalance;
  motion.bound = 1e-3;
  return motion;
}

HardMotion nearlyIncompressible(int n, double poisson_ratio) {
  HardMotion motion;
  motion.body = makeHexBeam(n);
  motion.body.material.poisson_ratio = poisson_ratio;
  motion.steps = 60;
  motion.quantity = "relative change of volume at the end";
  motion.value = volumeChange;
  motion.bound = 0.01;
  return motion;
}

HardMotion poisson0499(const Context& context) {
  return nearlyIncompressible(context.byMode(5, 6, 8), 0.499);
}

HardMotion poisson04999(const Context& context) {
  HardMotion motion = nearlyIncompressible(context.byMode(4, 5, 6), 0.4999);
  motion.we_lose =
      "K is 5,000 times the shear modulus: what is turned by vertex does not fit cells that turn otherwise, "
      "and a residual made of pressure hides the bending's";
  return motion;
}

// --- inverted cells

HardMotion scrambled(const Context&) {
  constexpr int kFewestInverted = 2000, kCubes = 10;
  constexpr double kSize = 0.1;
  HardMotion motion;
  StepBody& body = motion.body;
  body.mesh = makeTetBox(Vector3d::Zero(), Vector3d::Constant(kSize), Eigen::Vector3i::Constant(kCubes));
  body.fixed = makeRestState(body.mesh, {FixedBox{{0, 0, 0}, {0, kSize, kSize}}}).fixed;
  body.material = {1e4, 0.3, 1000};
  body.gravity_m_s2.setZero();
  body.start = body.mesh.restPositions();
  std::mt19937 random(29);
  std::uniform_real_distribution<double> anywhere(0, kSize);
  for (int i = 0; i < body.mesh.numVertices(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double coordinate = anywhere(random);
      if (!body.fixed[i]) (*body.start)(axis, i) = coordinate;
    }
  }
  if (countInverted(body, *body.start) < kFewestInverted)
    throw std::runtime_error("fewer cells than the row is about are inverted at the start");
  motion.steps = 150;
  motion.quantity = "distance from rest at the end, over the size";
  motion.value = distanceFromRest;
  motion.bound = 1e-3;
  motion.is_chaotic = "an inverted cell may turn back in more than one way";
  return motion;
}

// --- slivers

PolyhedralMesh tortured(TortureSize size, int num_cuts) {
  const std::vector<TortureSubject> subjects = tortureSubjects(size);
  const auto beam = std::find_if(subjects.begin(), subjects.end(),
                                 [](const TortureSubject& subject) { return subject.name == "beam"; });
  TortureSequence sequence(TorturePlan(), 5);
  TortureBody body(beam->name, beam->make(), beam->is_convex);
  for (int i = 0; i < num_cuts; ++i) {
    if (!body.apply(sequence.next(body), CuttingConfig()).violations.empty())
      throw std::runtime_error("random cuts left a mesh that is not valid");
  }
  return body.mesh();
}

/// Each piece hangs by its largest cell: by a sliver it would spin.
std::vector<bool> heldPieceByPiece(const PolyhedralMesh& mesh) {
  const Pieces pieces = findPieces(mesh);
  std::vector<double> largest(pieces.count, 0);
  std::vector<CellId> holding(pieces.count);
  std::vector<bool> fixed(mesh.numVertices(), true);  // those without cells too
  for (const CellId id : mesh.cells()) {
    for (const VertexId v : mesh.cell(id).vertices) fixed[v.index()] = false;
    const int piece = pieces.piece_of_cell[id.index()];
    const double size = volume(makeCellSurface(mesh, id, mesh.restPositions()));
    if (size <= largest[piece]) continue;
    largest[piece] = size;
    holding[piece] = id;
  }
  for (const CellId id : holding)
    for (const VertexId v : mesh.cell(id).vertices) fixed[v.index()] = true;
  return fixed;
}

HardMotion slivers(const Context& context) {
  HardMotion motion;
  StepBody& body = motion.body;
  body.mesh = tortured(context.byMode(TortureSize::kSmall, TortureSize::kUsual, TortureSize::kSmall),
                       context.byMode(25, 40, 100));
  body.fixed = heldPieceByPiece(body.mesh);
  body.material = {1e6, 0.3, 1000};
  body.consistent_mass = false;
  motion.steps = 20;
  motion.quantity = "inverted cells at the end";
  motion.value = invertedCells;
  motion.bound = 0;
  return motion;
}

}  // namespace

std::vector<HardMotionEntry> hardMotions() {
  return {{"720 degrees of twist", twist},
          {"steps of 0.1 s", largeSteps},
          {"1e9 Pa", stiff},
          {"nu = 0.499", poisson0499},
          {"nu = 0.4999", poisson04999},
          {"all vertices thrown anywhere", scrambled},
          {"slivers after random cuts", slivers}};
}

int countInverted(const StepBody& body, const Matrix3Xd& positions) {
  const Eigen::VectorXd determinants = cellDeterminants(body.mesh, assemblyOf(body), positions);
  return static_cast<int>(determinants.size() - (determinants.array() > 0).count());
}

}  // namespace polyscalpel::report
