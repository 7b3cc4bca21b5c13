// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/step_stages.hpp"

#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>

#include "polyscalpel/solver/aggregates.hpp"
#include "polyscalpel/solver/block_jacobi.hpp"
#include "polyscalpel/solver/symbolic_factor.hpp"
#include "polyscalpel/solver/turned_factor.hpp"

namespace polyscalpel::report {
namespace {

constexpr double kInt = sizeof(int), kFloat = sizeof(float), kDouble = sizeof(double);

/// The rest shape twisted around the x axis.
Eigen::Matrix3Xd twisted(const Eigen::Ref<const Eigen::Matrix3Xd>& rest, double angle) {
  const Eigen::Vector3d lowest = rest.rowwise().minCoeff(), highest = rest.rowwise().maxCoeff();
  const Eigen::Vector3d middle = (lowest + highest) / 2;
  Eigen::Matrix3Xd result(3, rest.cols());
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    const double part = (rest(0, i) - lowest.x()) / (highest.x() - lowest.x());
    const Eigen::AngleAxisd turn(angle * part, Eigen::Vector3d::UnitX());
    result.col(i) = middle + turn * (rest.col(i) - middle);
  }
  return result;
}

// What the arrays of a body's cells and vertices hold. A stage moves those that it is given and those that it
// hands on, once each, at their own size without the padding between their parts; what it makes for itself
// alone, such as the forces of each cell's corners, need not leave the nearest cache.
struct BodySizes {
  double cells = 0;             // that move, with m modes each where they are stabilised
  double corners = 0;           // of these, n a cell
  double pairs = 0;             // of corners, of which one moves
  double stabilised_pairs = 0;  // of these, in cells with modes
  double blocks_of_cells = 0;   // pairs of cells with modes, whether they move or not
  double numbers = 0;           // that each cell is described by
  double stabilised = 0;        // cells with modes
  double rows = 0;              // vertices that move
  double entries = 0;           // blocks in their rows
  double entries_above = 0;     // above the diagonal, of which a vertex moves
  double turning = 0;           // corners at vertices that move
};

BodySizes sizesOf(BentBody& bent) {
  const PolyhedralMesh& mesh = bent.body.mesh;
  const std::vector<bool>& fixed = bent.body.fixed;
  BodySizes sizes;
  for (const CellId id : mesh.cells()) {
    const std::vector<VertexId>& vertices = mesh.cell(id).vertices;
    const double n = static_cast<double>(vertices.size());
    const double still = static_cast<double>(
        std::count_if(vertices.begin(), vertices.end(), [&](VertexId v) { return fixed[v.index()]; }));
    if (still == n) continue;
    const Stabilisation& stabilisation = bent.assembly.elementMatrices(id).stabilisation;
    const double m = stabilisation.isEmpty() ? 0 : static_cast<double>(stabilisation.numModes());
    const double pairs = (n * (n - 1) - still * (still - 1)) / 2;
    sizes.cells += 1;
    sizes.corners += n;
    sizes.turning += n - still;
    sizes.pairs += pairs;
    // Gradient, volume, two moduli; H, the lower triangle of S^, and X H.
    sizes.numbers += 3 * n + 3 + n * m + 3 * m * (3 * m + 1) / 2 + 3 * m;
    if (m == 0) continue;
    sizes.stabilised += 1;
    sizes.stabilised_pairs += pairs;
    sizes.blocks_of_cells += n * (n - 1) / 2;
  }
  const RowPattern& pattern = bent.corotated().pattern();
  for (int i = 0; i < pattern.numVertices(); ++i) {
    const RowPattern::Row& row = pattern.rows[i];
    if (!fixed[i]) {
      sizes.rows += 1;
      sizes.entries += row.count;
    }
    for (int entry = row.first_above; entry < row.first + row.count; ++entry)
      if (!fixed[i] || !fixed[pattern.column[entry]]) sizes.entries_above += 1;
  }
  return sizes;
}

StageTraffic onceThrough(double bytes, double items, const std::string& item) {
  return {bytes, bytes, static_cast<std::int64_t>(items), item};
}

/// Reads each cell's numbers and vertices, two positions a vertex and the list of a vertex's corners (corner
/// and place); writes each cell's rotation, and its spin where it has modes, h and lambda / mu of each corner
/// and the blocks of stabilised cells in single precision, and the force of each vertex.
StageTraffic linearisationTraffic(BentBody& bent) {
  const BodySizes sizes = sizesOf(bent);
  const double read = kDouble * (sizes.numbers + 6 * sizes.rows) + kInt * (sizes.corners + 2 * sizes.turning);
  const double written = kDouble * (9 * sizes.cells + 3 * sizes.stabilised + 3 * sizes.rows) +
                         kFloat * (4 * sizes.corners + 9 * sizes.blocks_of_cells);
  return onceThrough(read + written, sizes.cells, "cell");
}

/// Reads what linearise() made of each corner and of stabilised pairs, the two corners of each pair and the
/// place of its block, and of each entry above the diagonal two counts, mass, shear and mirror, of each row
/// its span, mass and two places; writes each such block and its transpose, and each row's mass.
StageTraffic assemblyTraffic(BentBody& bent) {
  const BodySizes sizes = sizesOf(bent);
  const double read = kFloat * (4 * sizes.corners + 9 * sizes.stabilised_pairs) +
                      kInt * (2 * sizes.pairs + sizes.stabilised_pairs) +
                      (2 * kDouble + 3 * kInt) * sizes.entries_above + (kDouble + 6 * kInt) * sizes.rows;
  const double written = 18 * kFloat * sizes.entries_above + kDouble * sizes.rows;
  return onceThrough(read + written, sizes.cells, "cell");
}

/// A factor's numbers on and below the diagonal without its padding, and the vertices of rows below a
/// supernode: both go by twice, down and up, and each vertex's place does.
StageTraffic factorTraffic(const BlockPattern& pattern, const std::vector<bool>& fixed) {
  SymbolicFactor factor;
  Ordering ordering = Ordering::kUndecided;
  if (analyse(pattern, fixed, ordering, factor) != SolveStatus::kSolved)
    throw std::runtime_error("the analysis failed by which a factor is to be counted");
  double bytes = kInt * static_cast<double>(factor.order.size());
  for (const SymbolicFactor::Supernode& node : factor.supernodes) {
    const double columns = 3 * node.num_columns, below = 3 * node.num_rows;
    bytes += kFloat * (columns * (columns + 1) / 2 + columns * below) + kInt * node.num_rows;
  }
  return {2 * bytes, bytes, 3 * static_cast<std::int64_t>(factor.order.size()), "unknown"};
}

/// The rigid motions of groups that share a block: two block rows a group.
StageTraffic coarseTraffic(BentBody& bent, int num_groups) {
  const RowPattern& rows = bent.corotated().pattern();
  int count = 0;
  const int size = AggregatePreconditioner::groupSize(static_cast<int>(bent.active.size()));
  const std::vector<int> group = makeAggregates(rows, bent.active, size, count);
  if (count != num_groups) throw std::runtime_error("the groups are of another size than was counted with");
  std::vector<std::set<int>> below(num_groups);
  for (const int i : bent.active) {
    for (int k = rows.rows[i].first; k < rows.rows[i].first + rows.rows[i].count; ++k) {
      const int other = group[rows.column[k]];
      if (other > group[i]) below[group[i]].insert(other);
    }
  }
  BlockPattern pattern;
  for (int g = 0; g < num_groups; ++g) {
    for (int half = 0; half < 2; ++half) {
      for (int part = half; part < 2; ++part) pattern.row.push_back(2 * g + part);
      for (const int other : below[g])
        for (int part = 0; part < 2; ++part) pattern.row.push_back(2 * other + part);
      pattern.column_start.push_back(pattern.numBlocks());
    }
  }
  return factorTraffic(pattern, std::vector<bool>(2 * num_groups, false));
}

/// Beside the factor: of each vertex its number and rotation, residual and result.
StageTraffic turnedFactorTraffic(BentBody& bent) {
  const BlockPattern pattern = toBlockPattern(bent.corotated().pattern());
  StageTraffic traffic = factorTraffic(pattern, bent.body.fixed);
  const double of_vertices = (kInt + 15 * kFloat) * static_cast<double>(bent.active.size());
  traffic.moved_bytes += of_vertices;
  traffic.held_bytes += of_vertices;
  return traffic;
}

/// The same with the groups' factor, and of each vertex its group, its arm and its inverse block too.
StageTraffic aggregatesTraffic(BentBody& bent, int num_groups) {
  StageTraffic traffic = coarseTraffic(bent, num_groups);
  const double of_vertices = (2 * kInt + 27 * kFloat) * static_cast<double>(bent.active.size());
  traffic.moved_bytes += of_vertices;
  traffic.held_bytes += of_vertices;
  traffic.items = 3 * static_cast<std::int64_t>(bent.active.size());
  return traffic;
}

}  // namespace

BentBody::BentBody(const StepBody& of) : body(of), assembly(of.mesh, of.material, stepElement(of), 0) {
  constexpr double kAngle = 0.5, kStepAhead = 0.02;
  const double h = stepIntegration(body).time_step_s;
  stiffness_scale = h * h;
  positions = twisted(body.mesh.restPositions(), kAngle);
  ahead = twisted(body.mesh.restPositions(), kAngle + kStepAhead);
  for (int i = 0; i < body.mesh.numVertices(); ++i)
    if (!body.fixed[i]) active.push_back(i);
  const std::vector<char> still(body.fixed.begin(), body.fixed.end());
  corotated().setStill(still);
  corotated().assembleAtRest(assembly.vertexMasses(), 1, stiffness_scale, still, rest_matrix);
  linearise();
  assemble();
  corotated().vertexRotations(rotations);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1, 1);
  x.setZero(paddedSize(body.mesh.numVertices()));
  for (const int i : active)
    for (int c = 0; c < 3; ++c) x[3 * i + c] = uniform(random);
  y = x;
}

void BentBody::assemble() {
  corotated().assemble(assembly.vertexMasses(), 1, stiffness_scale, matrix);
}

std::unique_ptr<Preconditioner> makePreconditioner(const std::string& solver, BentBody& bent) {
  const RowPattern& pattern = bent.corotated().pattern();
  if (solver == "jacobi") {
    auto made = std::make_unique<BlockJacobi>();
    made->update(pattern, bent.matrix, bent.active, 1);
    return made;
  }
  if (solver == "aggregates") {
    auto made = std::make_unique<AggregatePreconditioner>();
    if (made->make(pattern, bent.rest_matrix, bent.body.mesh.restPositions(), bent.active) !=
            SolveStatus::kSolved ||
        made->update(pattern, bent.matrix, bent.active, bent.rotations, 1) != SolveStatus::kSolved)
      return nullptr;
    return made;
  }
  if (solver != "factor")
    throw std::invalid_argument("solver " + solver + ": must be factor, aggregates or jacobi");
  const BlockPattern block_pattern = toBlockPattern(pattern);
  Blocks blocks;
  convert(pattern, bent.rest_matrix, block_pattern, blocks);
  SingleFactor factor;
  if (factor.factorise(block_pattern, blocks, bent.body.fixed) != SolveStatus::kSolved) return nullptr;
  auto made = std::make_unique<TurnedFactor>(std::move(factor), bent.body.fixed);
  if (made->update(pattern, bent.matrix, bent.rotations, bent.active) != SolveStatus::kSolved) return nullptr;
  return made;
}

// Reads each block and its column, of each row its number, its span, its mass and x; writes y.
StageTraffic productTraffic(BentBody& bent) {
  const BodySizes sizes = sizesOf(bent);
  const double of_entry = 9 * kFloat + kInt, of_row = 4 * kInt + kDouble + 6 * kFloat;
  return onceThrough(of_entry * sizes.entries + of_row * sizes.rows, sizes.entries, "block");
}

std::vector<StepStage> stepStages(const std::string& preconditioner, BentBody& bent) {
  const std::shared_ptr<Preconditioner> made = makePreconditioner(preconditioner, bent);
  if (!made) throw std::runtime_error(bent.body.name + ": the " + preconditioner + " failed");
  const auto preconditionerTraffic = [&bent, made] {
    const auto* const aggregates = dynamic_cast<const AggregatePreconditioner*>(made.get());
    return aggregates ? aggregatesTraffic(bent, aggregates->numGroups()) : turnedFactorTraffic(bent);
  };
  return {
      {"linearise", [&bent] { bent.linearise(); }, [&bent] { return linearisationTraffic(bent); }},
      {"assemble", [&bent] { bent.assemble(); }, [&bent] { return assemblyTraffic(bent); }},
      {"product", [&bent] { bent.multiply(); }, [&bent] { return productTraffic(bent); }},
      {preconditioner, [&bent, made] { made->apply(bent.x.data(), bent.y.data()); }, preconditionerTraffic}};
}

std::vector<StageSubject> stageSubjects() {
  constexpr int kBeam = 8, kHalfBall = 10;
  return {{"tet_beam10k", "factor", [] { return makeTetBeam(kBeam); }},
          {"ball40k", "aggregates", [] { return makeStepBall(kHalfBall); }},
          {"hex_beam2k", "factor", [] { return makeHexBeam(kBeam); }}};
}

}  // namespace polyscalpel::report
