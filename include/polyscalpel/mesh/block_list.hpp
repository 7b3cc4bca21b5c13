// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace polyscalpel {

/// A list that grows by blocks: a cut that adds one face to a mesh does not move all others, but those of one
/// block at most, the last of a copied list. Boost's deque moves none, but finding an element in it costs
/// more than most of what a cut does with one.
template <class T>
class BlockList {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

  T& operator[](std::size_t i) { return blocks_[i / kBlock][i % kBlock]; }
  const T& operator[](std::size_t i) const { return blocks_[i / kBlock][i % kBlock]; }
  T& back() { return blocks_.back().back(); }
  const T& back() const { return blocks_.back().back(); }

  void push_back(T value) {
    if (size_ % kBlock == 0) blocks_.emplace_back();
    blocks_.back().reserve(kBlock);
    blocks_.back().push_back(std::move(value));
    ++size_;
  }
  void pop_back() {
    blocks_.back().pop_back();
    --size_;
    if (size_ % kBlock == 0) blocks_.pop_back();
  }

 private:
  static constexpr std::size_t kBlock = 512;
  std::vector<std::vector<T>> blocks_;  ///< all full but the last
  std::size_t size_ = 0;
};

}  // namespace polyscalpel
