// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/time.h>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel {

/// Publishes changes of topology on `cut_events`.
class CutEventPublisher {
 public:
  CutEventPublisher(ros::NodeHandle& node_handle, std::string world_frame);

  /// To be called at the start, after a reset and once the cuts of a step are published: faces that exist now
  /// are not new in the events to come, although the stroke that goes on gives them the same number.
  void noteFaces(const PolyhedralMesh& mesh) { faces_before_ = mesh.faceCapacity(); }

  /// mesh: after the cut. source: name of the tool, or "service". time_s: simulated time.
  void publish(const CutReport& report, const PolyhedralMesh& mesh, const std::string& source,
               const ros::Time& stamp, double time_s) const;

 private:
  ros::Publisher publisher_;
  std::string world_frame_;
  int faces_before_ = 0;
};

}  // namespace polyscalpel
