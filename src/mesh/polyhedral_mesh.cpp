// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

#include <algorithm>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Loop = std::vector<int>;
using DirectedEdge = std::pair<int, int>;

std::string toText(const Loop& loop) {
  std::ostringstream text;
  for (std::size_t i = 0; i < loop.size(); ++i) text << (i == 0 ? "(" : ", ") << loop[i];
  text << ")";
  return text.str();
}

[[noreturn]] void refuseCell(int cell, const std::string& reason) {
  throw std::invalid_argument("cell " + std::to_string(cell) + ": " + reason);
}

void requireValidPoints(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  for (int i = 0; i < points.cols(); ++i) {
    if (points.col(i).allFinite()) continue;
    std::ostringstream message;
    message << "point " << i << " = [" << points.col(i).transpose() << "]: every coordinate must be finite";
    throw std::invalid_argument(message.str());
  }
}

/// Refuses cells that are not one closed polyhedron without handles: each directed edge of the loops meets
/// its reverse once, and the surface has the Euler number of the ball. Keeps its memory from cell to cell.
class CellRefuser {
 public:
  explicit CellRefuser(int num_points) : num_points_(num_points) {}

  void requireValid(int cell, const PolyhedralMesh::CellLoops& loops) {
    if (loops.size() < 4)
      refuseCell(cell, std::to_string(loops.size()) + " faces: a closed cell has at least 4");
    edges_.clear();
    vertices_.clear();
    for (const Loop& loop : loops) addLoop(cell, loop);

    std::sort(edges_.begin(), edges_.end());
    const auto twice = std::adjacent_find(edges_.begin(), edges_.end());
    if (twice != edges_.end()) {
      refuseCell(cell, "edge " + toText({twice->first, twice->second}) +
                           " occurs twice in the same direction: the faces are not oriented alike");
    }
    for (const DirectedEdge& edge : edges_) {
      if (!std::binary_search(edges_.begin(), edges_.end(), DirectedEdge(edge.second, edge.first))) {
        refuseCell(cell, "open at edge " + toText({edge.first, edge.second}));
      }
    }
    if (countDistinct(vertices_) + loops.size() != edges_.size() / 2 + 2) {
      refuseCell(cell, "its faces do not form one closed polyhedron");
    }
  }

 private:
  void addLoop(int cell, const Loop& loop) {
    if (loop.size() < 3) refuseCell(cell, "face " + toText(loop) + " has fewer than 3 vertices");
    int start = loop.back();
    for (const int end : loop) {
      if (end < 0 || end >= num_points_) {
        refuseCell(cell, "point index " + std::to_string(end) + ": must be in [0, " +
                             std::to_string(num_points_ - 1) + "]");
      }
      edges_.emplace_back(start, end);
      vertices_.push_back(end);
      start = end;
    }
    loop_ = loop;
    if (countDistinct(loop_) != loop.size()) refuseCell(cell, "face " + toText(loop) + " has a vertex twice");
  }

  static std::size_t countDistinct(Loop& vertices) {
    std::sort(vertices.begin(), vertices.end());
    return std::unique(vertices.begin(), vertices.end()) - vertices.begin();
  }

  int num_points_;
  std::vector<DirectedEdge> edges_;
  Loop vertices_;
  Loop loop_;
};

/// Joins the faces of cells that have the same vertices.
class FaceJoiner {
 public:
  FaceJoiner(BlockList<Face>& faces, int num_points) : faces_(faces), buckets_(num_points) {}

  /// The face with the given outward loop of the cell: a new one, or the one that a former cell has made.
  FaceId join(int cell, const Loop& loop) {
    std::vector<FaceId>& bucket = buckets_[*std::min_element(loop.begin(), loop.end())];
    for (const FaceId id : bucket) {
      Face& face = faces_[id.index()];
      if (!hasSameVertices(face.loop, loop)) continue;
      const int other = face.cells[0].index();
      if (other == cell) refuseCell(cell, "face " + toText(loop) + " occurs twice in it");
      if (!face.isBoundary()) {
        refuseCell(cell, "face " + toText(loop) + " belongs already to cells " + std::to_string(other) +
                             " and " + std::to_string(face.cells[1].index()));
      }
      if (!isReverse(face.loop, loop)) {
        refuseCell(cell, "face " + toText(loop) + " is not the reverse of the same face in cell " +
                             std::to_string(other));
      }
      face.cells[1] = CellId(cell);
      return id;
    }
    Face face;
    face.loop.reserve(loop.size());
    for (const int vertex : loop) face.loop.emplace_back(vertex);
    face.is_corner.assign(loop.size(), 1);
    face.cells[0] = CellId(cell);
    const FaceId id(faces_.size());
    faces_.push_back(std::move(face));
    bucket.push_back(id);
    return id;
  }

 private:
  static bool hasSameVertices(const FaceLoop& a, const Loop& b) {
    return a.size() == b.size() && std::all_of(b.begin(), b.end(), [&a](int vertex) {
             return std::find(a.begin(), a.end(), VertexId(vertex)) != a.end();
           });
  }

  /// For loops of the same vertices.
  static bool isReverse(const FaceLoop& a, const Loop& b) {
    const std::size_t n = a.size();
    const std::size_t offset = std::find(b.begin(), b.end(), a[0].index()) - b.begin();
    for (std::size_t i = 0; i < n; ++i) {
      if (a[i].index() != b[(offset + n - i) % n]) return false;
    }
    return true;
  }

  BlockList<Face>& faces_;
  std::vector<std::vector<FaceId>> buckets_;  ///< faces by the smallest index in their loop
};

/// Disjoint sets of [0, n), each named by its smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parents_(n) { std::iota(parents_.begin(), parents_.end(), 0); }

  int find(int i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }

  void unite(int a, int b) {
    a = find(a);
    b = find(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parents_;
};

/// Where the incidences of each cell with its vertices start in one array over all cells.
std::vector<int> makeIncidenceStarts(const BlockList<Cell>& cells) {
  std::vector<int> starts(1, 0);
  for (std::size_t c = 0; c < cells.size(); ++c)
    starts.push_back(starts.back() + static_cast<int>(cells[c].vertices.size()));
  return starts;
}

int positionIn(const std::vector<VertexId>& ascending, VertexId vertex) {
  const auto found = std::lower_bound(ascending.begin(), ascending.end(), vertex);
  POLYSCALPEL_ASSERT(found != ascending.end() && *found == vertex);
  return static_cast<int>(found - ascending.begin());
}

/// New vertex for each incidence of a cell with a point, and the point that each new vertex lies at.
struct VertexNumbering {
  std::vector<VertexId> vertex_of_incidence;
  std::vector<int> point_of_vertex;
};

/// Used points keep their order; behind them come the copies, one for each further fan of cells around a
/// point that are joined by faces.
VertexNumbering numberVertices(const BlockList<Face>& faces, const BlockList<Cell>& cells,
                               const std::vector<int>& starts, int num_points) {
  DisjointSets fans(starts.back());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Face& face = faces[f];
    if (face.isBoundary()) continue;
    const auto incidence = [&](CellId cell, VertexId vertex) {
      return starts[cell.index()] + positionIn(cells[cell.index()].vertices, vertex);
    };
    for (const VertexId vertex : face.loop)
      fans.unite(incidence(face.cells[0], vertex), incidence(face.cells[1], vertex));
  }

  std::vector<std::vector<int>> fans_at_point(num_points);  // named by their smallest incidence, ascending
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (std::size_t i = 0; i < cells[c].vertices.size(); ++i) {
      const int incidence = starts[c] + static_cast<int>(i);
      if (fans.find(incidence) == incidence) fans_at_point[cells[c].vertices[i].index()].push_back(incidence);
    }
  }
  VertexNumbering numbering;
  numbering.vertex_of_incidence.resize(starts.back());
  const auto addVertex = [&](int point, int fan) {
    numbering.vertex_of_incidence[fan] = VertexId(numbering.point_of_vertex.size());
    numbering.point_of_vertex.push_back(point);
  };
  for (int point = 0; point < num_points; ++point) {
    if (!fans_at_point[point].empty()) addVertex(point, fans_at_point[point].front());
  }
  for (int point = 0; point < num_points; ++point) {
    for (std::size_t i = 1; i < fans_at_point[point].size(); ++i) addVertex(point, fans_at_point[point][i]);
  }
  for (int i = 0; i < starts.back(); ++i) {
    numbering.vertex_of_incidence[i] = numbering.vertex_of_incidence[fans.find(i)];
  }
  return numbering;
}

}  // namespace

PolyhedralMesh::PolyhedralMesh(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                               const std::vector<CellLoops>& cells, const std::vector<int>& regions) {
  requireValidPoints(points);
  if (!regions.empty() && regions.size() != cells.size()) {
    throw std::invalid_argument("regions: " + std::to_string(regions.size()) + " numbers for " +
                                std::to_string(cells.size()) + " cells: must be as many, or none");
  }

  const int num_points = static_cast<int>(points.cols());
  num_cells_ = static_cast<int>(cells.size());
  CellRefuser refuser(num_points);
  FaceJoiner joiner(faces_, num_points);
  for (int c = 0; c < num_cells_; ++c) {
    refuser.requireValid(c, cells[c]);
    Cell cell;
    if (!regions.empty()) cell.region = regions[c];
    cell.faces.reserve(cells[c].size());
    for (const Loop& loop : cells[c]) {
      cell.faces.push_back(joiner.join(c, loop));
      for (const int vertex : loop) cell.vertices.emplace_back(vertex);
    }
    std::sort(cell.vertices.begin(), cell.vertices.end());
    cell.vertices.erase(std::unique(cell.vertices.begin(), cell.vertices.end()), cell.vertices.end());
    cells_.push_back(std::move(cell));
  }

  const std::vector<int> starts = makeIncidenceStarts(cells_);
  const VertexNumbering numbering = numberVertices(faces_, cells_, starts, num_points);
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    Face& face = faces_[f];
    const int cell = face.cells[0].index();
    for (VertexId& vertex : face.loop) {
      vertex = numbering.vertex_of_incidence[starts[cell] + positionIn(cells_[cell].vertices, vertex)];
    }
  }
  for (int c = 0; c < num_cells_; ++c) {
    std::vector<VertexId>& vertices = cells_[c].vertices;
    std::copy_n(numbering.vertex_of_incidence.begin() + starts[c], vertices.size(), vertices.begin());
    std::sort(vertices.begin(), vertices.end());
  }
  for (const int point : numbering.point_of_vertex) rest_positions_.emplace_back(points.col(point));

  local_sizes_.assign(rest_positions_.size(), kInfinity);
  vertex_faces_.resize(rest_positions_.size());
  is_retired_.assign(rest_positions_.size(), 0);
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const FaceLoop& loop = faces_[f].loop;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const VertexId start = loop[i];
      const VertexId end = loop[i + 1 == loop.size() ? 0 : i + 1];
      vertex_faces_[start.index()].emplace_back(f);
      const double length = (restPosition(end) - restPosition(start)).norm();
      for (const VertexId vertex : {start, end}) {
        local_sizes_[vertex.index()] = std::min(local_sizes_[vertex.index()], length);
      }
    }
  }

  for (int c = 0; c < num_cells_; ++c) {
    const double cell_volume = volume(makeCellSurface(*this, CellId(c), restPositions()));
    if (cell_volume > 0) continue;
    std::ostringstream reason;
    reason << "volume " << cell_volume << " m^3: must be > 0";
    refuseCell(c, reason.str());
  }
}

std::vector<CellId> PolyhedralMesh::cells() const {
  std::vector<CellId> ids;
  ids.reserve(num_cells_);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (cells_[i].isAlive()) ids.emplace_back(i);
  }
  return ids;
}

double PolyhedralMesh::localSize(CellId id) const {
  double size = kInfinity;
  for (const VertexId v : cell(id).vertices) size = std::min(size, localSize(v));
  return size;
}

CellId PolyhedralMesh::neighbour(FaceId face_id, CellId cell) const {
  const Face& shared = face(face_id);
  POLYSCALPEL_ASSERT(cell.isValid() && (shared.cells[0] == cell || shared.cells[1] == cell));
  return shared.cells[0] == cell ? shared.cells[1] : shared.cells[0];
}

std::vector<std::pair<VertexId, VertexId>> PolyhedralMesh::edges(CellId id) const {
  std::vector<std::pair<VertexId, VertexId>> edges;
  edges.reserve(cell(id).vertices.size() + cell(id).faces.size());  // Euler: two fewer
  forEachEdge(id, [&](VertexId a, VertexId b) { edges.emplace_back(a, b); });
  std::sort(edges.begin(), edges.end());
  return edges;
}

Pieces findPieces(const PolyhedralMesh& mesh) {
  Pieces pieces;
  pieces.piece_of_cell.assign(mesh.cellCapacity(), -1);
  std::vector<CellId> pending;
  for (const CellId seed : mesh.cells()) {
    if (pieces.piece_of_cell[seed.index()] >= 0) continue;
    pieces.piece_of_cell[seed.index()] = pieces.count;
    pending.push_back(seed);
    while (!pending.empty()) {
      const CellId cell = pending.back();
      pending.pop_back();
      for (const FaceId face : mesh.cell(cell).faces) {
        const CellId other = mesh.neighbour(face, cell);
        if (!other.isValid() || pieces.piece_of_cell[other.index()] >= 0) continue;
        pieces.piece_of_cell[other.index()] = pieces.count;
        pending.push_back(other);
      }
    }
    ++pieces.count;
  }
  return pieces;
}

}  // namespace polyscalpel
