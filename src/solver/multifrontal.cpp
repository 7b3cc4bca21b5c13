// SPDX-License-Identifier: BSD-3-Clause
#include "multifrontal.hpp"

#include <algorithm>
#include <memory>

#include <Eigen/Cholesky>

#include "blas.hpp"
#include "one_thread.hpp"

namespace polyscalpel {

namespace {

/// L of a dense matrix in its lower part, half by half (F. G. Gustavson, "Recursion leads to automatic
/// variable blocking for dense linear-algebra algorithms", 1997).
template <class Scalar>
bool factorDense(int size, Scalar* A, int leading) {
  constexpr int kSmall = 24;
  if (size <= kSmall) {
    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
    Eigen::Ref<Matrix> part(
        Eigen::Map<Matrix, 0, Eigen::OuterStride<>>(A, size, size, Eigen::OuterStride<>(leading)));
    return Eigen::LLT<Eigen::Ref<Matrix>>(part).info() == Eigen::Success;
  }
  const int half = (size / 2 + 7) / 8 * 8, rest = size - half;
  Scalar* const below = A + half;
  Scalar* const corner = below + static_cast<std::ptrdiff_t>(half) * leading;
  if (!factorDense(half, A, leading)) return false;
  solveTransposedRight(rest, half, A, leading, below, leading);
  subtractSquare(rest, half, below, leading, corner, leading);
  return factorDense(rest, corner, leading);
}

/// The matrix's blocks by the column of L that they are in.
class PermutedBlocks {
 public:
  struct Entry {
    int row, block;
    bool is_transposed;
  };

  PermutedBlocks(const SymbolicFactor& symbolic, const BlockPattern& pattern)
      : first_(symbolic.order.size() + 1, 0) {
    std::vector<int> place(pattern.numVertices(), -1);
    for (std::size_t k = 0; k < symbolic.order.size(); ++k) place[symbolic.order[k]] = static_cast<int>(k);
    const auto forEach = [&](const auto& visit) {
      for (int j = 0; j < pattern.numVertices(); ++j) {
        if (place[j] < 0) continue;
        for (int k = pattern.column_start[j]; k < pattern.column_start[j + 1]; ++k) {
          const int row = place[pattern.row[k]], column = place[j];
          if (row >= 0) visit(std::min(row, column), Entry{std::max(row, column), k, row < column});
        }
      }
    };
    forEach([&](int column, const Entry&) { ++first_[column + 1]; });
    for (std::size_t k = 1; k < first_.size(); ++k) first_[k] += first_[k - 1];
    entries_.resize(first_.back());
    std::vector<int> next(first_.begin(), first_.end() - 1);
    forEach([&](int column, const Entry& entry) { entries_[next[column]++] = entry; });
  }

  template <class Visit>
  void forEachOf(int column, const Visit& visit) const {
    for (int k = first_[column]; k < first_[column + 1]; ++k) visit(entries_[k]);
  }

 private:
  std::vector<int> first_;
  std::vector<Entry> entries_;
};

template <class Scalar>
class Fronts {
 public:
  Fronts(const SymbolicFactor& symbolic, const BlockPattern& pattern, const Blocks& blocks)
      : symbolic_(symbolic),
        blocks_(blocks),
        permuted_(symbolic, pattern),
        place_in_front_(symbolic.order.size(), 0) {
    findChildren();
    stack_.reset(new Scalar[stackSize()]);
  }

  /// panel: zeros.
  SolveStatus factor(std::size_t index, const PanelPlace& place, Scalar smallest_pivot, Scalar* panel) {
    const SymbolicFactor::Supernode& node = symbolic_.supernodes[index];
    const int columns = 3 * node.num_columns, below = 3 * node.num_rows;
    for (int k = 0; k < node.num_columns; ++k) place_in_front_[node.first_column + k] = k;
    for (int k = 0; k < node.num_rows; ++k)
      place_in_front_[symbolic_.rows[node.first_row + k]] = node.num_columns + k;
    gatherBlocks(node, panel, place.leading);
    if (!is_finite_) return SolveStatus::kNotFinite;
    diagonal_.resize(columns);
    for (int k = 0; k < columns; ++k) diagonal_[k] = panel[k * (place.leading + std::ptrdiff_t(1))];
    // What is left for the parent, on top of what the children have left here and then in its place.
    const std::size_t left_size = leftSize(node);
    const std::size_t first = top_;
    Scalar* const left = stack_.get() + first;
    std::fill_n(left, left_size, Scalar(0));
    std::size_t bottom = first;
    for (int child = 0; child < num_children_[index]; ++child) {
      const Left& of_child = lefts_.back();
      addLeft(of_child, node, panel, place.leading, left);
      bottom = of_child.first_value;
      lefts_.pop_back();
    }
    if (!factorDense(columns, panel, place.leading)) return SolveStatus::kNotPositiveDefinite;
    for (int k = 0; k < columns; ++k) {
      const Scalar pivot = panel[k * (place.leading + std::ptrdiff_t(1))];
      if (pivot * pivot < smallest_pivot * diagonal_[k]) return SolveStatus::kNotPositiveDefinite;
    }
    if (below > 0) {
      solveTransposedRight(below, columns, panel, place.leading, panel + columns, place.leading);
      subtractSquare(below, columns, panel + columns, place.leading, left, below);
      if (bottom != first) std::copy_n(left, left_size, stack_.get() + bottom);
      lefts_.push_back({index, bottom});
    }
    top_ = bottom + left_size;
    return SolveStatus::kSolved;
  }

 private:
  struct Left {
    std::size_t supernode, first_value;
  };

  // In postorder the children of a supernode are the last ones that have left anything.
  void findChildren() {
    std::vector<int> supernode_of(symbolic_.order.size());
    const auto& nodes = symbolic_.supernodes;
    num_children_.assign(nodes.size(), 0);
    for (std::size_t s = 0; s < nodes.size(); ++s)
      std::fill_n(supernode_of.begin() + nodes[s].first_column, nodes[s].num_columns, static_cast<int>(s));
    for (const auto& node : nodes) {
      if (node.num_rows > 0) ++num_children_[supernode_of[symbolic_.rows[node.first_row]]];
    }
  }

  static std::size_t leftSize(const SymbolicFactor::Supernode& node) {
    return 9 * static_cast<std::size_t>(node.num_rows) * node.num_rows;
  }
  // A supernode's part is made on top of its children's and takes their place.
  std::size_t stackSize() const {
    std::size_t top = 0, most = 0;
    std::vector<std::size_t> sizes;
    for (std::size_t s = 0; s < symbolic_.supernodes.size(); ++s) {
      const std::size_t size = leftSize(symbolic_.supernodes[s]);
      most = std::max(most, top + size);
      for (int child = 0; child < num_children_[s]; ++child) {
        top -= sizes.back();
        sizes.pop_back();
      }
      if (size == 0) continue;
      sizes.push_back(size);
      top += size;
    }
    return most;
  }

  void gatherBlocks(const SymbolicFactor::Supernode& node, Scalar* panel, int leading) {
    for (int k = 0; k < node.num_columns; ++k) {
      permuted_.forEachOf(node.first_column + k, [&](const PermutedBlocks::Entry& entry) {
        const Eigen::Matrix3d& A = blocks_[entry.block];
        is_finite_ = is_finite_ && A.allFinite();
        Scalar* const to =
            panel + 3 * static_cast<std::ptrdiff_t>(k) * leading + 3 * place_in_front_[entry.row];
        for (int c = 0; c < 3; ++c) {
          for (int r = 0; r < 3; ++r)
            to[static_cast<std::ptrdiff_t>(c) * leading + r] =
                static_cast<Scalar>(entry.is_transposed ? A(c, r) : A(r, c));
        }
      });
    }
  }

  // Row by row of the child, those together that are so here too.
  void addLeft(const Left& of_child, const SymbolicFactor::Supernode& node, Scalar* panel, int leading,
               Scalar* left) {
    const SymbolicFactor::Supernode& child = symbolic_.supernodes[of_child.supernode];
    const int size = 3 * child.num_rows, below = 3 * node.num_rows, columns = 3 * node.num_columns;
    runs_.clear();
    for (int k = 0; k < child.num_rows; ++k) {
      const int place = place_in_front_[symbolic_.rows[child.first_row + k]];
      if (runs_.empty() || place != runs_.back().place + k - runs_.back().first)
        runs_.push_back({k, 0, place});
      ++runs_.back().count;
    }
    const Scalar* from = stack_.get() + of_child.first_value;
    for (std::size_t of_column = 0; of_column < runs_.size(); ++of_column) {
      for (int j = 0; j < 3 * runs_[of_column].count; ++j, from += size) {
        const std::ptrdiff_t column = 3 * runs_[of_column].place + j;
        Scalar* const to =
            column < columns ? panel + column * leading : left + (column - columns) * below - columns;
        int skipped = j / 3 * 3;  // above the diagonal block
        for (std::size_t r = of_column; r < runs_.size(); ++r, skipped = 0) {
          const Scalar* const run = from + 3 * runs_[r].first;
          Scalar* const to_run = to + 3 * runs_[r].place;
          for (int i = skipped; i < 3 * runs_[r].count; ++i) to_run[i] += run[i];
        }
      }
    }
  }

  const SymbolicFactor& symbolic_;
  const Blocks& blocks_;
  PermutedBlocks permuted_;
  bool is_finite_ = true;            // of the blocks gathered
  std::vector<int> place_in_front_;  // of rows of L, as of the supernode at hand
  std::vector<int> num_children_;
  std::unique_ptr<Scalar[]> stack_;
  std::size_t top_ = 0;
  std::vector<Left> lefts_;
  struct Run {
    int first, count, place;  // of vertices
  };
  std::vector<Run> runs_;
  std::vector<Scalar> diagonal_;
};

}  // namespace

template <class Scalar>
SolveStatus factorMultifrontal(const SymbolicFactor& symbolic, const BlockPattern& pattern,
                               const Blocks& blocks, const std::vector<PanelPlace>& panels,
                               Scalar smallest_pivot, std::vector<Scalar>& values) {
  keepBlasToOneThread();
  Fronts<Scalar> fronts(symbolic, pattern, blocks);
  for (std::size_t s = 0; s < symbolic.supernodes.size(); ++s) {
    const SolveStatus status = fronts.factor(s, panels[s], smallest_pivot, &values[panels[s].first_value]);
    if (status != SolveStatus::kSolved) return status;
  }
  return SolveStatus::kSolved;
}

template SolveStatus factorMultifrontal<float>(const SymbolicFactor&, const BlockPattern&, const Blocks&,
                                               const std::vector<PanelPlace>&, float, std::vector<float>&);
template SolveStatus factorMultifrontal<double>(const SymbolicFactor&, const BlockPattern&, const Blocks&,
                                                const std::vector<PanelPlace>&, double, std::vector<double>&);

}  // namespace polyscalpel
