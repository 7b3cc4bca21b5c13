// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/cell_tree.hpp"

#include <algorithm>
#include <utility>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Positions = Eigen::Ref<const Eigen::Matrix3Xd>;

constexpr double kLoosestMargin = 0.25;  ///< as a multiple of the mean side of the leaves
constexpr double kWorstArea = 2;         ///< as a multiple of the summed area when the tree was built

/// A new vertex lies between its parents up to rounding: some ulp of its coordinates for each cut that one
/// vertex descends from.
constexpr double kRounding = 1e-12;

double halfArea(const AlignedBox3d& box) {
  const Vector3d sides = box.sizes();
  return sides.x() * sides.y() + sides.y() * sides.z() + sides.z() * sides.x();
}

void extend(CellTree::Bound& bound, const CellTree::Bound& other) {
  bound.box.extend(other.box);
  bound.largest_size = std::max(bound.largest_size, other.largest_size);
}

}  // namespace

void CellTree::clear() {
  *this = CellTree();
}

void CellTree::fit(const PolyhedralMesh& mesh, const Positions& positions) {
  const Vector3d anywhere = Vector3d::Constant(kInfinity);
  fit(mesh, positions, positions, AlignedBox3d(-anywhere, anywhere));
}

void CellTree::fit(const PolyhedralMesh& mesh, const Positions& positions_start,
                   const Positions& positions_end, const AlignedBox3d& where) {
  POLYSCALPEL_ASSERT(positions_start.cols() == mesh.numVertices() &&
                     positions_end.cols() == mesh.numVertices());
  if (mesh.numCells() == 0) return clear();
  const int n = mesh.numVertices();
  const bool is_new = isEmpty();
  POLYSCALPEL_ASSERT(is_new || static_cast<int>(positions_.size()) == n);
  const auto keep = [&] {
    positions_.resize(n);
    for (int i = 0; i < n; ++i) positions_[i] = positions_end.col(i);
  };
  if (is_new) keep();

  const auto measureMargin = [&] {
    double way = 0, largest = 0;
    const auto follow = [&](const Positions& positions) {
      for (int i = 0; i < n; ++i) {
        const Vector3d position = positions.col(i);
        way = std::max(way, (position - positions_[i]).cwiseAbs().maxCoeff());
        largest = std::max(largest, position.cwiseAbs().maxCoeff());
      }
    };
    follow(positions_end);
    if (positions_start.data() != positions_end.data()) follow(positions_start);
    margin_ = (1 + kRounding) * way + kRounding * largest;
  };
  measureMargin();
  if (is_new) return build(mesh);
  if (margin_ <= loosest_margin_ || !widened(nodes_[0].bound).box.intersects(where)) return;
  keep();
  measureMargin();
  refit(mesh);
  if (summedArea() > kWorstArea * built_area_) build(mesh);
}

void CellTree::update(const PolyhedralMesh& mesh, const MeshChange& change) {
  if (isEmpty()) return;
  for (const NewVertex& origin : change.new_vertices) {
    POLYSCALPEL_ASSERT(origin.vertex.index() == static_cast<int>(positions_.size()));
    const Vector3d first = positions_[origin.parents[0].index()],
                   second = positions_[origin.parents[1].index()];
    positions_.push_back((1 - origin.weight) * first + origin.weight * second);
  }
  leaf_of_cell_.resize(mesh.cellCapacity(), -1);
  std::vector<int> leaves;  // of the removed cells
  leaves.reserve(change.removed_cells.size());
  for (const CellId cell : change.removed_cells) {
    int& place = leaf_of_cell_[cell.index()];
    leaves.push_back(place);
    Leaf& leaf = leaves_[place];
    const auto end = leaf.entries.begin() + leaf.count;
    const auto entry =
        std::find_if(leaf.entries.begin(), end, [&](const Entry& e) { return e.cell == cell; });
    POLYSCALPEL_ASSERT(entry != end);
    std::move(entry + 1, end, entry);
    --leaf.count;
    place = -1;
  }
  for (const NewCell& cell : change.new_cells) {
    const auto parent =
        std::lower_bound(change.removed_cells.begin(), change.removed_cells.end(), cell.parent);
    POLYSCALPEL_ASSERT(parent != change.removed_cells.end() && *parent == cell.parent);
    insert(leaves[parent - change.removed_cells.begin()], {cell.cell, boundOf(mesh, mesh.cell(cell.cell))});
  }
}

CellTree::Bound CellTree::boundOf(const PolyhedralMesh& mesh, const Cell& cell) const {
  Bound bound;
  for (const VertexId v : cell.vertices) {
    bound.box.extend(positions_[v.index()]);
    bound.largest_size = std::max(bound.largest_size, mesh.localSize(v));
  }
  return bound;
}

int CellTree::makeLeaf(int node) {
  const int leaf = static_cast<int>(leaves_.size());
  leaves_.emplace_back().node = node;
  nodes_[node].leaf = leaf;
  return leaf;
}

void CellTree::build(const PolyhedralMesh& mesh) {
  nodes_.clear();
  leaves_.clear();
  leaf_of_cell_.assign(mesh.cellCapacity(), -1);
  std::vector<Entry> entries;
  entries.reserve(mesh.numCells());
  for (int i = 0; i < mesh.cellCapacity(); ++i) {
    if (mesh.cell(CellId(i)).isAlive()) entries.push_back({CellId(i), boundOf(mesh, mesh.cell(CellId(i)))});
  }
  nodes_.emplace_back();
  buildNode(0, entries, 0, static_cast<int>(entries.size()));
  built_area_ = summedArea();
  double sides = 0;
  for (const Leaf& leaf : leaves_) sides += nodes_[leaf.node].bound.box.sizes().mean();
  loosest_margin_ = kLoosestMargin * sides / static_cast<double>(leaves_.size());
}

/// Halves the entries at the median along the longest side until they go into a leaf.
void CellTree::buildNode(int node, std::vector<Entry>& entries, int begin, int end) {
  if (end - begin <= kBuiltCells) {
    Leaf& leaf = leaves_[makeLeaf(node)];
    for (int i = begin; i < end; ++i) {
      leaf.entries[leaf.count++] = entries[i];
      leaf_of_cell_[entries[i].cell.index()] = nodes_[node].leaf;
    }
    fitNode(node);
    return;
  }
  Bound bound;
  AlignedBox3d centres;
  for (int i = begin; i < end; ++i) {
    extend(bound, entries[i].bound);
    centres.extend(entries[i].bound.box.center());
  }
  int axis = 0;
  centres.sizes().maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  std::nth_element(entries.begin() + begin, entries.begin() + middle, entries.begin() + end,
                   [axis](const Entry& a, const Entry& b) {
                     const double at_a = a.bound.box.min()[axis] + a.bound.box.max()[axis];
                     const double at_b = b.bound.box.min()[axis] + b.bound.box.max()[axis];
                     return std::make_pair(at_a, a.cell.index()) < std::make_pair(at_b, b.cell.index());
                   });
  const int first = static_cast<int>(nodes_.size());
  nodes_[node].bound = bound;
  nodes_[node].first_child = first;
  nodes_.resize(nodes_.size() + 2);
  nodes_[first].parent = nodes_[first + 1].parent = node;
  buildNode(first, entries, begin, middle);
  buildNode(first + 1, entries, middle, end);
}

void CellTree::refit(const PolyhedralMesh& mesh) {
  for (Leaf& leaf : leaves_) {
    for (int i = 0; i < leaf.count; ++i)
      leaf.entries[i].bound = boundOf(mesh, mesh.cell(leaf.entries[i].cell));
  }
  for (int node = static_cast<int>(nodes_.size()) - 1; node >= 0; --node) fitNode(node);
}

void CellTree::fitNode(int index) {
  Node& node = nodes_[index];
  node.bound = Bound();
  if (node.leaf < 0) {
    extend(node.bound, nodes_[node.first_child].bound);
    extend(node.bound, nodes_[node.first_child + 1].bound);
  } else {
    const Leaf& leaf = leaves_[node.leaf];
    for (int i = 0; i < leaf.count; ++i) extend(node.bound, leaf.entries[i].bound);
  }
}

void CellTree::insert(int place, const Entry& entry) {
  if (leaves_[place].count == kLeafCells) halve(place);
  Leaf& leaf = leaves_[place];
  leaf.entries[leaf.count++] = entry;
  leaf_of_cell_[entry.cell.index()] = place;
  for (int node = leaf.node; node >= 0; node = nodes_[node].parent) {
    const Bound before = nodes_[node].bound;
    extend(nodes_[node].bound, entry.bound);
    if (before.box.contains(entry.bound.box) && before.largest_size >= entry.bound.largest_size) break;
  }
}

/// A leaf that is full becomes an inner node; it keeps its lower half itself.
void CellTree::halve(int place) {
  const int node = leaves_[place].node;
  std::vector<Entry> entries(leaves_[place].entries.begin(), leaves_[place].entries.end());
  int axis = 0;
  nodes_[node].bound.box.sizes().maxCoeff(&axis);
  std::sort(entries.begin(), entries.end(), [axis](const Entry& a, const Entry& b) {
    const double at_a = a.bound.box.min()[axis] + a.bound.box.max()[axis];
    const double at_b = b.bound.box.min()[axis] + b.bound.box.max()[axis];
    return std::make_pair(at_a, a.cell.index()) < std::make_pair(at_b, b.cell.index());
  });
  const int first = static_cast<int>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].leaf = -1;
  nodes_[node].first_child = first;
  nodes_[first].parent = nodes_[first + 1].parent = node;
  nodes_[first].leaf = place;
  leaves_[place].node = first;
  makeLeaf(first + 1);
  for (Leaf* leaf : {&leaves_[place], &leaves_.back()}) leaf->count = 0;
  for (int i = 0; i < kLeafCells; ++i) {
    const int target = i < kLeafCells / 2 ? place : nodes_[first + 1].leaf;
    Leaf& leaf = leaves_[target];
    leaf.entries[leaf.count++] = entries[i];
    leaf_of_cell_[entries[i].cell.index()] = target;
  }
  fitNode(first);
  fitNode(first + 1);
}

/// Areas of all boxes, as a multiple of the root's.
double CellTree::summedArea() const {
  double sum = 0;
  for (const Node& node : nodes_) {
    if (!node.bound.box.isEmpty()) sum += halfArea(node.bound.box);
  }
  const double whole = halfArea(nodes_[0].bound.box);
  return whole > 0 ? sum / whole : 0;
}

}  // namespace polyscalpel
