// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/cut_event_publisher.hpp"

#include <utility>

#include <polyscalpel/CutEvent.h>

namespace polyscalpel {

CutEventPublisher::CutEventPublisher(ros::NodeHandle& node_handle, std::string world_frame)
    : publisher_(node_handle.advertise<CutEvent>("cut_events", 1000)), world_frame_(std::move(world_frame)) {}

void CutEventPublisher::publish(const CutResult& result, const PolyhedralMesh& mesh,
                                const std::string& source, const ros::Time& stamp, double time_s) const {
  CutEvent msg;
  msg.header.stamp = stamp;
  msg.header.frame_id = world_frame_;
  msg.time_s = time_s;
  msg.cut = result.cut;
  msg.source = source;
  msg.message = result.message;
  for (const CellId cell : result.change.removed_cells) msg.parents.push_back(cell.index());
  for (const NewCell& cell : result.change.new_cells) {
    msg.children.push_back(cell.cell.index());
    msg.child_parents.push_back(cell.parent.index());
  }
  for (const FaceId id : result.change.changed_faces) {
    const Face& face = mesh.face(id);
    if (id.index() >= faces_before_ && face.isAlive() && face.cut == result.cut) ++msg.new_faces;
  }
  msg.new_vertices = static_cast<int>(result.change.new_vertices.size());
  msg.pieces_before = result.pieces_before;
  msg.pieces_after = result.pieces_after;
  msg.cells_split = result.cells_split;
  msg.cells_left_whole = result.cells_left_whole;
  msg.cut_area_m2 = result.cut_area_m2;
  publisher_.publish(msg);
}

}  // namespace polyscalpel
