// SPDX-License-Identifier: BSD-3-Clause
//
// Y. Chen, T. Davis, W. Hager, S. Rajamanickam, "Algorithm 887: CHOLMOD, Supernodal Sparse Cholesky
// Factorization and Update/Downdate", ACM Transactions on Mathematical Software 35(3), 2008.
#include "polyscalpel/solver/symbolic_factor.hpp"

#include <cstddef>
#include <utility>

#include "cholmod_handles.hpp"
#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

namespace {

/// The graph of the vertices that are not fixed; nine times smaller than that of their unknowns.
class VertexGraph {
 public:
  VertexGraph(const BlockPattern& pattern, const std::vector<bool>& fixed) {
    POLYSCALPEL_ASSERT(static_cast<int>(fixed.size()) == pattern.numVertices());
    place_.assign(fixed.size(), -1);
    // Against the vertices, so that the pattern's lower part is upper here: CHOLMOD permutes a lower one by
    // transposing it twice. Going through the pattern backwards gives columns and rows in them ascending.
    for (std::size_t i = fixed.size(); i-- > 0;) {
      if (fixed[i]) continue;
      place_[i] = static_cast<int>(vertex_.size());
      vertex_.push_back(static_cast<int>(i));
    }
    common_->nmethods = 1;
    common_->method[0].ordering = CHOLMOD_GIVEN;
    common_->postorder = 1;
    // Three unknowns a column. Wider supernodes hold more zeros and are gone through faster.
    common_->nrelax[0] = 2;
    common_->nrelax[1] = 6;
    common_->nrelax[2] = 16;
    const std::size_t size = vertex_.size();
    graph_ = CholmodSparse(
        cholmod_allocate_sparse(size, size, pattern.row.size(), 1, 1, 1, CHOLMOD_PATTERN, common_.get()),
        {common_.get()});
    if (!graph_) return;
    int* const start = static_cast<int*>(graph_->p);
    int* const rows = static_cast<int*>(graph_->i);
    int entry = 0;
    for (std::size_t column = 0; column < size; ++column) {
      start[column] = entry;
      const int vertex = vertex_[column];
      for (int k = pattern.column_start[vertex + 1] - 1; k >= pattern.column_start[vertex]; --k) {
        if (place_[pattern.row[k]] >= 0) rows[entry++] = place_[pattern.row[k]];
      }
    }
    start[size] = entry;
  }

  int size() const { return static_cast<int>(vertex_.size()); }

  bool order(Ordering ordering, std::vector<int>& order) {
    order.resize(vertex_.size());
    if (!graph_) return false;
    return ordering == Ordering::kNestedDissection
               ? cholmod_metis(graph_.get(), nullptr, 0, 1, order.data(), common_.get())
               : cholmod_amd(graph_.get(), nullptr, 0, order.data(), common_.get());
  }

  CholmodFactor analyse(std::vector<int> order) {
    if (!graph_) return nullptr;
    return CholmodFactor(cholmod_analyze_p(graph_.get(), order.data(), nullptr, 0, common_.get()),
                         {common_.get()});
  }

  /// Of the last analysis.
  double operations() { return common_->fl; }
  int vertexAt(int place) const { return vertex_[place]; }

 private:
  CholmodCommon common_;
  std::vector<int> place_, vertex_;
  CholmodSparse graph_;
};

SolveStatus take(const VertexGraph& graph, const CholmodFactor& analysed, SymbolicFactor& factor) {
  if (!analysed) return SolveStatus::kOutOfMemory;
  const cholmod_factor& L = *analysed;
  POLYSCALPEL_ASSERT(L.is_super);
  const int* const permutation = static_cast<const int*>(L.Perm);
  const int* const super = static_cast<const int*>(L.super);
  const int* const first_row = static_cast<const int*>(L.pi);
  const int* const rows = static_cast<const int*>(L.s);
  for (std::size_t k = 0; k < L.n; ++k) factor.order.push_back(graph.vertexAt(permutation[k]));
  for (std::size_t k = 0; k < L.nsuper; ++k) {
    const int num_columns = super[k + 1] - super[k];
    const int num_rows = first_row[k + 1] - first_row[k] - num_columns;
    factor.supernodes.push_back({super[k], num_columns, static_cast<int>(factor.rows.size()), num_rows});
    factor.rows.insert(factor.rows.end(), rows + first_row[k] + num_columns, rows + first_row[k + 1]);
  }
  return SolveStatus::kSolved;
}

}  // namespace

std::size_t SymbolicFactor::numValues() const {
  std::size_t number = 0;
  for (const Supernode& node : supernodes)
    number += 9 * static_cast<std::size_t>(node.num_columns) * (node.num_columns + node.num_rows);
  return number;
}

SolveStatus analyse(const BlockPattern& pattern, const std::vector<bool>& fixed, Ordering& ordering,
                    SymbolicFactor& factor) {
  factor = {};
  VertexGraph graph(pattern, fixed);
  if (graph.size() == 0) return SolveStatus::kSolved;
  const auto analyse_by = [&](Ordering by) {
    std::vector<int> order;
    return graph.order(by, order) ? graph.analyse(std::move(order)) : nullptr;
  };
  if (ordering != Ordering::kUndecided) return take(graph, analyse_by(ordering), factor);
  // Minimum degree takes a millisecond or two, nested dissection ten times that: it must earn it.
  constexpr double kWorthDissection = 0.7;
  constexpr int kFewVertices = 1000;  // their factor takes less time than dissection
  const CholmodFactor by_degree = analyse_by(Ordering::kMinimumDegree);
  if (!by_degree || graph.size() <= kFewVertices) {
    ordering = Ordering::kMinimumDegree;
    return take(graph, by_degree, factor);
  }
  const double operations = graph.operations();
  const CholmodFactor by_dissection = analyse_by(Ordering::kNestedDissection);
  const bool is_worth_it = by_dissection && graph.operations() < kWorthDissection * operations;
  ordering = is_worth_it ? Ordering::kNestedDissection : Ordering::kMinimumDegree;
  return take(graph, is_worth_it ? by_dissection : by_degree, factor);
}

}  // namespace polyscalpel
