// SPDX-License-Identifier: BSD-3-Clause
#include <exception>

#include <ros/ros.h>

#include "polyscalpel/ros_bridge/path_player.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "simulated_tool");
  // Held until the end: with the last handle ROS shuts down, and a message logged after that is lost.
  ros::NodeHandle node_handle;
  try {
    const polyscalpel::PathPlayerConfig config = polyscalpel::readPathPlayerConfig(ros::NodeHandle("~"));
    polyscalpel::PathPlayer(config, node_handle).run();
  } catch (const std::exception& exception) {
    ROS_FATAL("%s", exception.what());
    return 1;
  }
  return 0;
}
