// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/piece_tracker.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {
namespace {

/// Cells reached from some cells of a piece, in the order in which they were reached.
struct Flood {
  std::vector<CellId> cells;
  std::size_t next = 0;  ///< the first whose neighbours have not been looked at
};

/// Cells joined to the first one by faces.
std::vector<CellId> collect(const PolyhedralMesh& mesh, CellId first, std::vector<int>& marks, int mark) {
  std::vector<CellId> cells{first};
  marks[first.index()] = mark;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (const FaceId face : mesh.cell(cells[i]).faces) {
      const CellId other = mesh.neighbour(face, cells[i]);
      if (!other.isValid() || marks[other.index()] == mark) continue;
      marks[other.index()] = mark;
      cells.push_back(other);
    }
  }
  return cells;
}

CellId smallest(const std::vector<CellId>& cells) {
  return *std::min_element(cells.begin(), cells.end());
}

}  // namespace

PieceTracker::PieceTracker(const PolyhedralMesh& mesh) : pieces_(findPieces(mesh)) {
  num_cells_.assign(pieces_.count, 0);
  members_.assign(pieces_.count, CellId());
  flood_.assign(mesh.cellCapacity(), -1);
  for (int i = 0; i < mesh.cellCapacity(); ++i) {
    const int piece = pieces_.piece_of_cell[i];
    if (piece < 0) continue;
    if (num_cells_[piece]++ == 0) members_[piece] = CellId(i);
  }
}

void PieceTracker::update(const PolyhedralMesh& mesh, const MeshChange& change) {
  std::vector<int>& piece_of_cell = pieces_.piece_of_cell;
  piece_of_cell.resize(mesh.cellCapacity(), -1);
  flood_.resize(mesh.cellCapacity(), -1);

  // Whatever has lost a neighbour is a cell that changed or that is new, so each part of a divided piece has
  // such a cell.
  std::map<int, std::vector<CellId>> suspects;
  std::vector<int> emptied;
  for (const NewCell& cell : change.new_cells) {
    const int piece = piece_of_cell[cell.parent.index()];
    POLYSCALPEL_ASSERT(piece >= 0);
    piece_of_cell[cell.cell.index()] = piece;
    ++num_cells_[piece];
    suspects[piece].push_back(cell.cell);
  }
  for (const CellId cell : change.changed_cells) suspects[piece_of_cell[cell.index()]].push_back(cell);
  for (const CellId cell : change.removed_cells) {
    int& piece = piece_of_cell[cell.index()];
    if (--num_cells_[piece] == 0) emptied.push_back(piece);
    piece = -1;
  }
  for (const auto& [piece, cells] : suspects) {
    refreshMember(mesh, piece, cells);
    divide(mesh, piece, cells);
  }
  removeEmptyPieces(mesh, std::move(emptied));
}

/// A piece that lives on has its member, or a part of it, or a cell that changed.
void PieceTracker::refreshMember(const PolyhedralMesh& mesh, int piece,
                                 const std::vector<CellId>& candidates) {
  if (!mesh.cell(members_[piece]).isAlive()) members_[piece] = candidates.front();
}

/// Floods from each suspect, in turns of one cell. Floods that meet become one; one that comes to its end is
/// a part of its own; the last one needs no end.
void PieceTracker::divide(const PolyhedralMesh& mesh, int piece, const std::vector<CellId>& suspects) {
  std::vector<Flood> floods(suspects.size());
  std::vector<int> joined(suspects.size());  // a forest: the flood that each has become part of
  std::iota(joined.begin(), joined.end(), 0);
  const auto find = [&](int flood) {
    while (joined[flood] != flood) flood = joined[flood] = joined[joined[flood]];
    return flood;
  };
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    floods[i].cells.push_back(suspects[i]);
    flood_[suspects[i].index()] = static_cast<int>(i);
  }
  std::size_t open = suspects.size();
  const auto join = [&](int a, int b) {
    if (floods[a].cells.size() < floods[b].cells.size()) std::swap(a, b);
    Flood& into = floods[a];
    Flood& from = floods[b];
    // What both have still to look at goes to the end, what is done before it.
    const auto done = from.cells.begin() + from.next;
    into.cells.insert(into.cells.end(), done, from.cells.end());
    into.cells.insert(into.cells.begin() + into.next, from.cells.begin(), done);
    into.next += from.next;
    from = Flood();
    joined[b] = a;
    --open;
  };
  // The neighbours of one cell. Returns whether there was one to look at.
  const auto advance = [&](int flood) {
    if (floods[flood].next == floods[flood].cells.size()) return false;
    const CellId cell = floods[flood].cells[floods[flood].next++];
    for (const FaceId face : mesh.cell(cell).faces) {
      const CellId other = mesh.neighbour(face, cell);
      if (!other.isValid()) continue;
      const int met = flood_[other.index()];
      if (met < 0) {
        flood_[other.index()] = flood;
        floods[flood].cells.push_back(other);
      } else if (find(met) != flood) {
        join(flood, find(met));
        flood = find(flood);
      }
    }
    return true;
  };
  // The suspects first: most often they hang together, and there is nothing to flood.
  for (std::size_t i = 0; i < suspects.size() && open > 1; ++i) {
    for (const FaceId face : mesh.cell(suspects[i]).faces) {
      const CellId other = mesh.neighbour(face, suspects[i]);
      if (!other.isValid() || flood_[other.index()] < 0) continue;
      const int a = find(static_cast<int>(i)), b = find(flood_[other.index()]);
      if (a != b) join(a, b);
    }
  }
  std::vector<int> active;
  for (std::size_t i = 0; i < suspects.size(); ++i) {
    if (find(static_cast<int>(i)) == static_cast<int>(i)) active.push_back(static_cast<int>(i));
  }
  std::vector<std::vector<CellId>> parts;  // those that came to their end
  while (active.size() > 1) {
    std::vector<int> still_active;
    for (const int flood : active) {
      if (find(flood) != flood) continue;
      if (advance(flood)) {
        still_active.push_back(find(flood));
      } else if (open > 1) {
        parts.push_back(floods[flood].cells);
        --open;
      } else {
        still_active.push_back(flood);
      }
    }
    std::sort(still_active.begin(), still_active.end());
    still_active.erase(std::unique(still_active.begin(), still_active.end()), still_active.end());
    active.clear();
    for (const int flood : still_active) {
      if (find(flood) == flood) active.push_back(flood);
    }
  }
  for (const Flood& flood : floods) {
    for (const CellId cell : flood.cells) flood_[cell.index()] = -1;
  }
  if (parts.empty()) return;

  for (const auto& part : parts) num_cells_[piece] -= static_cast<int>(part.size());
  const int rest = num_cells_[piece];
  const CellId in_rest = floods[active.front()].cells.front();
  const auto largest = std::max_element(parts.begin(), parts.end(),
                                        [](const auto& a, const auto& b) { return a.size() < b.size(); });
  if (rest <= static_cast<int>(largest->size())) {
    // The rest is no larger than what has been flooded already, and may not be the one to keep the number.
    parts.push_back(collect(mesh, in_rest, flood_, 0));
    for (const CellId cell : parts.back()) flood_[cell.index()] = -1;
    const auto keeper = std::min_element(parts.begin(), parts.end(), [](const auto& a, const auto& b) {
      return a.size() != b.size() ? a.size() > b.size() : smallest(a) < smallest(b);
    });
    num_cells_[piece] = static_cast<int>(keeper->size());
    members_[piece] = keeper->front();
    parts.erase(keeper);
  } else {
    members_[piece] = in_rest;
  }
  std::sort(parts.begin(), parts.end(),
            [](const auto& a, const auto& b) { return smallest(a) < smallest(b); });
  for (const auto& part : parts) {
    for (const CellId cell : part) pieces_.piece_of_cell[cell.index()] = pieces_.count;
    num_cells_.push_back(static_cast<int>(part.size()));
    members_.push_back(part.front());
    ++pieces_.count;
  }
}

void PieceTracker::removeEmptyPieces(const PolyhedralMesh& mesh, std::vector<int> emptied) {
  std::sort(emptied.begin(), emptied.end());
  for (; !emptied.empty(); emptied.pop_back()) {
    const int piece = emptied.back(), last = pieces_.count - 1;
    if (num_cells_[piece] > 0) continue;  // its cells went, but parts of them came
    if (piece != last) {
      for (const CellId cell : collect(mesh, members_[last], flood_, 0)) {
        flood_[cell.index()] = -1;
        pieces_.piece_of_cell[cell.index()] = piece;
      }
      num_cells_[piece] = num_cells_[last];
      members_[piece] = members_[last];
    }
    num_cells_.pop_back();
    members_.pop_back();
    --pieces_.count;
  }
}

}  // namespace polyscalpel
