// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/assembly.hpp"

#include <algorithm>
#include <thread>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/elements/corotation.hpp"

namespace polyscalpel {

namespace {

double median(Eigen::VectorXd values) {
  if (values.size() == 0) return 0;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Assembly::Assembly(const PolyhedralMesh& mesh, const IsotropicMaterial& material, const ElementConfig& config,
                   double mass_floor)
    : material_(material), config_(config) {
  validate(material);
  validate(config);
  requireInRange("mass_floor", mass_floor, 0, 1);
  lambda_ = lameLambda(material);
  mu_ = shearModulus(material);
  elements_.resize(mesh.cellCapacity());
  is_tetrahedron_.resize(mesh.cellCapacity());
  is_touched_.assign(mesh.numVertices(), 0);
  rest_positions_ = mesh.restPositions();
  for (const CellId cell : mesh.cells()) makeCell(mesh, cell.index());
  pack(mesh);
  makePattern();
  makeMasses();
  mass_floor_kg_ = mass_floor * median(vertex_masses_);
}

void Assembly::makeCell(const PolyhedralMesh& mesh, int cell) {
  const CellSurface surface = makeCellSurface(mesh, CellId(cell), mesh.restPositions());
  elements_[cell] = makeElementMatrices(surface, material_, config_);
  is_tetrahedron_[cell] = surface.isTetrahedron();
  if (surface.isTetrahedron()) elements_[cell].stiffness.resize(0, 0);
}

void Assembly::update(const PolyhedralMesh& mesh, const MeshChange& change) {
  POLYSCALPEL_ASSERT(mesh.numVertices() == numVertices() + static_cast<int>(change.new_vertices.size()));
  elements_.resize(mesh.cellCapacity());
  is_tetrahedron_.resize(mesh.cellCapacity());
  is_touched_.resize(mesh.numVertices(), 1);
  rest_positions_ = mesh.restPositions();
  for (const CellId cell : change.removed_cells) elements_[cell.index()] = {};
  std::vector<CellId> cells = change.changed_cells;
  for (const NewCell& cell : change.new_cells) cells.push_back(cell.cell);
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
  pack(mesh);
  makePattern();
  makeMasses();
}

void Assembly::pack(const PolyhedralMesh& mesh) {
  cells_.clear();
  cell_vertices_.clear();
  int largest = 0;
  int num_blocks = 0;
  for (const CellId id : mesh.cells()) {
    PackedCell cell;
    cell.cell = id.index();
    cell.num_vertices = static_cast<int>(mesh.cell(id).vertices.size());
    cell.is_tetrahedron = is_tetrahedron_[id.index()];
    cell.first_vertex = static_cast<int>(cell_vertices_.size());
    cell.first_block = num_blocks;
    cell.volume = elements_[id.index()].volume;
    POLYSCALPEL_ASSERT(elements_[id.index()].mean_gradient.cols() == cell.num_vertices);
    cells_.push_back(cell);
    for (const VertexId vertex : mesh.cell(id).vertices) cell_vertices_.push_back(vertex.index());
    num_blocks += cell.num_vertices * (cell.num_vertices + 1) / 2;
    largest = std::max(largest, cell.num_vertices);
  }
  cell_blocks_.resize(num_blocks);
  gradients_.resize(3, static_cast<Eigen::Index>(cell_vertices_.size()));
  for (const PackedCell& cell : cells_) {
    gradients_.middleCols(cell.first_vertex, cell.num_vertices) = elements_[cell.cell].mean_gradient;
  }
  rotations_.assign(cells_.size(), Eigen::Matrix3d::Identity());
  rest_stiffness_.clear();
  work_ = Workspace(largest);
}

// Column by column: the rows are the vertices of the cells around the column's vertex. Sorting within one
// column only keeps this at some hundred nanoseconds a block.
void Assembly::makePattern() {
  struct Corner {
    int packed_cell;
    int local;
  };
  const int num_vertices = static_cast<int>(rest_positions_.cols());
  std::vector<int> first_corner(num_vertices + 1, 0);
  for (const int vertex : cell_vertices_) ++first_corner[vertex + 1];
  for (int i = 0; i < num_vertices; ++i) first_corner[i + 1] += first_corner[i];
  std::vector<Corner> corners(cell_vertices_.size());
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
}

void Assembly::makeMasses() {
  const double density = material_.density_kg_m3;
  vertex_masses_.setZero(numVertices());
  block_masses_.assign(pattern_.numBlocks(), 0.0);
  for (const PackedCell& cell : cells_) {
    const ElementMatrices& element = elements_[cell.cell];
    for (int i = 0; i < cell.num_vertices; ++i) {
      const int* const blocks = &cell_blocks_[cell.first_block + i * (i + 1) / 2];
      vertex_masses_[cell_vertices_[cell.first_vertex + i]] += density * element.shape_integral[i];
      if (!config_.consistent_mass) continue;
      for (int j = 0; j <= i; ++j) block_masses_[blocks[j]] += density * element.mass_integral(i, j);
    }
  }
  if (!config_.consistent_mass) {
    for (int i = 0; i < numVertices(); ++i) block_masses_[pattern_.column_start[i]] = vertex_masses_[i];
  }
  added_mass_ = 0;
  for (int i = 0; i < numVertices(); ++i) {
    const double missing = mass_floor_kg_ - vertex_masses_[i];
    if (!is_touched_[i] || missing <= 0) continue;
    vertex_masses_[i] = mass_floor_kg_;
    block_masses_[pattern_.column_start[i]] += missing;
    added_mass_ += missing;
  }
}

void Assembly::gather(const PackedCell& cell, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                      Workspace& work) const {
  const int* const vertices = &cell_vertices_[cell.first_vertex];
  const Eigen::Vector3d origin = positions.col(vertices[0]);
  for (int i = 0; i < cell.num_vertices; ++i) work.positions.col(i) = positions.col(vertices[i]) - origin;
}

Eigen::Matrix3d Assembly::rotation(const PackedCell& cell, const Workspace& work) const {
  return polarRotation(meanDeformationGradient(work.positions.leftCols(cell.num_vertices),
                                               gradients_.middleCols(cell.first_vertex, cell.num_vertices)));
}

void Assembly::updateRotations(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  if (!config_.corotated) return;
  POLYSCALPEL_ASSERT(positions.cols() == numVertices());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    gather(cells_[c], positions, work_);
    rotations_[c] = rotation(cells_[c], work_);
  }
}

void Assembly::resetRotations() {
  rotations_.assign(cells_.size(), Eigen::Matrix3d::Identity());
}

void Assembly::assembleStiffness(double scale, Blocks& matrix) {
  Eigen::Matrix<double, 3, 4> rotated_gradients;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const PackedCell& cell = cells_[c];
    const Eigen::Matrix3d& R = rotations_[c];
    const int* blocks = &cell_blocks_[cell.first_block];
    if (cell.is_tetrahedron) {
      // With C isotropic, V Gm^T C Gm has the blocks V (lambda g_a g_b^T + mu g_b g_a^T + mu (g_a . g_b) I),
      // and rotating K is rotating the gradients.
      for (int i = 0; i < 4; ++i) {
        rotated_gradients.col(i).noalias() = R * gradients_.col(cell.first_vertex + i);
      }
      const double lambda = scale * cell.volume * lambda_, mu = scale * cell.volume * mu_;
      for (int a = 0; a < 4; ++a) {
        const Eigen::Vector3d g_a = rotated_gradients.col(a), lambda_a = lambda * g_a, mu_a = mu * g_a;
        for (int b = 0; b <= a; ++b) {
          const Eigen::Vector3d g_b = rotated_gradients.col(b);
          Eigen::Matrix3d& block = matrix[*blocks++];
          block.noalias() += lambda_a * g_b.transpose();
          block.noalias() += g_b * mu_a.transpose();
          block.diagonal().array() += mu_a.dot(g_b);
        }
      }
    } else {
      const Eigen::MatrixXd& K = elements_[cell.cell].stiffness;
      for (int a = 0; a < cell.num_vertices; ++a) {
        for (int b = 0; b <= a; ++b) {
          const Eigen::Matrix3d rotated = scale * (R * K.block<3, 3>(3 * a, 3 * b));
          matrix[*blocks++].noalias() += rotated * R.transpose();
        }
      }
    }
  }
}

void Assembly::assemble(double mass_scale, double stiffness_scale, Blocks& matrix) {
  matrix.resize(pattern_.numBlocks());
  if (config_.corotated) {
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

// work.forces = K (R^T x - X) for work.positions; work.back is its argument, for polyhedra only.
void Assembly::cellForces(const PackedCell& cell, const Eigen::Matrix3d& R, Workspace& work) const {
  if (cell.is_tetrahedron) {
    Eigen::Matrix3d F = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 4; ++i) {
      F.noalias() += work.positions.col(i) * gradients_.col(cell.first_vertex + i).transpose();
    }
    const Eigen::Matrix3d U = R.transpose() * F;
    Eigen::Matrix3d stress = mu_ * (U + U.transpose());
    stress.diagonal().array() += lambda_ * (U.trace() - 3) - 2 * mu_;
    stress *= cell.volume;
    for (int i = 0; i < 4; ++i) work.forces.col(i).noalias() = stress * gradients_.col(cell.first_vertex + i);
    return;
  }
  const int* const vertices = &cell_vertices_[cell.first_vertex];
  for (int i = 0; i < cell.num_vertices; ++i) {
    work.back.col(i).noalias() = R.transpose() * work.positions.col(i);
    work.back.col(i) -= rest_positions_.col(vertices[i]) - rest_positions_.col(vertices[0]);
  }
  const int num_dofs = 3 * cell.num_vertices;
  const Eigen::Map<const Eigen::VectorXd> u(work.back.data(), num_dofs);
  Eigen::Map<Eigen::VectorXd>(work.forces.data(), num_dofs).noalias() = elements_[cell.cell].stiffness * u;
}

void Assembly::internalForces(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, Eigen::Matrix3Xd& forces) {
  POLYSCALPEL_ASSERT(positions.cols() == numVertices());
  forces.setZero(3, numVertices());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const PackedCell& cell = cells_[c];
    gather(cell, positions, work_);
    cellForces(cell, rotations_[c], work_);
    for (int i = 0; i < cell.num_vertices; ++i) {
      forces.col(cell_vertices_[cell.first_vertex + i]).noalias() += rotations_[c] * work_.forces.col(i);
    }
  }
}

void Assembly::multiplyMass(const Eigen::Ref<const Eigen::Matrix3Xd>& values,
                            Eigen::Matrix3Xd& result) const {
  POLYSCALPEL_ASSERT(values.cols() == numVertices());
  result.setZero(3, numVertices());
  for (int column = 0; column < numVertices(); ++column) {
    const int diagonal = pattern_.column_start[column];
    result.col(column) += block_masses_[diagonal] * values.col(column);
    if (!config_.consistent_mass) continue;
    for (int k = diagonal + 1; k < pattern_.column_start[column + 1]; ++k) {
      result.col(pattern_.row[k]) += block_masses_[k] * values.col(column);
      result.col(column) += block_masses_[k] * values.col(pattern_.row[k]);
    }
  }
}

double Assembly::elasticEnergy(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) const {
  POLYSCALPEL_ASSERT(positions.cols() == numVertices());
  double energy = 0;
  Workspace work(static_cast<int>(work_.positions.cols()));
  for (const PackedCell& cell : cells_) {
    gather(cell, positions, work);
    const Eigen::Matrix3d R = config_.corotated ? rotation(cell, work) : Eigen::Matrix3d::Identity();
    cellForces(cell, R, work);
    const int* const vertices = &cell_vertices_[cell.first_vertex];
    for (int i = 0; i < cell.num_vertices; ++i) {
      const Eigen::Vector3d rest = rest_positions_.col(vertices[i]) - rest_positions_.col(vertices[0]);
      energy += 0.5 * (R.transpose() * work.positions.col(i) - rest).dot(work.forces.col(i));
    }
  }
  return energy;
}

}  // namespace polyscalpel
