// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include "polyscalpel/ros_bridge/key_frames.hpp"

namespace polyscalpel {

/// How a path is played.
struct PathPlayerConfig {
  std::string path;              ///< file of key frames, required
  std::string tool;              ///< name of the tool; empty: as in the file
  std::string topic;             ///< of the poses; empty: <tool>/measured_cp
  std::string frame_id;          ///< tf frame of the poses; empty: as in the file
  double rate_hz = 100;          ///< poses a second, in [0.1, 10000]
  bool loop = false;             ///< again and again from the start
  bool stay = false;             ///< after the end: keep publishing the last pose instead of exiting
  int wait_for_subscribers = 1;  ///< do not start before so many listen, in [0, 100]
};

/// Reads ~path, ~tool, ~topic, ~frame_id, ~rate, ~loop, ~stay, ~wait_for_subscribers. Throws
/// std::invalid_argument.
PathPlayerConfig readPathPlayerConfig(const ros::NodeHandle& private_node_handle);

/// Publishes the poses of a tool along key frames, on ROS time: wall time, or /clock with use_sim_time. The
/// i-th pose bears the stamp start + i / rate exactly, whenever it is sent.
class PathPlayer {
 public:
  /// Throws std::invalid_argument for a bad file.
  PathPlayer(const PathPlayerConfig& config, ros::NodeHandle node_handle);

  /// Until the end of the path, or until ROS shuts down.
  void run();

 private:
  PathPlayer(const PathPlayerConfig& config, const KeyFrames& key_frames, ros::NodeHandle& node_handle);
  bool waitForSubscribers() const;
  void publish(std::int64_t number, const ros::Time& start) const;

  PathPlayerConfig config_;
  std::string frame_id_;
  ToolPath path_;
  ros::Publisher publisher_;
};

}  // namespace polyscalpel
