// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/path_player.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>

#include "polyscalpel/ros_bridge/geometry_conversions.hpp"
#include "polyscalpel/ros_bridge/parameters.hpp"
#include "polyscalpel/ros_bridge/resource_path.hpp"

namespace polyscalpel {
namespace {

const Range kRateRange{0.1, 10000};
constexpr int kMostSubscribers = 100;
/// After the last pose: time for the transport to hand it over before the node ends [s].
constexpr double kLinger_s = 1;

KeyFrames loadFor(const PathPlayerConfig& config) {
  if (config.path.empty())
    throw std::invalid_argument("parameter ~path is missing: must be a file of key frames");
  return loadKeyFrames(findResource(config.path, {""}));
}

bool flagParameter(const ros::NodeHandle& private_node_handle, const std::string& name, bool default_value) {
  XmlRpc::XmlRpcValue value;
  if (!private_node_handle.getParam(name, value)) return default_value;
  if (value.getType() != XmlRpc::XmlRpcValue::TypeBoolean)
    throw std::invalid_argument("parameter " + private_node_handle.resolveName(name) +
                                ": must be true or false");
  return static_cast<bool>(value);
}

double rateParameter(const ros::NodeHandle& private_node_handle, double default_value) {
  XmlRpc::XmlRpcValue value;
  if (!private_node_handle.getParam("rate", value)) return default_value;
  double rate_hz = std::nan("");
  if (value.getType() == XmlRpc::XmlRpcValue::TypeInt) rate_hz = static_cast<int>(value);
  if (value.getType() == XmlRpc::XmlRpcValue::TypeDouble) rate_hz = static_cast<double>(value);
  if (!kRateRange.contains(rate_hz))
    throw std::invalid_argument("parameter " + private_node_handle.resolveName("rate") +
                                ": must be a number in " + kRateRange.text() + " Hz");
  return rate_hz;
}

int countParameter(const ros::NodeHandle& private_node_handle, int default_value) {
  XmlRpc::XmlRpcValue value;
  if (!private_node_handle.getParam("wait_for_subscribers", value)) return default_value;
  const int count = value.getType() == XmlRpc::XmlRpcValue::TypeInt ? static_cast<int>(value) : -1;
  if (count < 0 || count > kMostSubscribers)
    throw std::invalid_argument("parameter " + private_node_handle.resolveName("wait_for_subscribers") +
                                ": must be an integer in [0, " + std::to_string(kMostSubscribers) + "]");
  return count;
}

}  // namespace

PathPlayerConfig readPathPlayerConfig(const ros::NodeHandle& private_node_handle) {
  warnOfUnknownParameters(private_node_handle, {"path", "tool", "topic", "frame_id", "rate", "loop", "stay",
                                                "wait_for_subscribers"});
  PathPlayerConfig config;
  config.path = textParameter(private_node_handle, "path", config.path);
  config.tool = textParameter(private_node_handle, "tool", config.tool);
  config.topic = textParameter(private_node_handle, "topic", config.topic);
  config.frame_id = textParameter(private_node_handle, "frame_id", config.frame_id);
  config.rate_hz = rateParameter(private_node_handle, config.rate_hz);
  config.loop = flagParameter(private_node_handle, "loop", config.loop);
  config.stay = flagParameter(private_node_handle, "stay", config.stay);
  config.wait_for_subscribers = countParameter(private_node_handle, config.wait_for_subscribers);
  return config;
}

PathPlayer::PathPlayer(const PathPlayerConfig& config, ros::NodeHandle node_handle)
    : PathPlayer(config, loadFor(config), node_handle) {}

PathPlayer::PathPlayer(const PathPlayerConfig& config, const KeyFrames& key_frames,
                       ros::NodeHandle& node_handle)
    : config_(config), path_(key_frames) {
  frame_id_ = config.frame_id.empty() ? key_frames.frame : config.frame_id;
  const std::string tool = config.tool.empty() ? key_frames.tool : config.tool;
  const std::string topic = config.topic.empty() ? tool + "/measured_cp" : config.topic;
  // Unbounded: no pose may be lost where a slow subscriber runs in lockstep.
  publisher_ = node_handle.advertise<geometry_msgs::PoseStamped>(topic, 0);
  ROS_INFO("%s: %.2f s on %s", config.path.c_str(), path_.duration_s(), publisher_.getTopic().c_str());
}

bool PathPlayer::waitForSubscribers() const {
  while (ros::ok() && static_cast<int>(publisher_.getNumSubscribers()) < config_.wait_for_subscribers) {
    ros::spinOnce();
    ros::WallDuration(0.01).sleep();
  }
  while (ros::ok() && ros::Time::now().isZero()) ros::WallDuration(0.01).sleep();  // no /clock yet
  return ros::ok();
}

void PathPlayer::publish(std::int64_t number, const ros::Time& start) const {
  const double time_s = static_cast<double>(number) / config_.rate_hz;
  geometry_msgs::PoseStamped message;
  message.header.stamp = start + ros::Duration(time_s);
  message.header.frame_id = frame_id_;
  message.pose = toPoseMsg(path_.at(config_.loop ? std::fmod(time_s, path_.duration_s()) : time_s));
  publisher_.publish(message);
}

void PathPlayer::run() {
  if (!waitForSubscribers()) return;
  const std::int64_t last = std::llround(std::ceil(path_.duration_s() * config_.rate_hz));
  const bool for_ever = config_.loop || config_.stay;
  ros::Time start = ros::Time::now();
  ros::Time last_now = start;
  for (std::int64_t number = 0; ros::ok() && (for_ever || number <= last);) {
    ros::spinOnce();
    const ros::Time now = ros::Time::now();
    if (now < last_now) {  // a bag loops: so does the path
      start = now;
      number = 0;
    }
    last_now = now;
    const ros::Time due = start + ros::Duration(static_cast<double>(number) / config_.rate_hz);
    if (now < due) {
      ros::WallDuration(std::min(0.005, std::max(0.0002, (due - now).toSec()))).sleep();
      continue;
    }
    publish(number++, start);
  }
  if (ros::ok()) ros::WallDuration(kLinger_s).sleep();
}

}  // namespace polyscalpel
