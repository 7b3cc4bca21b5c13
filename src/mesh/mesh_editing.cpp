// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/mesh_editing.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {
namespace {

/// Faces at an edge, each with two cells: more are rare.
constexpr std::size_t kUsualEdgeFaces = 16;

template <class T>
void sortUnique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Returns where it was.
int eraseValue(std::vector<FaceId>& faces, FaceId id) {
  const auto place = std::find(faces.begin(), faces.end(), id);
  POLYSCALPEL_ASSERT(place != faces.end());
  return static_cast<int>(faces.erase(place) - faces.begin());
}

/// saved: where it was, and which.
void insertBack(const int* saved, std::vector<FaceId>& faces) {
  faces.insert(faces.begin() + saved[0], FaceId(saved[1]));
}

/// Numbers the components of n things joined by pairs.
class DisjointSets {
 public:
  explicit DisjointSets(int count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0); }
  int find(int i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void join(int i, int j) {
    i = find(i);
    j = find(j);
    parents_[std::max(i, j)] = std::min(i, j);  // the representative is the smallest
  }

 private:
  std::vector<int> parents_;
};

VertexId endOfFewerFaces(const PolyhedralMesh& mesh, VertexId a, VertexId b) {
  return mesh.facesAround(b).size() < mesh.facesAround(a).size() ? b : a;
}

/// Cells that have one of the faces, ascending.
std::vector<CellId> cellsOf(const PolyhedralMesh& mesh, const std::vector<FaceId>& faces) {
  std::vector<CellId> cells;
  cells.reserve(2 * faces.size());
  for (const FaceId id : faces) {
    for (const CellId cell : mesh.face(id).cells) {
      if (cell.isValid()) cells.push_back(cell);
    }
  }
  sortUnique(cells);
  return cells;
}

}  // namespace

std::vector<CellId> cellsAroundEdge(const PolyhedralMesh& mesh, VertexId a, VertexId b) {
  std::vector<CellId> cells;
  cells.reserve(kUsualEdgeFaces);
  for (const FaceId id : mesh.facesAround(endOfFewerFaces(mesh, a, b))) {
    const Face& face = mesh.face(id);
    if (!hasEdge(face, a, b)) continue;
    for (const CellId cell : face.cells) {
      if (cell.isValid()) cells.push_back(cell);
    }
  }
  sortUnique(cells);
  return cells;
}

std::vector<CellId> cellsAround(const PolyhedralMesh& mesh, VertexId vertex) {
  return cellsOf(mesh, mesh.facesAround(vertex));
}

int numFansAroundEdge(const PolyhedralMesh& mesh, VertexId a, VertexId b) {
  int num_faces = 0, num_boundary_faces = 0;
  for (const FaceId id : mesh.facesAround(endOfFewerFaces(mesh, a, b))) {
    if (!hasEdge(mesh.face(id), a, b)) continue;
    ++num_faces;
    num_boundary_faces += mesh.face(id).isBoundary();
  }
  // Each cell has two faces at its edge, so a group ends in two boundary faces or goes all the way round.
  if (num_boundary_faces == 0) return num_faces > 0 ? 1 : 0;
  return num_boundary_faces / 2;
}

MeshEditor::MeshEditor(PolyhedralMesh& mesh) : mesh_(mesh), first_new_cell_(mesh.cellCapacity()) {}

MeshEditor::~MeshEditor() {
  rollBackTo(0);
}

// Faces and cells are taken apart by structured bindings, so that a member which is added to one of them and
// is not saved does not compile.

template <class Values>
void MeshEditor::save(const Values& values) {
  saved_.push_back(static_cast<int>(values.size()));
  for (const auto& value : values) {
    if constexpr (std::is_same_v<typename Values::value_type, char>) {
      saved_.push_back(value);
    } else {
      saved_.push_back(value.index());
    }
  }
}

template <class Values>
const int* MeshEditor::restore(const int* saved, Values& values) {
  const int count = *saved++;
  values.clear();
  for (int i = 0; i < count; ++i) values.push_back(static_cast<typename Values::value_type>(saved[i]));
  return saved + count;
}

void MeshEditor::rollBackTo(std::size_t savepoint) {
  if (journal_.size() > savepoint) whole_change_.reset();
  for (; journal_.size() > savepoint; journal_.pop_back()) {
    const Undo& undo = journal_.back();
    const int* saved = saved_.data() + undo.saved;
    switch (undo.kind) {
      case Undo::Kind::kOldFace: {
        auto& [loop, is_corner, cells, cut] = mesh_.faces_[undo.id];
        cut = *saved++;
        for (CellId& cell : cells) cell = CellId(*saved++);
        saved = restore(saved, loop);
        restore(saved, is_corner);
        break;
      }
      case Undo::Kind::kOldFaceCells:
        for (CellId& cell : mesh_.faces_[undo.id].cells) cell = CellId(*saved++);
        break;
      case Undo::Kind::kOldCell: {
        Cell& cell = mesh_.cells_[undo.id];
        auto& [faces, vertices, region] = cell;
        mesh_.num_cells_ -= cell.isAlive();
        region = *saved++;
        saved = restore(saved, faces);
        restore(saved, vertices);
        mesh_.num_cells_ += cell.isAlive();
        break;
      }
      case Undo::Kind::kOldVertexFaces:
        restore(saved, mesh_.vertex_faces_[undo.id]);
        break;
      case Undo::Kind::kFaceOfVertexAdded:
        mesh_.vertex_faces_[undo.id].pop_back();
        break;
      case Undo::Kind::kFaceOfVertexErased:
        insertBack(saved, mesh_.vertex_faces_[undo.id]);
        break;
      case Undo::Kind::kFaceOfCellAdded:
        mesh_.cells_[undo.id].faces.pop_back();
        break;
      case Undo::Kind::kFaceOfCellErased:
        insertBack(saved, mesh_.cells_[undo.id].faces);
        break;
      case Undo::Kind::kVertexOfCellAdded:
        mesh_.cells_[undo.id].vertices.pop_back();
        break;
      case Undo::Kind::kNewFace:
        mesh_.faces_.pop_back();
        break;
      case Undo::Kind::kNewCell:
        mesh_.num_cells_ -= mesh_.cells_.back().isAlive();
        mesh_.cells_.pop_back();
        parents_.pop_back();
        break;
      case Undo::Kind::kNewVertex:
        mesh_.rest_positions_.pop_back();
        mesh_.is_retired_.pop_back();
        mesh_.local_sizes_.pop_back();
        mesh_.vertex_faces_.pop_back();
        new_vertices_.pop_back();
        break;
      case Undo::Kind::kRetiredVertex:
        mesh_.is_retired_[undo.id] = 0;
        break;
    }
    saved_.resize(undo.saved);
  }
}

Face& MeshEditor::touchFace(FaceId id) {
  Face& face = mesh_.faces_[id.index()];
  note(Undo::Kind::kOldFace, id.index());
  const auto& [loop, is_corner, cells, cut] = face;
  saved_.push_back(cut);
  for (const CellId cell : cells) saved_.push_back(cell.index());
  save(loop);
  save(is_corner);
  return face;
}

Cell& MeshEditor::touchCell(CellId id) {
  Cell& cell = mesh_.cells_[id.index()];
  note(Undo::Kind::kOldCell, id.index());
  const auto& [faces, vertices, region] = cell;
  saved_.push_back(region);
  save(faces);
  save(vertices);
  return cell;
}

std::vector<FaceId>& MeshEditor::touchVertexFaces(VertexId id) {
  note(Undo::Kind::kOldVertexFaces, id.index());
  save(mesh_.vertex_faces_[id.index()]);
  return mesh_.vertex_faces_[id.index()];
}

void MeshEditor::addFaceTo(VertexId vertex, FaceId face) {
  note(Undo::Kind::kFaceOfVertexAdded, vertex.index());
  mesh_.vertex_faces_[vertex.index()].push_back(face);
}

void MeshEditor::eraseFaceFrom(VertexId vertex, FaceId face) {
  note(Undo::Kind::kFaceOfVertexErased, vertex.index());
  saved_.push_back(eraseValue(mesh_.vertex_faces_[vertex.index()], face));
  saved_.push_back(face.index());
}

void MeshEditor::addFaceTo(CellId cell, FaceId face) {
  note(Undo::Kind::kFaceOfCellAdded, cell.index());
  mesh_.cells_[cell.index()].faces.push_back(face);
}

void MeshEditor::eraseFaceFrom(CellId cell, FaceId face) {
  note(Undo::Kind::kFaceOfCellErased, cell.index());
  saved_.push_back(eraseValue(mesh_.cells_[cell.index()].faces, face));
  saved_.push_back(face.index());
}

/// A vertex that is larger than all of the cell's others, so that they stay ascending.
void MeshEditor::addVertexTo(CellId cell, VertexId vertex) {
  note(Undo::Kind::kVertexOfCellAdded, cell.index());
  mesh_.cells_[cell.index()].vertices.push_back(vertex);
}

void MeshEditor::replaceCell(FaceId id, CellId former, CellId cell) {
  Face& face = mesh_.faces_[id.index()];
  note(Undo::Kind::kOldFaceCells, id.index());
  for (const CellId side : face.cells) saved_.push_back(side.index());
  face.cells[face.cells[0] == former ? 0 : 1] = cell;
}

FaceId MeshEditor::addFace(Face face) {
  const FaceId id(mesh_.faces_.size());
  for (const VertexId vertex : face.loop) addFaceTo(vertex, id);
  note(Undo::Kind::kNewFace, id.index());
  mesh_.faces_.push_back(std::move(face));
  return id;
}

void MeshEditor::removeFace(FaceId id) {
  Face& face = touchFace(id);
  for (const VertexId vertex : face.loop) eraseFaceFrom(vertex, id);
  face = Face{};
}

CellId MeshEditor::addCell(CellId former, std::vector<FaceId> faces) {
  const CellId id(mesh_.cells_.size());
  Cell cell;
  cell.faces = std::move(faces);
  cell.region = mesh_.cell(former).region;
  note(Undo::Kind::kNewCell, id.index());
  mesh_.cells_.push_back(std::move(cell));
  ++mesh_.num_cells_;
  parents_.push_back(former);
  return id;
}

VertexId MeshEditor::addVertex(const NewVertex& origin) {
  const VertexId a = origin.parents[0], b = origin.parents[1];
  const Eigen::Vector3d position = a == b ? mesh_.restPosition(a)
                                          : Eigen::Vector3d((1 - origin.weight) * mesh_.restPosition(a) +
                                                            origin.weight * mesh_.restPosition(b));
  const double size = std::min(mesh_.localSize(a), mesh_.localSize(b));
  note(Undo::Kind::kNewVertex, origin.vertex.index());
  mesh_.rest_positions_.push_back(position);
  mesh_.is_retired_.push_back(0);
  mesh_.local_sizes_.push_back(size);
  mesh_.vertex_faces_.emplace_back();
  new_vertices_.push_back(origin);
  return origin.vertex;
}

void MeshEditor::refreshVertices(CellId id) {
  Cell& cell = mesh_.cells_[id.index()];
  boost::container::small_vector<VertexId, 64> vertices;
  for (const FaceId face : cell.faces) {
    const auto& loop = mesh_.face(face).loop;
    vertices.insert(vertices.end(), loop.begin(), loop.end());
  }
  std::sort(vertices.begin(), vertices.end());
  cell.vertices.assign(vertices.begin(), std::unique(vertices.begin(), vertices.end()));
}

VertexId MeshEditor::splitEdge(VertexId a, VertexId b, double weight) {
  POLYSCALPEL_ASSERT(weight > 0 && weight < 1);
  std::vector<FaceId> faces;
  faces.reserve(kUsualEdgeFaces);
  for (const FaceId id : mesh_.facesAround(a)) {
    if (hasEdge(mesh_.face(id), a, b)) faces.push_back(id);
  }
  POLYSCALPEL_ASSERT(faces.size() >= 2);
  const std::vector<CellId> cells = cellsOf(mesh_, faces);

  const VertexId middle = addVertex({VertexId(mesh_.rest_positions_.size()), {a, b}, weight});
  for (const FaceId id : faces) {
    Face& face = touchFace(id);
    const int i = findInLoop(face, a);
    const std::size_t n = face.loop.size();
    const std::size_t place = face.loop[(i + 1) % n] == b ? i + 1 : i;
    face.loop.insert(face.loop.begin() + place, middle);
    face.is_corner.insert(face.is_corner.begin() + place, char(0));
  }
  touchVertexFaces(middle) = std::move(faces);
  for (const CellId id : cells) addVertexTo(id, middle);
  return middle;
}

std::pair<FaceId, FaceId> MeshEditor::splitFace(FaceId id, VertexId a, VertexId b) {
  const Face old = mesh_.face(id);
  const std::size_t n = old.loop.size();
  const auto part = [&](VertexId from, VertexId to) {
    Face face;
    face.cells = old.cells;
    face.cut = old.cut;
    for (std::size_t i = findInLoop(old, from);; ++i) {
      face.loop.push_back(old.loop[i % n]);
      if (old.loop[i % n] == to) break;
    }
    POLYSCALPEL_ASSERT(face.loop.size() >= 3);
    face.is_corner.assign(face.loop.size(), char(1));
    return face;
  };
  Face first = part(a, b), second = part(b, a);
  removeFace(id);
  const FaceId first_id = addFace(std::move(first)), second_id = addFace(std::move(second));
  for (const CellId cell_id : old.cells) {
    if (!cell_id.isValid()) continue;
    eraseFaceFrom(cell_id, id);
    addFaceTo(cell_id, first_id);
    addFaceTo(cell_id, second_id);
  }
  return {first_id, second_id};
}

MeshEditor::SplitCell MeshEditor::splitCell(CellId cell, const std::vector<FaceId>& first_faces,
                                            const std::vector<std::vector<VertexId>>& cap_facets, int cut) {
  std::vector<FaceId> second_faces;
  second_faces.reserve(mesh_.cell(cell).faces.size() - first_faces.size() + cap_facets.size());
  for (const FaceId face : mesh_.cell(cell).faces) {
    if (std::find(first_faces.begin(), first_faces.end(), face) == first_faces.end())
      second_faces.push_back(face);
  }
  POLYSCALPEL_ASSERT(!first_faces.empty() && !second_faces.empty());
  SplitCell split;
  split.first = addCell(cell, first_faces);
  split.second = addCell(cell, std::move(second_faces));
  split.cap.reserve(cap_facets.size());
  for (const auto& loop : cap_facets) {
    Face facet;
    facet.loop.assign(loop.begin(), loop.end());
    facet.is_corner.assign(loop.size(), char(1));
    facet.cells = {split.first, split.second};
    facet.cut = cut;
    split.cap.push_back(addFace(std::move(facet)));
  }

  for (const CellId part : {split.first, split.second}) {
    auto& part_faces = mesh_.cells_[part.index()].faces;
    for (const FaceId id : part_faces) replaceCell(id, cell, part);
    part_faces.insert(part_faces.end(), split.cap.begin(), split.cap.end());
    refreshVertices(part);
  }
  touchCell(cell) = Cell{};
  --mesh_.num_cells_;
  return split;
}

std::pair<FaceId, FaceId> MeshEditor::openFace(FaceId id, int cut) {
  const Face closed = mesh_.face(id);
  POLYSCALPEL_ASSERT(!closed.isBoundary());
  Face front = closed, back = closed;
  std::reverse(back.loop.begin(), back.loop.end());
  std::reverse(back.is_corner.begin(), back.is_corner.end());
  front.cells = {closed.cells[0], CellId()};
  back.cells = {closed.cells[1], CellId()};
  removeFace(id);
  const auto add = [&](Face face) {
    face.cut = cut;
    const CellId cell = face.cells[0];
    eraseFaceFrom(cell, id);
    const FaceId added = addFace(std::move(face));
    addFaceTo(cell, added);
    return added;
  };
  const FaceId front_id = add(std::move(front)), back_id = add(std::move(back));
  return {front_id, back_id};
}

void MeshEditor::separateVertex(VertexId vertex) {
  const std::vector<CellId> cells = cellsAround(mesh_, vertex);
  const auto indexOf = [&](CellId id) {
    return static_cast<int>(std::lower_bound(cells.begin(), cells.end(), id) - cells.begin());
  };
  DisjointSets fans(static_cast<int>(cells.size()));
  for (const FaceId id : mesh_.facesAround(vertex)) {
    const Face& face = mesh_.face(id);
    if (!face.isBoundary()) fans.join(indexOf(face.cells[0]), indexOf(face.cells[1]));
  }
  for (int fan = 1; fan < static_cast<int>(cells.size()); ++fan) {
    if (fans.find(fan) != fan) continue;
    const VertexId copy = addVertex({VertexId(mesh_.rest_positions_.size()), {vertex, vertex}, 0});
    std::vector<FaceId> moved, kept;
    for (const FaceId id : mesh_.facesAround(vertex)) {
      (fans.find(indexOf(mesh_.face(id).cells[0])) == fan ? moved : kept).push_back(id);
    }
    for (const FaceId id : moved) {
      Face& face = touchFace(id);
      face.loop[findInLoop(face, vertex)] = copy;
    }
    touchVertexFaces(vertex) = kept;
    touchVertexFaces(copy) = moved;
    for (int i = 0; i < static_cast<int>(cells.size()); ++i) {
      if (fans.find(i) != fan) continue;
      auto& vertices = touchCell(cells[i]).vertices;
      vertices.erase(std::find(vertices.begin(), vertices.end(), vertex));
      vertices.push_back(copy);
    }
  }
}

bool MeshEditor::separateEdge(VertexId a, VertexId b) {
  if (numFansAroundEdge(mesh_, a, b) < 2) return false;
  separateVertex(splitEdge(a, b, 0.5));
  return true;
}

void MeshEditor::removeCells(const std::vector<CellId>& cells) {
  std::vector<VertexId> vertices;
  std::vector<FaceId> faces;
  for (const CellId id : cells) {
    Cell& cell = touchCell(id);
    POLYSCALPEL_ASSERT(cell.isAlive());
    vertices.insert(vertices.end(), cell.vertices.begin(), cell.vertices.end());
    faces.insert(faces.end(), cell.faces.begin(), cell.faces.end());
    cell = Cell{};
    --mesh_.num_cells_;
  }
  sortUnique(vertices);
  sortUnique(faces);
  for (const FaceId id : faces) {
    for (const CellId cell : mesh_.face(id).cells) {
      POLYSCALPEL_ASSERT(!cell.isValid() || !mesh_.cell(cell).isAlive());
    }
    touchFace(id) = Face{};
  }
  for (const VertexId id : vertices) {
    // At a vertex all cells are joined through faces, so it has no face of another piece.
    touchVertexFaces(id).clear();
    note(Undo::Kind::kRetiredVertex, id.index());
    mesh_.is_retired_[id.index()] = 1;
  }
}

MeshChange MeshEditor::changeSince(std::size_t savepoint) const {
  MeshChange change;
  int num_new_cells = 0, num_new_faces = 0, num_new_vertices = 0;
  for (std::size_t i = savepoint; i < journal_.size(); ++i) {
    num_new_cells += journal_[i].kind == Undo::Kind::kNewCell;
    num_new_faces += journal_[i].kind == Undo::Kind::kNewFace;
    num_new_vertices += journal_[i].kind == Undo::Kind::kNewVertex;
  }
  // A cut touches each cell and face many times.
  cell_marks_.resize(mesh_.cellCapacity());
  face_marks_.resize(mesh_.faceCapacity());
  const auto addOnce = [](int id, auto& list, std::vector<char>& marks) {
    if (!marks[id]) list.emplace_back(id);
    marks[id] = 1;
  };
  // Ids from these on have been given since: no list of them needs to be sorted.
  const int first_new_cell = mesh_.cellCapacity() - num_new_cells;
  const int first_new_face = mesh_.faceCapacity() - num_new_faces;
  std::vector<CellId> cells;
  for (std::size_t i = savepoint; i < journal_.size(); ++i) {
    const Undo& undo = journal_[i];
    switch (undo.kind) {
      case Undo::Kind::kOldCell:
      case Undo::Kind::kFaceOfCellAdded:
      case Undo::Kind::kFaceOfCellErased:
      case Undo::Kind::kVertexOfCellAdded:
        if (undo.id < first_new_cell) addOnce(undo.id, cells, cell_marks_);
        break;
      case Undo::Kind::kOldFace:
      case Undo::Kind::kOldFaceCells:
        if (undo.id < first_new_face) addOnce(undo.id, change.changed_faces, face_marks_);
        break;
      case Undo::Kind::kRetiredVertex:
        change.retired_vertices.emplace_back(undo.id);
        break;
      case Undo::Kind::kNewCell:
      case Undo::Kind::kNewFace:
      case Undo::Kind::kNewVertex:
      case Undo::Kind::kOldVertexFaces:
      case Undo::Kind::kFaceOfVertexAdded:
      case Undo::Kind::kFaceOfVertexErased:
        break;
    }
  }
  sortUnique(change.retired_vertices);
  change.new_vertices.assign(new_vertices_.end() - num_new_vertices, new_vertices_.end());
  for (const FaceId id : change.changed_faces) face_marks_[id.index()] = 0;
  for (const CellId id : cells) cell_marks_[id.index()] = 0;
  std::sort(change.changed_faces.begin(), change.changed_faces.end());
  for (int face = first_new_face; face < mesh_.faceCapacity(); ++face)
    change.changed_faces.emplace_back(face);
  std::sort(cells.begin(), cells.end());
  for (const CellId id : cells)
    (mesh_.cell(id).isAlive() ? change.changed_cells : change.removed_cells).push_back(id);
  for (int cell = first_new_cell; cell < mesh_.cellCapacity(); ++cell) {
    if (!mesh_.cell(CellId(cell)).isAlive()) continue;
    CellId parent(cell);
    while (parent.index() >= first_new_cell) parent = parents_[parent.index() - first_new_cell_];
    change.new_cells.push_back({CellId(cell), parent});
  }
  if (savepoint == 0) {
    whole_change_ = change;
    edits_in_whole_change_ = journal_.size();
  }
  return change;
}

MeshChange MeshEditor::commit() {
  MeshChange change =
      whole_change_ && edits_in_whole_change_ == journal_.size() ? std::move(*whole_change_) : changeSince(0);
  whole_change_.reset();
  journal_ = {};
  saved_.clear();
  new_vertices_.clear();
  parents_.clear();
  first_new_cell_ = mesh_.cellCapacity();
  return change;
}

}  // namespace polyscalpel
