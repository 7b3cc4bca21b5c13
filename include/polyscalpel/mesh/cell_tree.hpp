// SPDX-License-Identifier: BSD-3-Clause
//
// Finds the cells of a deformed body near something without a pass over all cells.
//
// Neither Eigen's KdBVH (unsupported/Eigen/BVH) nor CGAL's AABB_tree serves here: both are built once for
// good. They can neither follow moving vertices nor take in the cells of a cut, and building one anew at
// every step of a tool costs as much as the pass that it saves.
#pragma once

#include <array>
#include <deque>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Binary tree of the bounding boxes of cells. The boxes hold for positions that are kept; as the body moves,
/// they serve with a margin, the furthest way of any vertex since, until that grows too large.
///
/// Everything happens at fixed amounts of motion and numbers of cells, never by time: the same calls give the
/// same tree. A value: a copy is independent.
class CellTree {
 public:
  /// What is known of some cells: all lie in the box, and the smallest localSize of a cell's vertices is at
  /// most largest_size.
  struct Bound {
    Eigen::AlignedBox3d box;  ///< [m]
    double largest_size = 0;  ///< [m]
  };

  /// A tree of nothing known: every cell is near everything.
  CellTree() = default;

  /// Makes the tree hold for all positions (3 x n [m]) on the straight ways from start to end. Costs a look
  /// at each vertex; the boxes are fitted anew, from the leaves up, when a vertex has gone further than a
  /// quarter of the mean side of the leaves. `where`: the region that will be asked for; as long as the body
  /// is clear of it nothing is fitted. The tree is built anew when it is empty, or when the summed area of
  /// its boxes, as a multiple of the whole body's, has doubled since it was built: pieces have drifted
  /// apart, or the cells have become many more.
  void fit(const PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions_start,
           const Eigen::Ref<const Eigen::Matrix3Xd>& positions_end, const Eigen::AlignedBox3d& where);
  /// For positions at rest, wherever.
  void fit(const PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

  /// Follows a change of the mesh: new cells take the place of those that they are parts of. Costs what the
  /// change has touched. New vertices are taken to lie between their parents, in every position.
  void update(const PolyhedralMesh& mesh, const MeshChange& change);

  /// Back to nothing known.
  void clear();
  bool isEmpty() const { return nodes_.empty(); }

  /// Calls visit(CellId) for at least those cells for whose bounding box is_near(const Bound&) holds, in a
  /// reproducible order, until it returns false. is_near may not be false for a box that holds another for
  /// which it is true.
  template <class IsNear, class Visit>
  void visit(const PolyhedralMesh& mesh, const IsNear& is_near, const Visit& visit) const;

 private:
  static constexpr int kLeafCells = 8;   ///< a leaf of more is halved
  static constexpr int kBuiltCells = 6;  ///< that a leaf has at most when the tree is built

  struct Entry {
    CellId cell;
    Bound bound;
  };
  struct Leaf {
    int node = 0;
    int count = 0;
    std::array<Entry, kLeafCells> entries;
  };
  struct Node {
    Bound bound;
    int parent = -1;
    int first_child = -1;  ///< the second one follows it; -1 for a leaf
    int leaf = -1;
  };

  void build(const PolyhedralMesh& mesh);
  void buildNode(int node, std::vector<Entry>& entries, int begin, int end);
  void refit(const PolyhedralMesh& mesh);
  Bound boundOf(const PolyhedralMesh& mesh, const Cell& cell) const;
  int makeLeaf(int node);
  void insert(int leaf, const Entry& entry);
  void halve(int leaf);
  void fitNode(int node);
  double summedArea() const;
  Bound widened(const Bound& bound) const {
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(margin_);
    return {{bound.box.min() - margin, bound.box.max() + margin}, bound.largest_size};
  }

  std::vector<Node> nodes_;                 ///< children behind their parents; the root first
  std::deque<Leaf> leaves_;                 ///< a leaf more moves no other, and they are large
  std::vector<int> leaf_of_cell_;           ///< by cell id, -1 for none
  std::vector<Eigen::Vector3d> positions_;  ///< for which the boxes hold without margin [m]
  double margin_ = 0;                       ///< [m]
  double loosest_margin_ = 0;               ///< beyond which boxes are fitted anew [m]
  double built_area_ = 0;                   ///< summedArea() when it was built
};

template <class IsNear, class Visit>
void CellTree::visit(const PolyhedralMesh& mesh, const IsNear& is_near, const Visit& visit) const {
  if (isEmpty()) {
    for (int i = 0; i < mesh.cellCapacity(); ++i) {
      if (mesh.cell(CellId(i)).isAlive() && !visit(CellId(i))) return;
    }
    return;
  }
  // Depth first; a tree of medians is no deeper than this unless the same few cells are cut again and again.
  std::vector<int> pending;
  pending.reserve(64);
  pending.push_back(0);
  while (!pending.empty()) {
    const Node& node = nodes_[pending.back()];
    pending.pop_back();
    if (!is_near(widened(node.bound))) continue;
    if (node.leaf < 0) {
      pending.push_back(node.first_child + 1);
      pending.push_back(node.first_child);
      continue;
    }
    const Leaf& leaf = leaves_[node.leaf];
    for (int i = 0; i < leaf.count; ++i) {
      if (is_near(widened(leaf.entries[i].bound)) && !visit(leaf.entries[i].cell)) return;
    }
  }
}

}  // namespace polyscalpel
