// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/core/row_pattern.hpp"

#include <algorithm>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

int RowPattern::find(int i, int j) const {
  POLYSCALPEL_ASSERT(i >= 0 && i < numVertices());
  const auto first = column.begin() + rows[i].first, last = first + rows[i].count;
  const auto found = std::lower_bound(first, last, j);
  return found != last && *found == j ? static_cast<int>(found - column.begin()) : -1;
}

}  // namespace polyscalpel
