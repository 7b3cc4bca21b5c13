// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/cut_event_publisher.hpp"

#include <utility>

#include <polyscalpel/CutEvent.h>

#include "polyscalpel/ros_bridge/geometry_conversions.hpp"

namespace polyscalpel {

CutEventPublisher::CutEventPublisher(ros::NodeHandle& node_handle, std::string world_frame)
    : publisher_(node_handle.advertise<CutEvent>("cut_events", 1000)), world_frame_(std::move(world_frame)) {}

void CutEventPublisher::publish(const CutReport& report, const PolyhedralMesh& mesh,
                                const std::string& source, const ros::Time& stamp, double time_s) const {
  const CutResult& result = report.result;
  CutEvent msg;
  msg.header.stamp = stamp;
  msg.header.frame_id = world_frame_;
  msg.time_s = time_s;
  msg.cut = result.cut;
  msg.cuts = result.num_cuts;
  msg.source = source;
  msg.message = result.message;
  for (const CellId cell : result.change.removed_cells) msg.parents.push_back(cell.index());
  for (const NewCell& cell : result.change.new_cells) {
    msg.children.push_back(cell.cell.index());
    msg.child_parents.push_back(cell.parent.index());
  }
  const auto isNew = [&](const Face& face) {
    return face.cut >= result.cut && face.cut < result.cut + result.num_cuts;
  };
  for (const FaceId id : result.change.changed_faces) {
    const Face& face = mesh.face(id);
    if (id.index() >= faces_before_ && face.isAlive() && isNew(face)) ++msg.new_faces;
  }
  msg.new_vertices = static_cast<int>(result.change.new_vertices.size());
  msg.pieces_before = result.pieces_before;
  msg.pieces_after = result.pieces_after;
  msg.cells_split = result.cells_split;
  msg.cells_left_whole = result.cells_left_whole;
  msg.cut_area_m2 = result.cut_area_m2;
  msg.momentum_change = toVectorMsg(report.balance.momentum_change);
  msg.angular_momentum_change = toVectorMsg(report.balance.angular_momentum_change);
  msg.kinetic_energy_change_j = report.balance.kinetic_energy_change_j;
  msg.elastic_energy_before_j = report.balance.elastic_energy_before_j;
  msg.elastic_energy_after_j = report.balance.elastic_energy_after_j;
  msg.debris_pieces = report.debris.num_pieces;
  msg.debris_volume_m3 = report.debris.volume_m3;
  msg.debris_mass_kg = report.debris.mass_kg;
  for (const CellId cell : report.debris.change.removed_cells) msg.debris_cells.push_back(cell.index());
  for (const PieceProperties& piece : report.pieces) {
    Piece entry;
    entry.smallest_cell = piece.smallest_cell.index();
    entry.cells = piece.num_cells;
    entry.volume_m3 = piece.volume_m3;
    entry.mass_kg = piece.mass_kg;
    msg.pieces.push_back(entry);
  }
  publisher_.publish(msg);
}

}  // namespace polyscalpel
