// SPDX-License-Identifier: BSD-3-Clause
#include <exception>

#include <ros/ros.h>

#include "polyscalpel/ros_bridge/path_player.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "simulated_tool");
  try {
    const polyscalpel::PathPlayerConfig config = polyscalpel::readPathPlayerConfig(ros::NodeHandle("~"));
    polyscalpel::PathPlayer(config, ros::NodeHandle()).run();
  } catch (const std::exception& exception) {
    ROS_FATAL("%s", exception.what());
    return 1;
  }
  return 0;
}
