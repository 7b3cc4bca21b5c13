// SPDX-License-Identifier: BSD-3-Clause
#include <exception>

#include <ros/ros.h>

#include "polyscalpel/ros_bridge/parameters.hpp"
#include "polyscalpel/ros_bridge/simulation_node.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "polyscalpel");
  // Held until the end: with the last handle ROS shuts down, and a message logged after that is lost.
  ros::NodeHandle node_handle;
  try {
    const polyscalpel::SceneParameters parameters = polyscalpel::loadFromNode(ros::NodeHandle("~"));
    polyscalpel::SimulationNode node(parameters, node_handle);
    node.run();
  } catch (const std::exception& exception) {
    ROS_FATAL("%s", exception.what());
    return 1;
  }
  return 0;
}
