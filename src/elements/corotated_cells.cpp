// SPDX-License-Identifier: BSD-3-Clause
//
// How a CorotatedBody follows its mesh: cells, corners and rows.
#include <algorithm>

#include "corotated_layout.hpp"
#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

namespace {

int kindOf(int num_vertices, int num_modes) {
  return 2 * num_vertices + (num_modes > 0 ? 1 : 0);
}

}  // namespace

void CorotatedBody::makeBatch(int num_vertices, int num_modes) {
  const int batch = static_cast<int>(batches_.size());
  Batch made;
  made.num_vertices = num_vertices;
  made.num_modes = num_modes;
  made.first_corner = static_cast<int>(vertices_.size());
  made.first_number = static_cast<int>(numbers_.size());
  made.first_pair = num_pairs_;
  vertices_.resize(vertices_.size() + kBatchSize * num_vertices, 0);
  numbers_.resize(numbers_.size() + Layout(num_vertices, num_modes).size, 0.0);
  if (num_modes > 0) num_pairs_ += kBatchSize * num_vertices * (num_vertices - 1) / 2;
  most_modes_ = std::max(most_modes_, num_modes);
  batches_.push_back(made);
  densities_.resize(kBatchSize * batches_.size(), 0.0);
  mass_integrals_.resize(kBatchSize * batches_.size());
  rotations_.resize(36 * batches_.size(), 0.0);
  spins_.resize(12 * batches_.size(), 0.0);
  for (int k = 0; k < 12; ++k) rotations_[36 * batch + (k / 4) * 16 + k % 4] = 1;
  std::vector<int>& places = free_places_[kindOf(num_vertices, num_modes)];
  for (int lane = kBatchSize - 1; lane >= 0; --lane) places.push_back(kBatchSize * batch + lane);
}

void CorotatedBody::addCell(const Cell& cell) {
  const int n = static_cast<int>(cell.vertices->size());
  const Stabilisation& stabilisation = cell.element->stabilisation;
  const int m = stabilisation.isEmpty() ? 0 : static_cast<int>(stabilisation.numModes());
  const int kind = kindOf(n, m);
  if (kind >= static_cast<int>(free_places_.size())) free_places_.resize(kind + 1);
  if (free_places_[kind].empty()) makeBatch(n, m);
  const int place = free_places_[kind].back();
  free_places_[kind].pop_back();
  if (cell.id.index() >= static_cast<int>(place_of_cell_.size()))
    place_of_cell_.resize(cell.id.index() + 1, -1);
  POLYSCALPEL_ASSERT(place_of_cell_[cell.id.index()] < 0);
  place_of_cell_[cell.id.index()] = place;
  Batch& batch = batches_[place / kBatchSize];
  const int lane = place % kBatchSize;
  POLYSCALPEL_ASSERT(batch.num_modes == m);
  batch.cells[lane] = cell.id.index();
  for (int i = 0; i < n; ++i)
    vertices_[batch.first_corner + kBatchSize * i + lane] = (*cell.vertices)[i].index();
  const Layout layout(n, m);
  double* const numbers = &numbers_[batch.first_number + lane];
  const auto put = [&](int at, double value) { numbers[at] = value; };
  for (int i = 0; i < n; ++i) {
    for (int c = 0; c < 3; ++c)
      put(layout.gradients + kBatchSize * (3 * i + c), cell.element->mean_gradient(c, i));
    for (int k = 0; k < m; ++k) put(layout.modes + kBatchSize * (i * m + k), stabilisation.modes(i, k));
  }
  put(layout.volume, cell.element->volume);
  put(layout.lambda, cell.moduli.lambda_pa);
  put(layout.mu, cell.moduli.mu_pa);
  for (int row = 0, entry = 0; row < 3 * m; ++row) {
    for (int column = 0; column <= row; ++column, ++entry)
      put(layout.stiffness + kBatchSize * entry, stabilisation.stiffness(row, column));
  }
  for (int k = 0; k < 3 * m; ++k)
    put(layout.rest_modes + kBatchSize * k, stabilisation.rest_modes(k % 3, k / 3));
  densities_[place] = cell.density_kg_m3;
  mass_integrals_[place] = cell.element->mass_integral;
  for (int k = 0; k < 9; ++k)
    rotations_[36 * (place / kBatchSize) + kBatchSize * k + lane] = k % 4 == 0 ? 1 : 0;
  for (int k = 0; k < 3; ++k) spins_[12 * (place / kBatchSize) + kBatchSize * k + lane] = 0;
}

void CorotatedBody::removeCell(CellId cell) {
  const int place = place_of_cell_[cell.index()];
  POLYSCALPEL_ASSERT(place >= 0);
  place_of_cell_[cell.index()] = -1;
  Batch& batch = batches_[place / kBatchSize];
  const int lane = place % kBatchSize;
  batch.cells[lane] = -1;
  for (int i = 0; i < batch.num_vertices; ++i) {
    int& vertex = vertices_[batch.first_corner + kBatchSize * i + lane];
    Span& span = corners_of_vertex_[vertex];
    const auto first = corners_.begin() + span.first, last = first + span.count;
    const auto left = std::find_if(first, last, [&](const Corner& corner) { return corner.place == place; });
    POLYSCALPEL_ASSERT(left != last);
    std::copy(left + 1, last, left);
    --span.count;
    ++num_left_corners_;
    vertex = 0;
  }
  const int size = Layout(batch.num_vertices, batch.num_modes).size;
  for (int k = lane; k < size; k += kBatchSize) numbers_[batch.first_number + k] = 0;
  mass_integrals_[place].resize(0, 0);
  free_places_[kindOf(batch.num_vertices, batch.num_modes)].push_back(place);
}

void CorotatedBody::update(int num_vertices, const std::vector<CellId>& removed,
                           const std::vector<Cell>& added) {
  std::vector<char> is_touched(num_vertices, 0);
  const auto touch = [&](CellId cell) {
    const int place = place_of_cell_[cell.index()];
    const Batch& batch = batches_[place / kBatchSize];
    for (int i = 0; i < batch.num_vertices; ++i)
      is_touched[vertices_[batch.first_corner + kBatchSize * i + place % kBatchSize]] = 1;
  };
  for (const CellId cell : removed) {
    touch(cell);
    removeCell(cell);
  }
  for (const Cell& cell : added) {
    addCell(cell);
    touch(cell.id);
  }
  corners_of_vertex_.resize(num_vertices);
  pattern_.rows.resize(num_vertices);
  first_pair_.resize(num_vertices, 0);
  first_stabiliser_.resize(num_vertices, 0);
  rotation_places_.resize(kCellsAMean * static_cast<std::size_t>(num_vertices), 0);
  rotation_weights_.resize(kCellsAMean * static_cast<std::size_t>(num_vertices), 0.0);
  updateCorners(added);
  turned_float_.is_current = turned_double_.is_current = false;
  still_.clear();
  batch_is_still_.clear();
  std::vector<int> touched;
  int num_touched_entries = 0;
  for (int i = 0; i < num_vertices; ++i) {
    if (!is_touched[i]) continue;
    touched.push_back(i);
    num_touched_entries += pattern_.rows[i].count;
  }
  // What rows leave behind is taken back once it is more than what is in use.
  if (2 * (num_left_entries_ + num_touched_entries) > pattern_.capacity()) {
    touched.clear();
    for (int i = 0; i < num_vertices; ++i) touched.push_back(i);
    pattern_.column.clear();
    pattern_.mirror.clear();
    incidences_.clear();
    entry_masses_.clear();
    entry_shears_.clear();
    pairs_.clear();
    stabilisers_.clear();
    num_left_entries_ = 0;
  } else {
    num_left_entries_ += num_touched_entries;
  }
  makeRows(touched);
  selectRows();
}

// Corners of new cells go behind those that their vertices have, and all of a vertex move to the end of the
// pool, which is packed anew once more of it is left behind than in use.
void CorotatedBody::updateCorners(const std::vector<Cell>& added) {
  const auto cellAt = [&](const Corner& corner) {
    return batches_[corner.place / kBatchSize].cells[corner.place % kBatchSize];
  };
  struct NewCorner {
    int vertex, cell;
    Corner corner;
  };
  std::vector<NewCorner> corners;
  for (const Cell& cell : added) {
    const int place = place_of_cell_[cell.id.index()];
    const Batch& batch = batches_[place / kBatchSize];
    for (int i = 0; i < batch.num_vertices; ++i) {
      const int corner = batch.first_corner + kBatchSize * i + place % kBatchSize;
      corners.push_back({vertices_[corner], cell.id.index(), {corner, place}});
    }
  }
  std::sort(corners.begin(), corners.end(), [](const NewCorner& a, const NewCorner& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.cell < b.cell;
  });
  std::vector<Corner> together;
  for (std::size_t k = 0; k < corners.size();) {
    Span& span = corners_of_vertex_[corners[k].vertex];
    together.assign(corners_.begin() + span.first, corners_.begin() + span.first + span.count);
    for (const int vertex = corners[k].vertex; k < corners.size() && corners[k].vertex == vertex; ++k)
      together.push_back(corners[k].corner);
    std::sort(together.begin(), together.end(),
              [&](const Corner& a, const Corner& b) { return cellAt(a) < cellAt(b); });
    num_left_corners_ += span.count;
    span = {static_cast<int>(corners_.size()), static_cast<int>(together.size())};
    corners_.insert(corners_.end(), together.begin(), together.end());
  }
  if (2 * num_left_corners_ <= static_cast<int>(corners_.size())) return;
  together.clear();
  for (Span& span : corners_of_vertex_) {
    const int first = static_cast<int>(together.size());
    together.insert(together.end(), corners_.begin() + span.first,
                    corners_.begin() + span.first + span.count);
    span.first = first;
  }
  corners_.swap(together);
  num_left_corners_ = 0;
}

// Neighbours ascending; what cells add to the block of a neighbour above follows by ascending cell id.
void CorotatedBody::makeRow(int vertex) {
  meetings_.clear();
  int order = 0;
  const Span& span = corners_of_vertex_[vertex];
  for (int k = span.first; k < span.first + span.count; ++k) {
    const Corner& corner = corners_[k];
    const Batch& batch = batches_[corner.place / kBatchSize];
    const int lane = corner.place % kBatchSize, n = batch.num_vertices;
    const int own = (corner.corner - batch.first_corner) / kBatchSize;
    const Layout layout(n, batch.num_modes);
    const double* const numbers = &numbers_[batch.first_number + lane];
    const auto gradient = [&](int i) {
      const double* const g = numbers + layout.gradients + kBatchSize * 3 * i;
      return Eigen::Vector3d(g[0], g[kBatchSize], g[2 * kBatchSize]);
    };
    const double shear = numbers[layout.volume] * numbers[layout.mu];
    const Eigen::MatrixXd& mass = mass_integrals_[corner.place];
    for (int i = 0; i < n; ++i) {
      if (i == own) continue;
      Meeting meeting;
      const int other = batch.first_corner + kBatchSize * i + lane;
      meeting.neighbour = vertices_[other];
      meeting.order = order++;
      if (i > own) {
        meeting.pair = {corner.corner, other};
        meeting.shear = shear * gradient(own).dot(gradient(i));
        if (mass.size() > 0) meeting.mass = densities_[corner.place] * mass(i, own);
        if (batch.num_modes > 0)
          meeting.stabiliser = batch.first_pair + kBatchSize * pairOf(n, own, i) + lane;
      }
      meetings_.push_back(meeting);
    }
  }
  std::sort(meetings_.begin(), meetings_.end(), [](const Meeting& a, const Meeting& b) {
    return a.neighbour != b.neighbour ? a.neighbour < b.neighbour : a.order < b.order;
  });
  RowPattern::Row& row = pattern_.rows[vertex];
  row.first = row.first_above = pattern_.capacity();
  first_pair_[vertex] = static_cast<int>(pairs_.size());
  first_stabiliser_[vertex] = static_cast<int>(stabilisers_.size());
  for (std::size_t k = 0; k < meetings_.size();) {
    const int neighbour = meetings_[k].neighbour;
    Incidences incidences;
    double mass = 0, shear = 0;
    for (; k < meetings_.size() && meetings_[k].neighbour == neighbour; ++k) {
      if (neighbour < vertex) continue;
      ++incidences.num_pairs;
      pairs_.push_back(meetings_[k].pair);
      mass += meetings_[k].mass;
      shear += meetings_[k].shear;
      if (meetings_[k].stabiliser < 0) continue;
      ++incidences.num_stabilisers;
      stabilisers_.push_back(meetings_[k].stabiliser);
    }
    if (neighbour < vertex) ++row.first_above;
    pattern_.column.push_back(neighbour);
    pattern_.mirror.push_back(-1);
    incidences_.push_back(incidences);
    entry_masses_.push_back(mass);
    entry_shears_.push_back(shear);
  }
  row.count = pattern_.capacity() - row.first;
}

// Both sides of each of the row's entries learn of each other.
void CorotatedBody::linkRow(int vertex) {
  const RowPattern::Row& row = pattern_.rows[vertex];
  for (int entry = row.first; entry < row.first + row.count; ++entry) {
    const int other = pattern_.find(pattern_.column[entry], vertex);
    POLYSCALPEL_ASSERT(other >= 0);
    pattern_.mirror[entry] = other;
    pattern_.mirror[other] = entry;
    // Masses of M are asked for in rows of both vertices.
    if (pattern_.column[entry] < vertex) {
      entry_masses_[entry] = entry_masses_[other];
    } else {
      entry_masses_[other] = entry_masses_[entry];
    }
  }
}

// The largest cells tell how a vertex has turned.
void CorotatedBody::makeVertexRotation(int vertex) {
  const auto weight = [&](const Corner& corner) {
    const Batch& batch = batches_[corner.place / kBatchSize];
    return numbers_[batch.first_number + Layout(batch.num_vertices, batch.num_modes).volume +
                    corner.place % kBatchSize];
  };
  const Span& span = corners_of_vertex_[vertex];
  std::vector<Corner> around(corners_.begin() + span.first, corners_.begin() + span.first + span.count);
  const int count = std::min(kCellsAMean, span.count);
  std::stable_sort(around.begin(), around.end(),
                   [&](const Corner& a, const Corner& b) { return weight(a) > weight(b); });
  for (int i = 0; i < kCellsAMean; ++i) {
    rotation_places_[kCellsAMean * vertex + i] = i < count ? around[i].place : 0;
    rotation_weights_[kCellsAMean * vertex + i] = i < count ? weight(around[i]) : 0;
  }
}

void CorotatedBody::makeRows(const std::vector<int>& touched) {
  for (const int vertex : touched) {
    makeRow(vertex);
    makeVertexRotation(vertex);
  }
  for (const int vertex : touched) linkRow(vertex);
  std::size_t num_corners = vertices_.size();
  corner_forces_.resize(4 * num_corners, 0.0);
}

}  // namespace polyscalpel
