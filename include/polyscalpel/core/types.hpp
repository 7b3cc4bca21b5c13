// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <limits>

#include <Eigen/Core>

namespace polyscalpel {

/// Index of one kind of mesh entity. Distinct kinds do not convert into each other; the default value is
/// "none".
template <class Tag>
class Id {
 public:
  constexpr Id() = default;
  constexpr explicit Id(int index) : index_(index) {}
  constexpr explicit Id(std::size_t index) : index_(static_cast<int>(index)) {}

  /// Position in the arrays of this kind, >= 0 for a valid id.
  constexpr int index() const { return index_; }
  constexpr bool isValid() const { return index_ >= 0; }

  friend constexpr bool operator==(Id a, Id b) { return a.index_ == b.index_; }
  friend constexpr bool operator!=(Id a, Id b) { return a.index_ != b.index_; }
  friend constexpr bool operator<(Id a, Id b) { return a.index_ < b.index_; }

 private:
  int index_ = -1;
};

using VertexId = Id<struct VertexTag>;
using FaceId = Id<struct FaceTag>;
using CellId = Id<struct CellTag>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace polyscalpel

template <class Tag>
struct std::hash<polyscalpel::Id<Tag>> {
  std::size_t operator()(polyscalpel::Id<Tag> id) const noexcept { return std::hash<int>{}(id.index()); }
};
