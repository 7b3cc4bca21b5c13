// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/simulation_node.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <thread>

#include <geometry_msgs/WrenchStamped.h>
#include <ros/callback_queue.h>

#include "polyscalpel/ros_bridge/conversions.hpp"

namespace polyscalpel {
namespace {

/// Longest wait for messages [s], so that shutdown and diagnostics are not kept waiting.
constexpr double kIdleWait_s = 0.05;
/// With simulated time: how often the clock is looked at [s].
constexpr double kClockPoll_s = 0.001;
constexpr double kDiagnosticsPeriod_s = 1;
constexpr std::uint32_t kMostSteps = 100000;

double steadyNow_s() {
  return ros::SteadyTime::now().toSec();
}

void warnOfSolver(const SceneParameters& parameters) {
  const SolverConfig& solver = parameters.simulation.solver;
  if (leavesOutBudget(parameters))
    ROS_WARN(
        "solver.step_budget_ms = %g is left out in lockstep, so that a bag replays to the same bits; "
        "node.budget_in_lockstep keeps it",
        *solver.step_budget_ms);
  const unsigned int num_cores = std::thread::hardware_concurrency();  // 0: not known
  if (num_cores > 0 && static_cast<unsigned int>(solver.threads) > num_cores)
    ROS_WARN("solver.threads = %d: this machine has %u cores; more threads than cores are no faster",
             solver.threads, num_cores);
}

}  // namespace

SimulationNode::SimulationNode(const SceneParameters& parameters, const ros::NodeHandle& node_handle)
    : parameters_(parameters),
      node_handle_(node_handle),
      simulation_(makeSimulationConfig(parameters)),
      stamp_clock_(static_cast<int>(parameters.tools.size()), parameters.node.clock_jump_s,
                   parameters.node.longest_gap_s),
      transforms_(parameters.node.world_frame, parameters.node.clock_jump_s),
      lockstep_clock_(parameters.simulation.integration.time_step_s, parameters.node.tool_timeout_s),
      mesh_publisher_(node_handle_, parameters_, simulation_),
      cut_event_publisher_(node_handle_, parameters.node.world_frame),
      is_paused_(parameters.node.start_paused),
      T_world_tool_(parameters.tools.size()) {
  const NodeConfig& node = parameters_.node;
  const double time_step_s = parameters_.simulation.integration.time_step_s;
  steps_per_mesh_ = std::max<std::int64_t>(1, std::llround(1 / (node.mesh_rate_hz * time_step_s)));
  for (std::size_t i = 0; i < parameters_.tools.size(); ++i)
    trackers_.emplace_back(static_cast<int>(i), parameters_.tools[i].frame, node.tool_timeout_s,
                           node.tf_timeout_s, stamp_clock_, transforms_);
  status_.tools.resize(trackers_.size());
  for (std::size_t i = 0; i < trackers_.size(); ++i)
    status_.tools[i].name = parameters_.simulation.tools[i].name;
  status_.converged = true;
  status_.budget_left_out = leavesOutBudget(parameters_);
  warnOfSolver(parameters_);
  for (const std::string& remark : simulation_.remarks()) ROS_INFO("mesh: %s", remark.c_str());
  cut_event_publisher_.noteFaces(simulation_.mesh());
  advertise();
  subscribe();
  publishTissueFrame();
  publishMesh();
  publishStatus();
  ROS_INFO("%d cells, %d vertices, %zu tools, %s", simulation_.mesh().numCells(),
           simulation_.mesh().numVertices(), trackers_.size(), status_.clock.c_str());
}

void SimulationNode::advertise() {
  status_publisher_ = node_handle_.advertise<StepStatus>("status", 1000, true);
  contacts_publisher_ = node_handle_.advertise<ContactForces>("contacts", 1000);
  diagnostics_publisher_ = node_handle_.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 10);
  for (const ToolConfig& tool : parameters_.simulation.tools)
    wrench_publishers_.push_back(
        node_handle_.advertise<geometry_msgs::WrenchStamped>(tool.name + "/body/measured_cf", 1000));
  services_ = {node_handle_.advertiseService("reset", &SimulationNode::onReset, this),
               node_handle_.advertiseService("cut", &SimulationNode::onCut, this),
               node_handle_.advertiseService("set_paused", &SimulationNode::onSetPaused, this),
               node_handle_.advertiseService("step", &SimulationNode::onStep, this)};
}

void SimulationNode::subscribe() {
  // Unbounded: in lockstep no pose may be lost, however slow the machine.
  constexpr std::uint32_t kUnbounded = 0;
  const auto hints = ros::TransportHints().tcpNoDelay();
  for (std::size_t i = 0; i < parameters_.tools.size(); ++i) {
    if (!parameters_.tools[i].follow_frame.empty()) continue;
    const boost::function<void(const geometry_msgs::PoseStamped::ConstPtr&)> callback =
        [this, i](const geometry_msgs::PoseStamped::ConstPtr& message) { onPose(i, *message); };
    subscribers_.push_back(
        node_handle_.subscribe(parameters_.tools[i].topic, kUnbounded, callback, {}, hints));
  }
  for (const bool is_static : {false, true}) {
    const boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)> callback =
        [this, is_static](const tf2_msgs::TFMessage::ConstPtr& message) {
          onTransforms(*message, is_static);
        };
    subscribers_.push_back(
        node_handle_.subscribe(is_static ? "/tf_static" : "/tf", kUnbounded, callback, {}, hints));
  }
}

void SimulationNode::onPose(std::size_t tool, const geometry_msgs::PoseStamped& message) {
  try {
    if (trackers_[tool].add(message, ros::Time::now()))
      ROS_WARN("tool %s: the stamps of its poses jumped to %.3f s; its time begins anew",
               parameters_.simulation.tools[tool].name.c_str(), message.header.stamp.toSec());
  } catch (const std::exception& exception) {
    ROS_ERROR("pose of tool %s: %s", parameters_.simulation.tools[tool].name.c_str(), exception.what());
  }
}

void SimulationNode::onTransforms(const tf2_msgs::TFMessage& message, bool is_static) {
  try {
    transforms_.add(message, is_static);
    for (std::size_t i = 0; i < trackers_.size(); ++i) {
      const std::string& frame = parameters_.tools[i].follow_frame;
      if (frame.empty()) continue;
      const std::optional<StampedTransform> pose = transforms_.find(frame, ros::Time());
      if (pose && trackers_[i].addFollowed(*pose, ros::Time::now()))
        ROS_WARN("tool %s: the stamps of frame %s jumped; its time begins anew",
                 parameters_.simulation.tools[i].name.c_str(), frame.c_str());
    }
  } catch (const std::exception& exception) {
    ROS_ERROR("transforms: %s", exception.what());
  }
}

bool SimulationNode::onReset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  try {
    simulation_.reset();
    cut_event_publisher_.noteFaces(simulation_.mesh());
    stamp_clock_.clear();
    transforms_.clear();
    lockstep_clock_.clear();
    for (ToolTracker& tracker : trackers_) tracker.clear(true);
    for (ToolStatus& tool : status_.tools) {
      const std::string name = tool.name;
      tool = ToolStatus();
      tool.name = name;
    }
    report_ = StepReport();
    clearStepCounts(status_);
    T_world_tool_.assign(trackers_.size(), std::nullopt);
    stamp_ = ros::Time();
    broadcast_stamp_ = ros::Time();
    body_counter_.topologyChanged();
    rate_meter_.clear();
    restartPace();
    publishMesh();
    publishStatus();
    response.success = true;
    response.message = "the rest mesh, uncut, at time 0";
  } catch (const std::exception& exception) {
    response.success = false;
    response.message = exception.what();
  }
  return true;
}

bool SimulationNode::onCut(Cut::Request& request, Cut::Response& response) {
  response.success = false;
  response.pieces_before = response.pieces = simulation_.pieces().count;
  try {
    Eigen::Isometry3d T_world_frame = Eigen::Isometry3d::Identity();
    if (!request.header.frame_id.empty()) {
      const std::optional<StampedTransform> found =
          transforms_.find(request.header.frame_id, request.header.stamp);
      if (!found)
        throw std::invalid_argument("header.frame_id = " + request.header.frame_id +
                                    ": must be a tf frame connected to " + parameters_.node.world_frame +
                                    " at the time header.stamp");
      T_world_frame = found->T_world_frame;
    }
    makeCuts(fromMsg(request, T_world_frame), response);
  } catch (const std::exception& exception) {
    response.success = false;
    response.message = exception.what();
  }
  response.pieces = simulation_.pieces().count;
  response.cells = simulation_.mesh().numCells();
  if (response.cuts > 0) {
    body_counter_.topologyChanged();
    publishMesh();
    publishStatus();
  }
  return true;
}

void SimulationNode::makeCuts(const std::vector<CutOperation>& operations, Cut::Response& response) {
  const CutReport report = simulation_.cutAll(operations);
  const CutResult& result = report.result;
  response.message = result.message;
  response.cells_left_whole = result.cells_left_whole;
  response.success = result.status == CutStatus::kCut;
  if (!response.success) return;
  response.cuts = result.num_cuts;
  response.cells_split = result.cells_split;
  response.cut_area_m2 = result.cut_area_m2;
  response.debris_pieces = report.debris.num_pieces;
  response.debris_volume_m3 = report.debris.volume_m3;
  publishCut(report, stateStamp());
  cut_event_publisher_.noteFaces(simulation_.mesh());
}

void SimulationNode::publishCut(const CutReport& report, const ros::Time& stamp) {
  const std::string source = report.cause == CutCause::kFracture ? "fracture"
                             : report.cause == CutCause::kRequest
                                 ? "service"
                                 : parameters_.simulation.tools[static_cast<std::size_t>(report.tool)].name;
  cut_event_publisher_.publish(report, simulation_.mesh(), source, stamp, simulation_.time_s());
  if (report.debris.num_pieces > 0)
    ROS_INFO("%d pieces of %.3g ml in all are taken away as debris", report.debris.num_pieces,
             report.debris.volume_m3 * 1e6);
}

bool SimulationNode::onSetPaused(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
  response.success = true;
  response.message = request.data == is_paused_ ? (is_paused_ ? "was paused already" : "was running already")
                                                : (request.data ? "paused" : "running");
  is_paused_ = request.data;
  restartPace();
  publishMesh();
  publishStatus();
  return true;
}

bool SimulationNode::onStep(Step::Request& request, Step::Response& response) {
  response.success = false;
  try {
    if (!is_paused_)
      throw std::invalid_argument("the simulation is running: pause it first (service set_paused)");
    if (request.steps < 1 || request.steps > kMostSteps)
      throw std::invalid_argument("steps = " + std::to_string(request.steps) + ": must be in [1, " +
                                  std::to_string(kMostSteps) + "]");
    std::uint32_t done = 0;
    for (; done < request.steps && ros::ok(); ++done) {
      if (parameters_.node.clock == ClockMode::kRealtime) {
        const ros::Time now = ros::Time::now();
        step(latestPoses(now), now);
        continue;
      }
      const std::optional<LockstepInput> input = nextLockstepInput(true);
      if (!input) break;
      step(input->T_world_tool, input->stamp);
    }
    publishMesh();
    response.success = done == request.steps;
    response.message = std::to_string(done) + " of " + std::to_string(request.steps) + " steps made";
    if (!response.success) response.message += ": there are no poses for more";
  } catch (const std::exception& exception) {
    response.message = exception.what();
  }
  response.step = simulation_.stepCount();
  response.time_s = simulation_.time_s();
  return true;
}

void SimulationNode::run() {
  double wait_s = 0;
  while (ros::ok()) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(wait_s));
    try {
      wait_s = advance();
    } catch (const std::exception& exception) {
      ROS_ERROR_THROTTLE(1, "step: %s", exception.what());
      status_.converged = false;
      status_.message = exception.what();
      publishStatus();
      restartPace();
      wait_s = kIdleWait_s;
    }
    if (steadyNow_s() >= diagnostics_due_s_) {
      diagnostics_due_s_ = steadyNow_s() + kDiagnosticsPeriod_s;
      publishDiagnostics();
    }
  }
}

double SimulationNode::advance() {
  const ros::Time now = ros::Time::now();
  noticeClockSetBack(now);
  if (parameters_.node.clock == ClockMode::kRealtime) {
    for (ToolTracker& tracker : trackers_) tracker.resolveByTime(now);
    return advanceRealtime(now);
  }
  for (ToolTracker& tracker : trackers_) tracker.resolveByStamps();
  if (is_paused_) return kIdleWait_s;
  const std::optional<LockstepInput> input = nextLockstepInput(false);
  if (!input) return kIdleWait_s;
  step(input->T_world_tool, input->stamp);
  return 0;
}

double SimulationNode::advanceRealtime(const ros::Time& now) {
  if (is_paused_ || now.isZero()) return kIdleWait_s;
  const ros::Duration time_step(parameters_.simulation.integration.time_step_s);
  if (!next_due_) {
    next_due_ = now;
    pace_start_ = now;
    pace_start_time_s_ = simulation_.time_s();
  }
  if (now < *next_due_) {
    const double rest_s = (*next_due_ - now).toSec();
    return std::min(rest_s, ros::Time::isSystemTime() ? kIdleWait_s : kClockPoll_s);
  }
  lag_s_ = std::max(0.0, (now - pace_start_).toSec() - (simulation_.time_s() - pace_start_time_s_));
  step(latestPoses(now), now);
  // One late step may be caught up with; more are not: simulated time falls behind.
  next_due_ = std::max(*next_due_ + time_step, ros::Time::now() - time_step);
  return 0;
}

void SimulationNode::noticeClockSetBack(const ros::Time& now) {
  const bool was_set_back = now < last_now_;
  last_now_ = now;
  if (!was_set_back || parameters_.node.clock != ClockMode::kRealtime) return;
  ROS_WARN("the clock was set back to %.3f s: tools and frames are forgotten, the tissue stays as it is",
           now.toSec());
  stamp_clock_.clear();
  transforms_.clear();
  for (ToolTracker& tracker : trackers_) tracker.clear(false);
  broadcast_stamp_ = ros::Time();
  restartPace();
}

void SimulationNode::restartPace() {
  next_due_.reset();
  lag_s_ = 0;
}

std::optional<LockstepInput> SimulationNode::nextLockstepInput(bool may_go_without_poses) {
  if (may_go_without_poses && stamp_clock_.latestEpoch() < 0)
    return LockstepInput{stamp_, ToolPoses(trackers_.size())};
  return lockstep_clock_.next(trackers_, stamp_clock_);
}

SimulationNode::ToolPoses SimulationNode::latestPoses(const ros::Time& now) {
  ToolPoses poses;
  for (ToolTracker& tracker : trackers_) poses.push_back(tracker.latest(now));
  return poses;
}

void SimulationNode::step(const ToolPoses& T_world_tool, const ros::Time& stamp) {
  const StepReport report = simulation_.step(T_world_tool);
  if (!report.converged)
    ROS_ERROR_THROTTLE(1, "step %ld: %s", simulation_.stepCount(), report.message.c_str());
  stamp_ = stamp;
  T_world_tool_ = T_world_tool;
  report_ = report;
  countStep(status_, report);
  rate_meter_.add(steadyNow_s());
  for (std::size_t i = 0; i < report.tools.size(); ++i) {
    ToolStatus& tool = status_.tools[i];
    if (report.tools[i].reseated && tool.enabled) ++tool.jumps;
    tool.enabled = report.tools[i].enabled;
    tool.reseated = report.tools[i].reseated;
    tool.refusal = report.tools[i].refusal;
    if (!tool.refusal.empty()) ROS_WARN("tool %s: not cut: %s", tool.name.c_str(), tool.refusal.c_str());
  }
  for (const CutReport& cut : report.cuts) publishCut(cut, stamp);
  if (!report.cuts.empty()) {
    body_counter_.topologyChanged();
    cut_event_publisher_.noteFaces(simulation_.mesh());
  }
  publishTools(report, T_world_tool);
  if (simulation_.stepCount() % steps_per_mesh_ == 0) publishMesh();
  publishStatus();
}

ros::Time SimulationNode::stateStamp() const {
  return parameters_.node.clock == ClockMode::kRealtime ? ros::Time::now() : stamp_;
}

void SimulationNode::publishMesh() {
  mesh_publisher_.publish(T_world_tool_, report_.contacts, stateStamp());
}

void SimulationNode::publishTools(const StepReport& report, const ToolPoses& T_world_tool) {
  std::vector<geometry_msgs::TransformStamped> transforms;
  for (std::size_t i = 0; i < T_world_tool.size(); ++i) {
    if (!T_world_tool[i]) continue;
    geometry_msgs::WrenchStamped wrench;
    wrench.header.stamp = stamp_;
    wrench.header.frame_id = parameters_.tools[i].frame;
    wrench.wrench = toMsg(report.tools[i].wrench_tool);
    wrench_publishers_[i].publish(wrench);
    if (!parameters_.tools[i].broadcast_tf) continue;
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = stamp_;
    transform.header.frame_id = parameters_.node.world_frame;
    transform.child_frame_id = parameters_.tools[i].frame;
    transform.transform = toTransformMsg(*T_world_tool[i]);
    transforms.push_back(transform);
  }
  // tf refuses a transform twice at one time.
  if (!transforms.empty() && stamp_ > broadcast_stamp_) tf_broadcaster_.sendTransform(transforms);
  broadcast_stamp_ = stamp_;

  ContactForces contacts = toMsg(report.contacts, parameters_.simulation.tools);
  contacts.header.stamp = stamp_;
  contacts.header.frame_id = parameters_.node.world_frame;
  contacts.time_s = simulation_.time_s();
  contacts_publisher_.publish(contacts);
}

void SimulationNode::publishStatus() {
  const bool is_realtime = parameters_.node.clock == ClockMode::kRealtime;
  status_.header.stamp = stateStamp();
  status_.header.frame_id = parameters_.node.world_frame;
  status_.step = simulation_.stepCount();
  status_.time_s = simulation_.time_s();
  status_.time_step_s = parameters_.simulation.integration.time_step_s;
  status_.clock = is_realtime ? "realtime" : "lockstep";
  status_.paused = is_paused_;
  status_.lag_s = is_realtime ? lag_s_ : lockstep_clock_.lead_s(stamp_clock_);
  status_.steps_per_second = rate_meter_.rate_hz(steadyNow_s());
  fillStep(status_, report_);
  fillStress(status_, simulation_.stressField());
  body_counter_.fill(status_, simulation_);
  for (std::size_t i = 0; i < trackers_.size(); ++i) {
    fillTool(status_.tools[i], trackers_[i].counters());
    status_.tools[i].pending_crossings = simulation_.numPending(static_cast<int>(i));
  }
  status_publisher_.publish(status_);
}

void SimulationNode::publishDiagnostics() {
  // Between steps too: poses may be refused, and the steps may have stopped.
  status_.paused = is_paused_;
  status_.steps_per_second = rate_meter_.rate_hz(steadyNow_s());
  for (std::size_t i = 0; i < trackers_.size(); ++i) fillTool(status_.tools[i], trackers_[i].counters());
  diagnostic_msgs::DiagnosticArray array = makeDiagnostics(status_, diagnosed_);
  array.header.stamp = ros::Time::now();
  diagnostics_publisher_.publish(array);
  diagnosed_ = status_;
}

void SimulationNode::publishTissueFrame() {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time::now();
  transform.header.frame_id = parameters_.node.world_frame;
  transform.child_frame_id = parameters_.node.tissue_frame;
  transform.transform.rotation.w = 1;
  static_tf_broadcaster_.sendTransform(transform);
}

}  // namespace polyscalpel
