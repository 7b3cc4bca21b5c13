// SPDX-License-Identifier: BSD-3-Clause
//
// Which faces lie in the slit that a stroke makes, and on which side of it their cells.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <boost/container/flat_map.hpp>

#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/cutting/vertices_in_line.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

/// Vertices whose heights over a face's plane sum up to no more than this, in localSize, do not tell a side,
/// but for rounding: the least that may be set as snap tolerance.
constexpr double kSmallestHeight = 1e-6;

}  // namespace

int Crossings::sideOf(const PolyhedralMesh& mesh, CellId cell, FaceId face_id) const {
  const auto& loop = mesh.face(face_id).loop;
  const auto isInFace = [&](VertexId v) { return std::find(loop.begin(), loop.end(), v) != loop.end(); };
  const auto part = parts_.find(cell);
  if (part != parts_.end() && part->second.side != 0 &&
      std::all_of(loop.begin(), loop.end(), [&](VertexId v) { return part->second.settled.count(v) > 0; })) {
    return part->second.side;
  }
  // What the corners say of each vertex is summed in whole numbers, so that what cancels out leaves nothing.
  struct Votes {
    int at_face = 0, anywhere = 0;  // seen from the face's own corners, and from all snapped ones
  };
  boost::container::flat_map<VertexId, Votes> told, votes;
  int own = 0, first_own = 0;
  for (const auto& [a, b] : mesh.edges(cell)) {
    for (const auto& [corner, other] : {std::make_pair(a, b), std::make_pair(b, a)}) {
      const auto snap = snaps_.find(corner);
      if (snap == snaps_.end()) continue;
      if (isOfEarlierPass(cell, snap->second.last_time)) continue;
      own += snap->second.side;
      if (first_own == 0) first_own = snap->second.side;
      const auto other_snap = snaps_.find(other);
      if (isInFace(other) ||
          (other_snap != snaps_.end() && !isOfEarlierPass(cell, other_snap->second.last_time)))
        continue;
      // Where the surface comes back between the two, the vertex lies beyond that.
      const auto crossed = edges_.find(makeEdge(corner, other));
      const int side = crossed == edges_.end() ? snap->second.sideOfNeighbour(other)
                                               : crossed->second.sideAt(other < corner);
      const bool is_at_face = isInFace(corner);
      const auto add = [side, is_at_face](Votes& sum) {
        sum.anywhere += side;
        if (is_at_face) sum.at_face += side;
      };
      add(votes[other]);
      if (crossed != edges_.end() || !snap->second.has_joined || snap->second.find(other)) add(told[other]);
    }
  }
  // A vertex high above the face tells most: what lies near the blade's surface may be on either side of it
  // by rounding or by the bend of the surface.
  const auto plane = planeOf(mesh.face(face_id), mesh.restPositions());
  const Eigen::Vector3d origin = plane.first, normal = plane.second.normalized();
  const double least = kSmallestHeight * mesh.localSize(cell);
  const auto sideBy = [&](const auto& of_vertices) {
    double at_face = 0, anywhere = 0;
    Votes all;
    for (const auto& [vertex, sum] : of_vertices) {
      const double height = std::abs(normal.dot(mesh.restPosition(vertex) - origin));
      at_face += sum.at_face * height;
      anywhere += sum.anywhere * height;
      all.at_face += sum.at_face;
      all.anywhere += sum.anywhere;
    }
    // No edge may leave the face's own corners but along it. A face that is not much longer than the slit is
    // thick may stand across it, in one plane with all that tells. And all of the cell may lie in the slit.
    const auto signOf = [](auto value) { return value > 0 ? 1 : -1; };
    if (std::abs(at_face) > least) return signOf(at_face);
    if (std::abs(anywhere) > least) return signOf(anywhere);
    if (all.at_face != 0) return signOf(all.at_face);
    if (all.anywhere != 0) return signOf(all.anywhere);
    return 0;
  };
  // A corner that has joined the cut comes last with what it has to say of edges that were not crossed: new
  // vertices of a division may lie beyond them.
  if (const int side = sideBy(told); side != 0) return side;
  if (const int side = sideBy(votes); side != 0) return side;
  // Where as many come from either side, any will do, if it is the same from all faces: the cell is to hang
  // together with one side and be parted from the other.
  if (own == 0) return first_own;
  return own > 0 ? 1 : -1;
}

bool Crossings::isInSlit(const PolyhedralMesh& mesh, const Face& face) const {
  const auto is_on_cut = [&](VertexId v) {
    const auto snap = snaps_.find(v);
    return snap != snaps_.end() && std::none_of(face.cells.begin(), face.cells.end(), [&](CellId cell) {
             return isOfEarlierPass(cell, snap->second.last_time);
           });
  };
  const auto num_on_cut = std::count_if(face.loop.begin(), face.loop.end(), is_on_cut);
  if (num_on_cut == static_cast<std::ptrdiff_t>(face.loop.size())) return true;
  if (num_on_cut < 3) return false;
  const std::vector<LoopPart> parts = partsOffCut(face.loop, is_on_cut);
  return std::all_of(parts.begin(), parts.end(),
                     [&](const LoopPart& part) { return areInLine(mesh, part.from, part.between, part.to); });
}

}  // namespace polyscalpel
