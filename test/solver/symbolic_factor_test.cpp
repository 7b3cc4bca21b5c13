// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/symbolic_factor.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "support/body_system.hpp"
#include "support/random_block_matrix.hpp"
#include "support/small_bodies.hpp"

namespace polyscalpel {
namespace {

struct Case {
  BlockPattern pattern;
  std::vector<bool> fixed;
};

std::vector<Case> makeCases() {
  std::vector<Case> cases;
  for (const double share : {0.02, 0.2})
    cases.push_back({makeRandomBlockMatrix(80, share, 3).pattern, std::vector<bool>(80, false)});
  for (int i = 0; i < 80; i += 3) cases.back().fixed[i] = true;
  for (const PolyhedralMesh& mesh : {makeTetBeam(3), makePolyhedra()}) {
    const BodySystem system(mesh);
    cases.push_back({toBlockPattern(system.pattern()), system.fixed()});
  }
  return cases;
}

const std::vector<Ordering> kOrderings = {Ordering::kUndecided, Ordering::kMinimumDegree,
                                          Ordering::kNestedDissection};

TEST(SymbolicFactor, OrdersWhatIsNotFixedOnce) {
  for (const Case& of : makeCases()) {
    for (Ordering ordering : kOrderings) {
      SymbolicFactor factor;
      ASSERT_EQ(analyse(of.pattern, of.fixed, ordering, factor), SolveStatus::kSolved);
      EXPECT_NE(ordering, Ordering::kUndecided);
      std::vector<int> free;
      for (int i = 0; i < of.pattern.numVertices(); ++i) {
        if (!of.fixed[i]) free.push_back(i);
      }
      std::sort(factor.order.begin(), factor.order.end());
      EXPECT_EQ(factor.order, free);
    }
  }
}

// Elimination joins all that a column has below its diagonal: the parent has the rows of its children.
TEST(SymbolicFactor, HoldsTheMatrixAndWhatEliminationAdds) {
  for (const Case& of : makeCases()) {
    for (Ordering ordering : kOrderings) {
      SymbolicFactor factor;
      ASSERT_EQ(analyse(of.pattern, of.fixed, ordering, factor), SolveStatus::kSolved);
      std::vector<int> place(of.pattern.numVertices(), -1);
      for (std::size_t k = 0; k < factor.order.size(); ++k) place[factor.order[k]] = static_cast<int>(k);
      std::vector<std::set<int>> rows(factor.order.size());  // of each column, from the diagonal on
      std::vector<std::size_t> supernode_of(factor.order.size());
      int next_column = 0;
      std::size_t num_values = 0;
      for (std::size_t s = 0; s < factor.supernodes.size(); ++s) {
        const SymbolicFactor::Supernode& node = factor.supernodes[s];
        EXPECT_EQ(node.first_column, next_column);
        next_column += node.num_columns;
        const auto first = factor.rows.begin() + node.first_row, last = first + node.num_rows;
        EXPECT_TRUE(std::is_sorted(first, last));
        EXPECT_TRUE(first == last || *first >= next_column);
        for (int column = node.first_column; column < next_column; ++column) {
          supernode_of[column] = s;
          for (int row = column; row < next_column; ++row) rows[column].insert(row);
          rows[column].insert(first, last);
        }
        num_values += 9 * node.num_columns * (node.num_columns + node.num_rows);
      }
      ASSERT_EQ(next_column, static_cast<int>(factor.order.size()));
      EXPECT_EQ(factor.numValues(), num_values);
      for (int j = 0; j < of.pattern.numVertices(); ++j) {
        for (int k = of.pattern.column_start[j]; k < of.pattern.column_start[j + 1]; ++k) {
          const int a = place[of.pattern.row[k]], b = place[j];
          if (a < 0 || b < 0) continue;
          EXPECT_EQ(rows[std::min(a, b)].count(std::max(a, b)), 1u);
        }
      }
      // In postorder what a supernode's children leave is the last that was left.
      std::vector<std::size_t> waiting;
      for (std::size_t s = 0; s < factor.supernodes.size(); ++s) {
        const SymbolicFactor::Supernode& node = factor.supernodes[s];
        const auto parentOf = [&](std::size_t child) {
          return supernode_of[factor.rows[factor.supernodes[child].first_row]];
        };
        while (!waiting.empty() && parentOf(waiting.back()) == s) {
          const SymbolicFactor::Supernode& child = factor.supernodes[waiting.back()];
          for (int k = 0; k < child.num_rows; ++k)
            EXPECT_EQ(rows[node.first_column].count(factor.rows[child.first_row + k]), 1u);
          waiting.pop_back();
        }
        if (node.num_rows > 0) waiting.push_back(s);
      }
      EXPECT_TRUE(waiting.empty());
    }
  }
}

TEST(SymbolicFactor, EverythingFixedLeavesNothing) {
  const BlockPattern pattern = makeRandomBlockMatrix(5, 0.5, 4).pattern;
  SymbolicFactor factor;
  Ordering ordering = Ordering::kUndecided;
  ASSERT_EQ(analyse(pattern, std::vector<bool>(5, true), ordering, factor), SolveStatus::kSolved);
  EXPECT_TRUE(factor.order.empty());
  EXPECT_TRUE(factor.supernodes.empty());
  EXPECT_EQ(factor.numValues(), 0u);
}

}  // namespace
}  // namespace polyscalpel
