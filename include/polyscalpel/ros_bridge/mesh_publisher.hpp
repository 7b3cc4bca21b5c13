// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/time.h>
#include <visualization_msgs/MarkerArray.h>
#include <Eigen/Geometry>

#include "polyscalpel/ros_bridge/parameters.hpp"
#include "polyscalpel/ros_bridge/tissue_markers.hpp"
#include "polyscalpel/simulation/simulation.hpp"

namespace polyscalpel {

/// Publishes everything that can be seen on the latched topic `mesh`: namespaces surface, cut_faces,
/// colours (what they show), wireframe, pieces, pending (one marker a blade, a point for each edge that it
/// has crossed and that is not split yet), tools, blades, contacts. Markers that are no longer there are
/// deleted in the next message.
class MeshPublisher {
 public:
  /// Throws std::invalid_argument for a bad display shape. parameters and simulation must outlive the
  /// publisher.
  MeshPublisher(ros::NodeHandle& node_handle, const SceneParameters& parameters,
                const Simulation& simulation);

  /// T_world_tool: one a tool, nothing where it is not there. contacts: of the last step.
  void publish(const std::vector<std::optional<Eigen::Isometry3d>>& T_world_tool,
               const std::vector<AppliedContact>& contacts, const ros::Time& stamp);

 private:
  struct Part {
    SurfaceTriangles triangles;  // in the tool's frame
    Rgba colour_rgba;
  };

  visualization_msgs::Marker makeLabel(const std::string& name, int id, const std::string& text) const;
  void addSurface(visualization_msgs::MarkerArray& array) const;
  void addTissue(visualization_msgs::MarkerArray& array) const;
  void addTool(visualization_msgs::MarkerArray& array, std::size_t tool,
               const Eigen::Isometry3d& T_world_tool) const;
  void addPending(visualization_msgs::MarkerArray& array) const;
  void addContacts(visualization_msgs::MarkerArray& array, const std::vector<AppliedContact>& contacts) const;

  const SceneParameters& parameters_;
  const Simulation& simulation_;
  ros::Publisher publisher_;
  double body_size_m_;  // diagonal of the rest shape's box: what labels and arrows are scaled by
  std::vector<std::vector<Part>> tool_parts_;  // for each tool
  std::set<std::pair<std::string, int>> shown_;
};

}  // namespace polyscalpel
