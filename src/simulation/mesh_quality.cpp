// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/mesh_quality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "polyscalpel/mesh/mesh_editing.hpp"

namespace polyscalpel {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Trace of the vertex's diagonal block of K = V Gm^T C Gm + S of one cell [N/m]: for a gradient g the first
/// part has V (lambda g g^T + mu g g^T + mu |g|^2 I).
double traceOfStiffness(const Assembly& assembly, CellId cell, Eigen::Index local) {
  const ElementMatrices& element = assembly.elementMatrices(cell);
  const IsotropicMaterial& material = assembly.kind(assembly.kindOf(cell)).material;
  double trace = element.volume * element.mean_gradient.col(local).squaredNorm() *
                 (lameLambda(material) + 4 * shearModulus(material));
  return trace + element.stabilisation.traceAt(local);
}

}  // namespace

void LargestValue::set(int number, double value) {
  if (number >= static_cast<int>(values_.size())) values_.resize(number + 1, kNone);
  if (values_[number] == value) return;
  values_[number] = value;
  // Rebuilt rarely enough to cost no more than the entries that have come since.
  constexpr std::size_t kFew = 64;
  if (heap_.size() > 2 * values_.size() + kFew) {
    heap_.clear();
    for (int i = 0; i < static_cast<int>(values_.size()); ++i) {
      if (!std::isnan(values_[i])) heap_.emplace_back(values_[i], i);
    }
    std::make_heap(heap_.begin(), heap_.end());
  } else {
    heap_.emplace_back(value, number);
    std::push_heap(heap_.begin(), heap_.end());
  }
  dropOutdated();
}

void LargestValue::remove(int number) {
  if (number < static_cast<int>(values_.size())) values_[number] = kNone;
  dropOutdated();
}

void LargestValue::dropOutdated() {
  while (!heap_.empty() && values_[heap_.front().second] != heap_.front().first) {
    std::pop_heap(heap_.begin(), heap_.end());
    heap_.pop_back();
  }
}

QualityMonitor::QualityMonitor(const PolyhedralMesh& mesh, const Assembly& assembly)
    : masses_(assembly.vertexMasses()) {
  for (const CellId cell : mesh.cells()) setCell(mesh, assembly, cell);
  for (int i = 0; i < mesh.numVertices(); ++i) setVertex(mesh, assembly, VertexId(i));
}

void QualityMonitor::setCell(const PolyhedralMesh& mesh, const Assembly& assembly, CellId cell) {
  double shortest = kInfinity, relative = kInfinity, size = kInfinity;
  for (const auto& [a, b] : mesh.edges(cell)) {
    const double length = (mesh.restPosition(b) - mesh.restPosition(a)).norm();
    shortest = std::min(shortest, length);
    relative = std::min(relative, length / std::min(mesh.localSize(a), mesh.localSize(b)));
  }
  for (const VertexId vertex : mesh.cell(cell).vertices) size = std::min(size, mesh.localSize(vertex));
  minus_edge_.set(cell.index(), -shortest);
  minus_relative_edge_.set(cell.index(), -relative);
  minus_volume_.set(cell.index(), -assembly.elementMatrices(cell).volume / (size * size * size));
}

void QualityMonitor::setVertex(const PolyhedralMesh& mesh, const Assembly& assembly, VertexId vertex) {
  double trace = 0;
  for (const CellId cell : cellsAround(mesh, vertex)) {
    const std::vector<VertexId>& vertices = mesh.cell(cell).vertices;
    trace += traceOfStiffness(assembly, cell,
                              std::lower_bound(vertices.begin(), vertices.end(), vertex) - vertices.begin());
  }
  const double mass = assembly.vertexMasses()[vertex.index()];
  if (mass > 0) {
    stiffness_over_mass_.set(vertex.index(), trace / (3 * mass));
  } else {
    stiffness_over_mass_.remove(vertex.index());
  }
}

void QualityMonitor::update(const PolyhedralMesh& mesh, const Assembly& assembly, const MeshChange& change) {
  for (const CellId cell : change.removed_cells) {
    minus_edge_.remove(cell.index());
    minus_relative_edge_.remove(cell.index());
    minus_volume_.remove(cell.index());
  }
  std::vector<VertexId> vertices = change.retired_vertices;
  const auto follow = [&](CellId cell) {
    setCell(mesh, assembly, cell);
    const std::vector<VertexId>& corners = mesh.cell(cell).vertices;
    vertices.insert(vertices.end(), corners.begin(), corners.end());
  };
  for (const CellId cell : change.changed_cells) follow(cell);
  for (const NewCell& cell : change.new_cells) follow(cell.cell);
  // The mass floor reaches beyond those cells, and a vertex whose copy left it may have none of them.
  const Eigen::VectorXd& masses = assembly.vertexMasses();
  for (Eigen::Index i = 0; i < masses_.size(); ++i) {
    if (masses[i] != masses_[i]) vertices.emplace_back(static_cast<int>(i));
  }
  masses_ = masses;
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const VertexId vertex : vertices) setVertex(mesh, assembly, vertex);
}

MeshQuality QualityMonitor::quality() const {
  return {-minus_edge_.get(), -minus_relative_edge_.get(), -minus_volume_.get(), stiffness_over_mass_.get()};
}

}  // namespace polyscalpel
