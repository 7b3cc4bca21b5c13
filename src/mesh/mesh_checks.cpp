// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/mesh_checks.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

template <class Values, class T>
bool contains(const Values& values, const T& value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

template <class Values>
bool hasRepeats(Values values) {
  std::sort(values.begin(), values.end());
  return std::adjacent_find(values.begin(), values.end()) != values.end();
}

/// Collects one line a violation. Recomputes everything from the loops, and trusts no list before it is
/// checked.
class MeshChecker {
 public:
  explicit MeshChecker(const PolyhedralMesh& mesh) : mesh_(mesh) {}

  std::vector<std::string> check() {
    checkVertices();
    checkFaces();
    checkCells();
    // What follows walks along the lists checked above.
    if (violations_.empty()) {
      checkFans();
      checkSubTets();
    }
    return std::move(violations_);
  }

 private:
  template <class... Parts>
  void report(const Parts&... parts) {
    std::ostringstream line;
    (line << ... << parts);
    violations_.push_back(line.str());
  }

  bool isVertex(VertexId id) const { return id.isValid() && id.index() < mesh_.numVertices(); }
  bool isFaceAlive(FaceId id) const {
    return id.isValid() && id.index() < mesh_.faceCapacity() && mesh_.face(id).isAlive();
  }
  bool isCellAlive(CellId id) const {
    return id.isValid() && id.index() < mesh_.cellCapacity() && mesh_.cell(id).isAlive();
  }

  void checkVertices() {
    for (int v = 0; v < mesh_.numVertices(); ++v) {
      const VertexId id(v);
      if (!mesh_.restPosition(id).allFinite()) report("vertex ", v, ": position is not finite");
      const double size = mesh_.localSize(id);
      if (!(size > 0 && size < kInfinity))
        report("vertex ", v, ": local size ", size, " is not positive and finite");
      const std::vector<FaceId>& faces = mesh_.facesAround(id);
      if (faces.empty() && !mesh_.isRetired(id)) report("vertex ", v, ": not used by any face");
      if (!faces.empty() && mesh_.isRetired(id)) report("vertex ", v, ": retired, but used by faces");
      if (hasRepeats(faces)) report("vertex ", v, ": lists a face twice");
      for (const FaceId face : faces) {
        if (!isFaceAlive(face)) {
          report("vertex ", v, ": lists face ", face.index(), ", which does not exist");
        } else if (!contains(mesh_.face(face).loop, id)) {
          report("vertex ", v, ": lists face ", face.index(), ", whose loop is without it");
        }
      }
    }
  }

  void checkFaces() {
    for (int f = 0; f < mesh_.faceCapacity(); ++f) {
      const FaceId id(f);
      const Face& face = mesh_.face(id);
      if (!face.isAlive()) {
        if (face.cells[1].isValid()) report("face ", f, ": removed, but lists cell ", face.cells[1].index());
        continue;
      }
      if (face.loop.size() < 3) report("face ", f, ": ", face.loop.size(), " vertices in its loop");
      if (hasRepeats(face.loop)) report("face ", f, ": a vertex occurs twice in its loop");
      if (face.is_corner.size() != face.loop.size()) {
        report("face ", f, ": ", face.is_corner.size(), " corner flags for ", face.loop.size(), " vertices");
      }
      if (face.is_corner.size() - std::count(face.is_corner.begin(), face.is_corner.end(), 0) < 3) {
        report("face ", f, ": fewer than 3 corners");
      }
      if (face.cut < 0) report("face ", f, ": negative cut number ", face.cut);
      if (face.cells[0] == face.cells[1]) report("face ", f, ": the same cell on both sides");
      for (const VertexId vertex : face.loop) {
        if (!isVertex(vertex)) {
          report("face ", f, ": vertex ", vertex.index(), " does not exist");
        } else if (!contains(mesh_.facesAround(vertex), id)) {
          report("face ", f, ": not listed by its vertex ", vertex.index());
        }
      }
      for (const CellId cell : face.cells) {
        if (!cell.isValid()) continue;
        if (!isCellAlive(cell)) {
          report("face ", f, ": cell ", cell.index(), " does not exist");
        } else if (!contains(mesh_.cell(cell).faces, id)) {
          report("face ", f, ": not listed by its cell ", cell.index());
        }
      }
    }
  }

  void checkCells() {
    int num_alive = 0;
    for (int c = 0; c < mesh_.cellCapacity(); ++c) {
      const CellId id(c);
      const Cell& cell = mesh_.cell(id);
      if (!cell.isAlive()) {
        if (!cell.vertices.empty()) report("cell ", c, ": removed, but has vertices");
        continue;
      }
      ++num_alive;
      if (cell.faces.size() < 4) report("cell ", c, ": fewer than 4 faces");
      if (hasRepeats(cell.faces)) report("cell ", c, ": lists a face twice");
      std::vector<VertexId> vertices;
      std::vector<std::pair<VertexId, VertexId>> edges;
      for (const FaceId face_id : cell.faces) {
        if (!isFaceAlive(face_id)) {
          report("cell ", c, ": face ", face_id.index(), " does not exist");
          continue;
        }
        const Face& face = mesh_.face(face_id);
        if (face.cells[0] != id && face.cells[1] != id) {
          report("cell ", c, ": face ", face_id.index(), " does not list it");
          continue;
        }
        for (std::size_t i = 0; i < face.loop.size(); ++i) {
          const VertexId start = face.loop[i];
          const VertexId end = face.loop[(i + 1) % face.loop.size()];
          vertices.push_back(start);
          edges.push_back(face.cells[0] == id ? std::pair(start, end) : std::pair(end, start));
        }
      }
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
      if (vertices != cell.vertices)
        report("cell ", c, ": its vertices are not those of its faces, ascending");
      checkClosed(c, edges);
      const std::size_t euler = vertices.size() + cell.faces.size() - edges.size() / 2;
      if (euler != 2) report("cell ", c, ": its faces do not form one ball (Euler number ", euler, ")");
    }
    if (num_alive != mesh_.numCells())
      report("mesh: counts ", mesh_.numCells(), " cells, but has ", num_alive);
  }

  void checkClosed(int cell, std::vector<std::pair<VertexId, VertexId>>& edges) {
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto& [start, end] = edges[i];
      if (i > 0 && edges[i] == edges[i - 1]) {
        report("cell ", cell, ": edge (", start.index(), ", ", end.index(), ") twice in the same direction");
      }
      if (!std::binary_search(edges.begin(), edges.end(), std::pair(end, start))) {
        report("cell ", cell, ": open at edge (", start.index(), ", ", end.index(), ")");
      }
    }
  }

  /// At every vertex, and so at every edge, all cells are reached from one of them through faces that hold
  /// it.
  void checkFans() {
    for (int v = 0; v < mesh_.numVertices(); ++v) {
      if (mesh_.isRetired(VertexId(v))) continue;
      std::vector<CellId> cells;
      for (const FaceId face : mesh_.facesAround(VertexId(v))) {
        for (const CellId cell : mesh_.face(face).cells) {
          if (cell.isValid() && !contains(cells, cell)) cells.push_back(cell);
        }
      }
      std::vector<CellId> reached = {cells.front()};
      for (std::size_t i = 0; i < reached.size(); ++i) {
        for (const FaceId face : mesh_.facesAround(VertexId(v))) {
          const auto& sides = mesh_.face(face).cells;
          if (sides[0] != reached[i] && sides[1] != reached[i]) continue;
          const CellId other = mesh_.neighbour(face, reached[i]);
          if (other.isValid() && !contains(reached, other)) reached.push_back(other);
        }
      }
      if (reached.size() != cells.size()) {
        report("vertex ", v, ": its cells are not all joined through faces (", reached.size(), " of ",
               cells.size(), " reached from cell ", cells.front().index(), ")");
      }
    }
  }

  void checkSubTets() {
    for (const CellId id : mesh_.cells()) {
      const CellSurface surface = makeCellSurface(mesh_, id, mesh_.restPositions());
      const double smallest = smallestSubTetVolume(surface);
      const double bound = smallestSubTetAllowed(surface, mesh_.localSize(id));
      if (!(smallest > bound)) {
        report("cell ", id.index(), ": smallest sub-tet ", smallest, " m^3, must be above ", bound, " m^3");
      }
    }
  }

  const PolyhedralMesh& mesh_;
  std::vector<std::string> violations_;
};

}  // namespace

double smallestSubTetAllowed(const CellSurface& surface, double local_size_m) {
  const auto vertices = surface.points.leftCols(surface.num_vertices);
  const Eigen::Vector3d mean = vertices.rowwise().mean();
  // No edge is longer than this.
  const double extent = 2 * std::sqrt((vertices.colwise() - mean).colwise().squaredNorm().maxCoeff());
  const double size = std::min(local_size_m, extent);
  return kSmallestRelativeSubTet * size * size * size;
}

std::vector<std::string> checkMesh(const PolyhedralMesh& mesh) {
  return MeshChecker(mesh).check();
}

}  // namespace polyscalpel
