// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/mesh_publisher.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <numeric>

#include "polyscalpel/ros_bridge/field_colours.hpp"
#include "polyscalpel/ros_bridge/geometry_conversions.hpp"
#include "polyscalpel/ros_bridge/piece_colours.hpp"

namespace polyscalpel {
namespace {

using visualization_msgs::Marker;

/// More arrows than this only hide one another; the largest forces are drawn.
constexpr std::size_t kMostArrows = 200;
/// Messages kept for a subscriber that lags. In real time only the newest matter; in lockstep a bag should
/// get them all.
constexpr std::uint32_t kRealtimeQueue = 5;
constexpr std::uint32_t kLockstepQueue = 500;
/// Of the label that tells what the colours show, above the body's top, in body sizes: clear of the pieces'
/// own.
constexpr double kColourLabelHeight = 0.25;
const Rgba kWireColour(0.15, 0.05, 0.05, 0.6);
const Rgba kBladeColour(1.0, 0.95, 0.6, 1);
const Rgba kPendingColour(0.25, 0.85, 1.0, 1);
const Rgba kArrowColour(1.0, 0.82, 0.15, 1);
const Rgba kLabelColour(1, 1, 1, 1);

Marker named(Marker marker, const std::string& name, int id) {
  marker.ns = name;
  marker.id = id;
  return marker;
}

}  // namespace

MeshPublisher::MeshPublisher(ros::NodeHandle& node_handle, const SceneParameters& parameters,
                             const Simulation& simulation)
    : parameters_(parameters),
      simulation_(simulation),
      publisher_(node_handle.advertise<visualization_msgs::MarkerArray>(
          "mesh", parameters.node.clock == ClockMode::kLockstep ? kLockstepQueue : kRealtimeQueue, true)) {
  const auto rest = simulation.mesh().restPositions();
  body_size_m_ = (rest.rowwise().maxCoeff() - rest.rowwise().minCoeff()).norm();
  for (std::size_t i = 0; i < parameters.tools.size(); ++i) {
    const ToolInputConfig& input = parameters.tools[i];
    std::vector<Part> parts;
    for (const DisplayShape& display : input.display)
      parts.push_back({makeSurfaceTriangles(ToolShape(display.shape).triangles()), display.colour_rgba});
    const std::optional<ShapeConfig>& shape = parameters.simulation.tools[i].shape;
    if (parts.empty() && shape)
      parts.push_back({makeSurfaceTriangles(ToolShape(*shape).triangles()), input.colour_rgba});
    tool_parts_.push_back(std::move(parts));
  }
}

Marker MeshPublisher::makeLabel(const std::string& name, int id, const std::string& text) const {
  Marker label = named(Marker(), name, id);
  label.type = Marker::TEXT_VIEW_FACING;
  label.pose.orientation.w = 1;
  label.scale.z = 0.05 * body_size_m_;
  label.color = toColourMsg(kLabelColour);
  label.text = text;
  return label;
}

void MeshPublisher::addSurface(visualization_msgs::MarkerArray& array) const {
  const PolyhedralMesh& mesh = simulation_.mesh();
  const Eigen::Matrix3Xd& positions = simulation_.positions();
  const NodeConfig& node = parameters_.node;
  const bool shows_field = node.colour_by != ColourBy::kNone && node.colour_by != ColourBy::kPiece;
  const StressField* field = shows_field ? simulation_.stressField() : nullptr;
  Eigen::VectorXd values;
  Eigen::Vector2d range_pa = Eigen::Vector2d::Zero();
  if (field != nullptr) {
    values = vertexValues(mesh, *field, node.colour_by);
    range_pa = colourRange(values, node.colour_range_pa);
    Marker label = makeLabel("colours", 0, describeColours(node.colour_by, range_pa));
    Eigen::AlignedBox3d box;
    for (int i = 0; i < mesh.numVertices(); ++i) {
      if (!mesh.isRetired(VertexId(i))) box.extend(positions.col(i));
    }
    label.pose.position = toPointMsg(box.center());
    label.pose.position.z = box.max().z() + kColourLabelHeight * body_size_m_;
    array.markers.push_back(std::move(label));
  }
  const auto add = [&](bool cut_faces, const Rgba& rgba, const std::string& name) {
    const SurfaceTriangles triangles = makeSurfaceTriangles(mesh, positions, cut_faces);
    Marker marker = named(makeTriangleMarker(triangles, rgba), name, 0);
    if (field != nullptr) colourByValues(marker, mesh, triangles, values, range_pa);
    if (node.colour_by == ColourBy::kPiece) colourByPieces(marker, mesh, triangles, simulation_.pieces());
    array.markers.push_back(std::move(marker));
  };
  add(false, node.surface_colour_rgba, "surface");
  if (simulation_.numCuts() > 0) add(true, node.cut_colour_rgba, "cut_faces");
}

void MeshPublisher::addTissue(visualization_msgs::MarkerArray& array) const {
  const PolyhedralMesh& mesh = simulation_.mesh();
  const Eigen::Matrix3Xd& positions = simulation_.positions();
  const NodeConfig& node = parameters_.node;
  addSurface(array);
  if (node.wireframe) {
    Marker wireframe = named(makeWireframeMarker(mesh, positions), "wireframe", 0);
    wireframe.scale.x = 0.002 * body_size_m_;
    wireframe.color = toColourMsg(kWireColour);
    array.markers.push_back(std::move(wireframe));
  }
  if (!node.piece_labels || simulation_.pieces().count < 2) return;
  const std::vector<PieceSummary> pieces = summarisePieces(mesh, simulation_.pieces(), positions);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    char text[64];
    std::snprintf(text, sizeof(text), "piece %zu: %.1f ml", i + 1, pieces[i].volume_m3 * 1e6);
    Marker label = makeLabel("pieces", static_cast<int>(i), text);
    label.pose.position = toPointMsg(pieces[i].label_point + 0.06 * body_size_m_ * Eigen::Vector3d::UnitZ());
    array.markers.push_back(std::move(label));
  }
}

void MeshPublisher::addTool(visualization_msgs::MarkerArray& array, std::size_t tool,
                            const Eigen::Isometry3d& T_world_tool) const {
  int id = static_cast<int>(tool) * 100;
  for (const Part& part : tool_parts_[tool]) {
    SurfaceTriangles triangles = part.triangles;
    for (Eigen::Matrix3d& corners : triangles.corners) corners = (T_world_tool * corners).eval();
    for (Eigen::Matrix3d& normals : triangles.normals) normals = (T_world_tool.linear() * normals).eval();
    array.markers.push_back(named(makeTriangleMarker(triangles, part.colour_rgba), "tools", id++));
  }
  const std::optional<Eigen::Matrix3Xd>& edge = parameters_.simulation.tools[tool].blade_edge_tool;
  if (!edge) return;
  Marker blade = named(Marker(), "blades", static_cast<int>(tool));
  blade.type = Marker::LINE_STRIP;
  blade.pose.orientation.w = 1;
  blade.scale.x = 0.004 * body_size_m_;
  blade.color = toColourMsg(kBladeColour);
  for (Eigen::Index i = 0; i < edge->cols(); ++i)
    blade.points.push_back(toPointMsg(T_world_tool * edge->col(i)));
  array.markers.push_back(std::move(blade));
}

void MeshPublisher::addPending(visualization_msgs::MarkerArray& array) const {
  if (!parameters_.node.pending_points) return;
  for (std::size_t tool = 0; tool < tool_parts_.size(); ++tool) {
    const int i = static_cast<int>(tool);
    if (simulation_.numPending(i) == 0) continue;
    Marker marker = named(makePointMarker(simulation_.pendingPoints(i), 0.009 * body_size_m_), "pending", i);
    marker.color = toColourMsg(kPendingColour);
    array.markers.push_back(std::move(marker));
  }
}

void MeshPublisher::addContacts(visualization_msgs::MarkerArray& array,
                                const std::vector<AppliedContact>& contacts) const {
  std::vector<std::size_t> order(contacts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return contacts[a].force_on_tissue_world.squaredNorm() > contacts[b].force_on_tissue_world.squaredNorm();
  });
  order.resize(std::min(order.size(), kMostArrows));
  int id = 0;
  for (const std::size_t i : order) {
    const Eigen::Vector3d arrow = parameters_.node.contact_arrow_m_per_n * contacts[i].force_on_tissue_world;
    if (arrow.norm() < 0.005 * body_size_m_) break;  // the rest is smaller still
    Marker marker = named(Marker(), "contacts", id++);
    marker.type = Marker::ARROW;
    marker.pose.orientation.w = 1;
    // The tip is at the contact: an arrow that starts there would be hidden in the tissue.
    marker.points = {toPointMsg(contacts[i].point_world - arrow), toPointMsg(contacts[i].point_world)};
    marker.scale.x = 0.006 * body_size_m_;
    marker.scale.y = 0.014 * body_size_m_;
    marker.scale.z = 0.018 * body_size_m_;
    marker.color = toColourMsg(kArrowColour);
    array.markers.push_back(std::move(marker));
  }
}

void MeshPublisher::publish(const std::vector<std::optional<Eigen::Isometry3d>>& T_world_tool,
                            const std::vector<AppliedContact>& contacts, const ros::Time& stamp) {
  visualization_msgs::MarkerArray array;
  addTissue(array);
  addPending(array);
  for (std::size_t i = 0; i < T_world_tool.size(); ++i)
    if (T_world_tool[i]) addTool(array, i, *T_world_tool[i]);
  addContacts(array, contacts);

  std::set<std::pair<std::string, int>> now_shown;
  for (const Marker& marker : array.markers) now_shown.emplace(marker.ns, marker.id);
  for (const auto& [name, id] : shown_) {
    if (now_shown.count({name, id}) > 0) continue;
    Marker gone = named(Marker(), name, id);
    gone.action = Marker::DELETE;
    gone.pose.orientation.w = 1;
    array.markers.push_back(gone);
  }
  shown_ = std::move(now_shown);
  for (Marker& marker : array.markers) {
    marker.header.frame_id = parameters_.node.world_frame;
    marker.header.stamp = stamp;
  }
  publisher_.publish(array);
}

}  // namespace polyscalpel
