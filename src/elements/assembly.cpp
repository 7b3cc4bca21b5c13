// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/assembly.hpp"

#include <algorithm>
#include <stdexcept>
#include <thread>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

namespace {

double median(Eigen::VectorXd values) {
  if (values.size() == 0) return 0;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Adds cells' stabilising stiffness to a block matrix: (H (x) R) S^ (H (x) R)^T.
class StabiliserBlocks {
 public:
  explicit StabiliserBlocks(int most_modes) : turned_(most_modes * most_modes), half_(most_modes) {}

  /// blocks: places of the cell's lower triangle, row by row.
  void add(const Stabilisation& stabilisation, const Eigen::Matrix3d& R, double scale, const int* blocks,
           Blocks& matrix) {
    const Eigen::MatrixXd& H = stabilisation.modes;
    const Eigen::Index n = H.rows(), m = H.cols();
    for (Eigen::Index k = 0; k < m; ++k) {
      for (Eigen::Index l = 0; l <= k; ++l) {
        const Eigen::Matrix3d left = scale * (R * stabilisation.stiffness.block<3, 3>(3 * k, 3 * l));
        turned_[k * m + l].noalias() = left * R.transpose();
        if (l < k) turned_[l * m + k] = turned_[k * m + l].transpose();
      }
    }
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index l = 0; l < m; ++l) {
        half_[l] = H(a, 0) * turned_[l];
        for (Eigen::Index k = 1; k < m; ++k) half_[l] += H(a, k) * turned_[k * m + l];
      }
      for (Eigen::Index b = 0; b <= a; ++b) {
        Eigen::Matrix3d& block = matrix[*blocks++];
        for (Eigen::Index l = 0; l < m; ++l) block += H(b, l) * half_[l];
      }
    }
  }

 private:
  std::vector<Eigen::Matrix3d> turned_;  // R S^_kl R^T, row by row
  std::vector<Eigen::Matrix3d> half_;    // one vertex's row: sum_k H_ak R S^_kl R^T
};

}  // namespace

Assembly::Assembly(const PolyhedralMesh& mesh, const IsotropicMaterial& material, const ElementConfig& config,
                   double mass_floor)
    : Assembly(mesh, CellKinds{{{material, config}}, {}}, mass_floor) {}

Assembly::Assembly(const PolyhedralMesh& mesh, const CellKinds& kinds, double mass_floor)
    : kinds_(kinds.kinds), kind_of_cell_(kinds.of_cell) {
  POLYSCALPEL_ASSERT(!kinds_.empty());
  requireInRange("mass_floor", mass_floor, 0, 1);
  const ElementConfig& first = kinds_.front().element;
  for (const CellKind& kind : kinds_) {
    validate(kind.material);
    formulations_.emplace_back(kind.element);
    moduli_.push_back({lameLambda(kind.material), shearModulus(kind.material)});
    POLYSCALPEL_ASSERT(kind.element.strain == first.strain && kind.element.exact_force == first.exact_force &&
                       kind.element.consistent_mass == first.consistent_mass);
  }
  measure_ = &polyscalpel::strainMeasure(first.strain);
  elements_.resize(mesh.cellCapacity());
  kind_of_cell_.resize(mesh.cellCapacity(), 0);
  is_touched_.assign(mesh.numVertices(), 0);
  for (const CellId cell : mesh.cells()) makeCell(mesh, cell.index());
  rest_positions_ = mesh.restPositions();
  if (first.strain == Strain::kCorotated) {
    body_.emplace();
    std::vector<CellId> cells;
    for (const CellId cell : mesh.cells()) cells.push_back(cell);
    body_->update(mesh.numVertices(), {}, bodyCells(cells, mesh));
  }
  pack(mesh);
  makeMasses();
  mass_floor_kg_ = mass_floor * median(vertex_masses_);
}

void Assembly::makeCell(const PolyhedralMesh& mesh, int cell) {
  const int kind = kind_of_cell_[cell];
  POLYSCALPEL_ASSERT(kind >= 0 && kind < numKinds());
  elements_[cell] = formulations_[kind].makeMatrices(
      makeCellSurface(mesh, CellId(cell), mesh.restPositions()), kinds_[kind].material);
}

std::vector<CorotatedBody::Cell> Assembly::bodyCells(const std::vector<CellId>& cells,
                                                     const PolyhedralMesh& mesh) const {
  std::vector<CorotatedBody::Cell> result;
  result.reserve(cells.size());
  for (const CellId id : cells) {
    const int kind = kind_of_cell_[id.index()];
    result.push_back({id, &mesh.cell(id).vertices, &elements_[id.index()], moduli_[kind],
                      kinds_[kind].material.density_kg_m3});
  }
  return result;
}

void Assembly::update(const PolyhedralMesh& mesh, const MeshChange& change) {
  POLYSCALPEL_ASSERT(mesh.numVertices() == numVertices() + static_cast<int>(change.new_vertices.size()));
  elements_.resize(mesh.cellCapacity());
  kind_of_cell_.resize(mesh.cellCapacity(), 0);
  is_touched_.resize(mesh.numVertices(), 1);
  for (const CellId cell : change.removed_cells) elements_[cell.index()] = {};
  std::vector<CellId> cells = change.changed_cells;
  for (const NewCell& cell : change.new_cells) {
    kind_of_cell_[cell.cell.index()] = kind_of_cell_[cell.parent.index()];
    cells.push_back(cell.cell);
  }
  for (const CellId cell : cells) {
    for (const VertexId vertex : mesh.cell(cell).vertices) is_touched_[vertex.index()] = 1;
  }
  // Quadrature of a polyhedron takes some 40 us. The cells are independent, so two threads give the same bits
  // as one.
  const auto make = [&](std::size_t first) {
    for (std::size_t i = first; i < cells.size(); i += 2) makeCell(mesh, cells[i].index());
  };
  constexpr std::size_t kFewCells = 32;
  if (cells.size() < kFewCells) {
    make(0);
    make(1);
  } else {
    std::thread helper(make, 1);
    make(0);
    helper.join();
  }
  rest_positions_ = mesh.restPositions();
  if (body_) {
    std::vector<CellId> removed = change.removed_cells;
    removed.insert(removed.end(), change.changed_cells.begin(), change.changed_cells.end());
    body_->update(mesh.numVertices(), removed, bodyCells(cells, mesh));
  }
  has_pattern_ = false;
  repack(mesh, change);
  makeMasses();
}

void Assembly::pack(const PolyhedralMesh& mesh) {
  cells_.clear();
  cells_.reserve(mesh.numCells());
  largest_cell_ = num_packed_vertices_ = num_left_vertices_ = num_packed_blocks_ = 0;
  int num_vertices = 0, num_blocks = 0;
  for (const CellId id : mesh.cells()) {
    const int n = static_cast<int>(mesh.cell(id).vertices.size());
    num_vertices += n;
    num_blocks += n * (n + 1) / 2;
  }
  makeRoom(num_vertices, num_blocks);
  for (const CellId id : mesh.cells()) packCell(mesh, id, cells_.emplace_back());
  rest_stiffness_.clear();
  makeWorkspace();
  lineariseAtRest();
}

// Cells that are as they were keep their place. What a removed or changed cell leaves behind stays unused,
// until it is more than what is in use.
void Assembly::repack(const PolyhedralMesh& mesh, const MeshChange& change) {
  const auto placeOf = [&](CellId id) {
    const auto place = std::lower_bound(cells_.begin(), cells_.end(), id.index(),
                                        [](const PackedCell& cell, int index) { return cell.cell < index; });
    POLYSCALPEL_ASSERT(place != cells_.end() && place->cell == id.index());
    return place;
  };
  for (const std::vector<CellId>* cells : {&change.removed_cells, &change.changed_cells}) {
    for (const CellId id : *cells) num_left_vertices_ += placeOf(id)->num_vertices;
  }
  if (2 * num_left_vertices_ > num_packed_vertices_) return pack(mesh);

  int num_vertices = 0, num_blocks = 0;
  const auto count = [&](CellId id) {
    const int n = static_cast<int>(mesh.cell(id).vertices.size());
    num_vertices += n;
    num_blocks += n * (n + 1) / 2;
  };
  for (const CellId id : change.changed_cells) count(id);
  for (const NewCell& cell : change.new_cells) count(cell.cell);
  makeRoom(num_vertices, num_blocks);
  for (const CellId id : change.changed_cells) packCell(mesh, id, *placeOf(id));
  if (!change.removed_cells.empty()) {
    cells_.erase(
        std::remove_if(placeOf(change.removed_cells.front()), cells_.end(),
                       [&](const PackedCell& cell) { return !mesh.cell(CellId(cell.cell)).isAlive(); }),
        cells_.end());
  }
  for (const NewCell& cell : change.new_cells) packCell(mesh, cell.cell, cells_.emplace_back());

  if (!body_) {
    linearisations_.resize(mesh.cellCapacity());
    for (const CellId id : change.changed_cells) linearisations_[id.index()] = CellLinearisation();
  }
  rest_stiffness_.clear();
  makeWorkspace();
}

// For so many vertices and blocks more; grows by half at least, so that many small cuts copy little.
void Assembly::makeRoom(int num_vertices, int num_blocks) {
  const int needed = num_packed_vertices_ + num_vertices;
  cell_vertices_.resize(needed);
  cell_blocks_.resize(num_packed_blocks_ + num_blocks);
  if (gradients_.cols() >= needed) return;
  const int columns = num_packed_vertices_ == 0 ? needed : std::max(needed, num_packed_vertices_ * 3 / 2);
  gradients_.conservativeResize(3, columns);
}

// Behind all that is packed.
void Assembly::packCell(const PolyhedralMesh& mesh, CellId id, PackedCell& cell) {
  const ElementMatrices& element = elements_[id.index()];
  const std::vector<VertexId>& vertices = mesh.cell(id).vertices;
  cell.cell = id.index();
  cell.kind = kind_of_cell_[id.index()];
  cell.num_vertices = static_cast<int>(vertices.size());
  cell.is_stabilised = !element.stabilisation.isEmpty();
  cell.first_vertex = num_packed_vertices_;
  cell.first_block = num_packed_blocks_;
  cell.volume = element.volume;
  POLYSCALPEL_ASSERT(element.mean_gradient.cols() == cell.num_vertices);
  gradients_.middleCols(cell.first_vertex, cell.num_vertices) = element.mean_gradient;
  for (int i = 0; i < cell.num_vertices; ++i) {
    cell_vertices_[cell.first_vertex + i] = vertices[i].index();
  }
  num_packed_vertices_ += cell.num_vertices;
  num_packed_blocks_ += cell.num_vertices * (cell.num_vertices + 1) / 2;
  largest_cell_ = std::max(largest_cell_, cell.num_vertices);
}

void Assembly::makeWorkspace() {
  work_ = CellWorkspace(largest_cell_);
  gathered_.resize(3, largest_cell_);
  cell_forces_.resize(3, largest_cell_);
}

// Column by column: the rows are the vertices of the cells around the column's vertex. Sorting within one
// column only keeps this at some hundred nanoseconds a block.
void Assembly::makePattern() const {
  struct Corner {
    int packed_cell;
    int local;
  };
  const int num_vertices = static_cast<int>(is_touched_.size());
  std::vector<int> first_corner(num_vertices + 1, 0);
  for (const PackedCell& cell : cells_) {
    for (int i = 0; i < cell.num_vertices; ++i) ++first_corner[cell_vertices_[cell.first_vertex + i] + 1];
  }
  for (int i = 0; i < num_vertices; ++i) first_corner[i + 1] += first_corner[i];
  std::vector<Corner> corners(first_corner.back());
  {
    std::vector<int> next(first_corner.begin(), first_corner.end() - 1);
    for (int c = 0; c < static_cast<int>(cells_.size()); ++c) {
      for (int i = 0; i < cells_[c].num_vertices; ++i) {
        corners[next[cell_vertices_[cells_[c].first_vertex + i]]++] = {c, i};
      }
    }
  }
  pattern_.column_start.assign(1, 0);
  pattern_.row.clear();
  std::vector<int> block_of_row(num_vertices, -1);
  for (int column = 0; column < num_vertices; ++column) {
    const int start = static_cast<int>(pattern_.row.size());
    pattern_.row.push_back(column);
    block_of_row[column] = start;
    for (int k = first_corner[column]; k < first_corner[column + 1]; ++k) {
      const PackedCell& cell = cells_[corners[k].packed_cell];
      for (int i = corners[k].local + 1; i < cell.num_vertices; ++i) {  // vertices of a cell ascend
        const int row = cell_vertices_[cell.first_vertex + i];
        if (block_of_row[row] >= start) continue;
        block_of_row[row] = start;
        pattern_.row.push_back(row);
      }
    }
    std::sort(pattern_.row.begin() + start, pattern_.row.end());
    for (int k = start; k < static_cast<int>(pattern_.row.size()); ++k) block_of_row[pattern_.row[k]] = k;
    for (int k = first_corner[column]; k < first_corner[column + 1]; ++k) {
      const PackedCell& cell = cells_[corners[k].packed_cell];
      const int j = corners[k].local;
      for (int i = j; i < cell.num_vertices; ++i) {
        cell_blocks_[cell.first_block + i * (i + 1) / 2 + j] =
            block_of_row[cell_vertices_[cell.first_vertex + i]];
      }
    }
    pattern_.column_start.push_back(static_cast<int>(pattern_.row.size()));
  }
  makeBlockMasses();
  has_pattern_ = true;
}

void Assembly::makeMasses() {
  vertex_masses_.setZero(numVertices());
  for (const PackedCell& cell : cells_) {
    const ElementMatrices& element = elements_[cell.cell];
    const double density = kinds_[cell.kind].material.density_kg_m3;
    for (int i = 0; i < cell.num_vertices; ++i)
      vertex_masses_[cell_vertices_[cell.first_vertex + i]] += density * element.shape_integral[i];
  }
  moved_mass_ = 0;
  if (!hasConsistentMass() && mass_floor_kg_ > 0) applyMassFloor();
}

void Assembly::makeBlockMasses() const {
  block_masses_.assign(pattern_.numBlocks(), 0.0);
  if (!hasConsistentMass()) {
    for (int i = 0; i < numVertices(); ++i) block_masses_[pattern_.column_start[i]] = vertex_masses_[i];
    return;
  }
  for (const PackedCell& cell : cells_) {
    const ElementMatrices& element = elements_[cell.cell];
    const double density = kinds_[cell.kind].material.density_kg_m3;
    const int* blocks = &cell_blocks_[cell.first_block];
    for (int i = 0; i < cell.num_vertices; ++i) {
      for (int j = 0; j <= i; ++j) block_masses_[*blocks++] += density * element.mass_integral(i, j);
    }
  }
}

// A vertex and the touched ones around it are raised to no more than their own mean, so their surplus over
// that is at least what the vertex lacks, and nobody who gives falls below what is asked for. In the order of
// the ids, so the same mesh gives the same bits.
void Assembly::applyMassFloor() {
  const auto isLow = [&](int i) { return is_touched_[i] && vertex_masses_[i] < mass_floor_kg_; };
  std::vector<int> low, place(numVertices(), -1);  // place: in `low`
  for (int i = 0; i < numVertices(); ++i) {
    if (!isLow(i)) continue;
    place[i] = static_cast<int>(low.size());
    low.push_back(i);
  }
  if (low.empty()) return;
  std::vector<std::vector<int>> around(low.size());
  for (int vertex = 0; vertex < numVertices(); ++vertex) {
    if (!is_touched_[vertex]) continue;
    forEachNeighbourAbove(vertex, [&](int other) {
      if (!is_touched_[other]) return;
      if (place[vertex] >= 0) around[place[vertex]].push_back(other);
      if (place[other] >= 0) around[place[other]].push_back(vertex);
    });
  }
  for (const int i : low) {
    const std::vector<int>& others = around[place[i]];
    double sum = vertex_masses_[i];
    for (const int j : others) sum += vertex_masses_[j];
    const double target = std::min(mass_floor_kg_, sum / static_cast<double>(others.size() + 1));
    const double lacking = target - vertex_masses_[i];
    if (lacking <= 0) continue;
    double surplus = 0;
    for (const int j : others) surplus += std::max(0.0, vertex_masses_[j] - target);
    if (surplus <= 0) continue;
    const double part = std::min(1.0, lacking / surplus);
    for (const int j : others) vertex_masses_[j] -= part * std::max(0.0, vertex_masses_[j] - target);
    vertex_masses_[i] += part * surplus;
    moved_mass_ += part * surplus;
  }
}

CellView Assembly::view(const PackedCell& cell) const {
  return {cell.volume, moduli_[cell.kind], gradients_.middleCols(cell.first_vertex, cell.num_vertices),
          cell.is_stabilised ? &elements_[cell.cell].stabilisation : nullptr};
}

// Relative to the cell's first vertex: far from the origin forces would lose digits.
Eigen::Ref<const Eigen::Matrix3Xd> Assembly::gather(const PackedCell& cell,
                                                    const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                                    Eigen::Matrix3Xd& room) const {
  const int* const vertices = &cell_vertices_[cell.first_vertex];
  const Eigen::Vector3d origin = positions.col(vertices[0]);
  for (int i = 0; i < cell.num_vertices; ++i) room.col(i) = positions.col(vertices[i]) - origin;
  return room.leftCols(cell.num_vertices);
}

void Assembly::linearise(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  POLYSCALPEL_ASSERT(positions.cols() == numVertices());
  if (hasConstantStiffness()) return;
  const bool exact_force = kinds_.front().element.exact_force;
  if (body_) {
    body_->setStill({});
    return body_->linearise(positions, exact_force);
  }
  for (const PackedCell& cell : cells_) {
    linearisations_[cell.cell] =
        polyscalpel::linearise(*measure_, view(cell), gather(cell, positions, gathered_), exact_force, work_);
  }
}

void Assembly::lineariseAtRest() {
  if (body_) {
    body_->setStill({});
    return body_->lineariseAtRest();
  }
  linearisations_.assign(elements_.size(), CellLinearisation());
}

void Assembly::assembleStiffness(double scale, Blocks& matrix) const {
  Eigen::Matrix3Xd h_of(3, largest_cell_);
  StabiliserBlocks stabiliser(largest_cell_);
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const PackedCell& cell = cells_[c];
    const MeanLinearisation& mean = linearisations_[cell.cell].mean;
    const int n = cell.num_vertices;
    const auto gradients = gradients_.middleCols(cell.first_vertex, n);
    const double scaled_volume = scale * cell.volume;
    const double lambda = scaled_volume * moduli_[cell.kind].lambda_pa;
    const double mu = scaled_volume * moduli_[cell.kind].mu_pa;
    const Eigen::Matrix3d AAt = mean.A * mean.A.transpose();
    const bool is_prestressed = !mean.S.isZero(0);
    for (int i = 0; i < n; ++i) h_of.col(i).noalias() = mean.A * gradients.col(i);
    const int* blocks = &cell_blocks_[cell.first_block];
    for (int a = 0; a < n; ++a) {
      const Eigen::Vector3d h_a = h_of.col(a), lambda_a = lambda * h_a, mu_a = mu * h_a,
                            g_a = mu * gradients.col(a);
      for (int b = 0; b <= a; ++b) {
        const Eigen::Vector3d h_b = h_of.col(b);
        Eigen::Matrix3d& block = matrix[*blocks++];
        block.noalias() += lambda_a * h_b.transpose();
        block.noalias() += h_b * mu_a.transpose();
        block += g_a.dot(gradients.col(b)) * AAt;
        if (is_prestressed) {
          const double tension = scaled_volume * gradients.col(a).dot(mean.S * gradients.col(b));
          block.diagonal().array() += tension;
        }
      }
    }
    if (cell.is_stabilised) {
      stabiliser.add(elements_[cell.cell].stabilisation, linearisations_[cell.cell].R, scale,
                     &cell_blocks_[cell.first_block], matrix);
    }
  }
}

void Assembly::assemble(double mass_scale, double stiffness_scale, Blocks& matrix) {
  if (!has_pattern_) makePattern();
  if (body_) {
    body_->assemble(vertex_masses_, mass_scale, stiffness_scale, differences_);
    return convert(body_->pattern(), differences_, pattern_, matrix);
  }
  matrix.resize(pattern_.numBlocks());
  if (!hasConstantStiffness()) {
    std::fill(matrix.begin(), matrix.end(), Eigen::Matrix3d::Zero());
    assembleStiffness(stiffness_scale, matrix);
  } else {
    if (rest_stiffness_.empty()) {
      rest_stiffness_.assign(pattern_.numBlocks(), Eigen::Matrix3d::Zero());
      assembleStiffness(1, rest_stiffness_);
    }
    for (int k = 0; k < pattern_.numBlocks(); ++k) matrix[k] = stiffness_scale * rest_stiffness_[k];
  }
  if (mass_scale == 0) return;
  for (int k = 0; k < pattern_.numBlocks(); ++k)
    matrix[k].diagonal().array() += mass_scale * block_masses_[k];
}

void Assembly::assembleExactTangent(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                    Blocks& matrix) const {
  POLYSCALPEL_ASSERT(positions.cols() == numVertices());
  if (!has_pattern_) makePattern();
  matrix.assign(pattern_.numBlocks(), Eigen::Matrix3d::Zero());
  Eigen::Matrix3Xd room(3, largest_cell_);
  for (const PackedCell& cell : cells_) {
    const Eigen::MatrixXd tangent = exactTangent(*measure_, view(cell), gather(cell, positions, room));
    const int* blocks = &cell_blocks_[cell.first_block];
    for (int a = 0; a < cell.num_vertices; ++a) {
      for (int b = 0; b <= a; ++b) matrix[*blocks++] += tangent.block<3, 3>(3 * a, 3 * b);
    }
  }
}

void Assembly::internalForces(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, Eigen::Matrix3Xd& forces) {
  POLYSCALPEL_ASSERT(positions.cols() == numVertices());
  if (body_) return body_->internalForces(positions, forces);
  forces.setZero(3, numVertices());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const PackedCell& cell = cells_[c];
    auto cell_forces = cell_forces_.leftCols(cell.num_vertices);
    cell_forces.setZero();
    addForces(linearisations_[cell.cell], view(cell), gather(cell, positions, gathered_), work_, cell_forces);
    for (int i = 0; i < cell.num_vertices; ++i) {
      forces.col(cell_vertices_[cell.first_vertex + i]) += cell_forces.col(i);
    }
  }
}

void Assembly::lineariseWithForces(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& ahead,
                                   Eigen::Matrix3Xd& forces) {
  if (body_) {
    POLYSCALPEL_ASSERT(positions.cols() == numVertices() && ahead.cols() == numVertices());
    return body_->lineariseWithForces(positions, ahead, kinds_.front().element.exact_force, forces);
  }
  linearise(positions);
  internalForces(ahead, forces);
}

void Assembly::multiplyMass(const Eigen::Ref<const Eigen::Matrix3Xd>& values,
                            Eigen::Matrix3Xd& result) const {
  POLYSCALPEL_ASSERT(values.cols() == numVertices());
  if (body_) return body_->multiplyMass(vertex_masses_, hasConsistentMass(), values, result);
  result.setZero(3, numVertices());
  if (!has_pattern_) makePattern();
  for (int column = 0; column < numVertices(); ++column) {
    const int diagonal = pattern_.column_start[column];
    result.col(column) += block_masses_[diagonal] * values.col(column);
    if (!kinds_.front().element.consistent_mass) continue;
    for (int k = diagonal + 1; k < pattern_.column_start[column + 1]; ++k) {
      result.col(pattern_.row[k]) += block_masses_[k] * values.col(column);
      result.col(column) += block_masses_[k] * values.col(pattern_.row[k]);
    }
  }
}

double Assembly::elasticEnergy(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) const {
  POLYSCALPEL_ASSERT(positions.cols() == numVertices());
  double energy = 0;
  CellWorkspace work(largest_cell_);
  Eigen::Matrix3Xd room(3, largest_cell_);
  for (const PackedCell& cell : cells_) {
    energy += polyscalpel::elasticEnergy(*measure_, view(cell), gather(cell, positions, room), work);
  }
  return energy;
}

double Assembly::elasticEnergy(const std::vector<CellId>& cells,
                               const Eigen::Ref<const Eigen::Matrix3Xd>& positions) const {
  double energy = 0;
  CellWorkspace work(largest_cell_);
  Eigen::Matrix3Xd room(3, largest_cell_);
  for (const CellId id : cells) {
    const auto place = std::lower_bound(cells_.begin(), cells_.end(), id.index(),
                                        [](const PackedCell& cell, int index) { return cell.cell < index; });
    POLYSCALPEL_ASSERT(place != cells_.end() && place->cell == id.index());
    energy += polyscalpel::elasticEnergy(*measure_, view(*place), gather(*place, positions, room), work);
  }
  return energy;
}

}  // namespace polyscalpel
