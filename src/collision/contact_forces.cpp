// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/collision/contact_forces.hpp"

#include <algorithm>
#include <limits>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

void validate(const ContactConfig& config) {
  requirePositive("stiffness_pa_m", config.stiffness_pa_m);
  requireInRange("damping_pa_s_m", config.damping_pa_s_m, 0, std::numeric_limits<double>::max());
  requireInRange("friction_coefficient", config.friction_coefficient, 0, 10);
  requirePositive("friction_speed_m_s", config.friction_speed_m_s);
  requirePositive("margin_m", config.margin_m);
}

LinearisedContact lineariseContact(const Contact& contact, int tool,
                                   const Eigen::Vector3d& velocity_tissue_world,
                                   const Eigen::Vector3d& velocity_tool_world, double time_step_s,
                                   const ContactConfig& config) {
  POLYSCALPEL_ASSERT(time_step_s > 0);
  LinearisedContact result;
  result.tool = tool;
  result.contact = contact;

  const Eigen::Vector3d& n = contact.normal_world;
  const double A = contact.area_m2;
  const double h = time_step_s;
  const double k = config.stiffness_pa_m;
  const double d = config.damping_pa_s_m;
  const Eigen::Vector3d slip_start = velocity_tissue_world - velocity_tool_world;
  const double gap_end = contact.gap_m + h * n.dot(velocity_tissue_world);
  const double normal_force = A * (-k * gap_end - d * n.dot(slip_start));
  if (!(gap_end < 0) || !(normal_force > 0)) return result;

  const Eigen::Matrix3d normal_part = n * n.transpose();
  const Eigen::Matrix3d tangential_part = Eigen::Matrix3d::Identity() - normal_part;
  const double slip_speed = std::max((tangential_part * slip_start).norm(), config.friction_speed_m_s);
  const double c = config.friction_coefficient * normal_force / slip_speed;
  result.force_0 = A * (d * n.dot(velocity_tool_world) - k * contact.gap_m) * n +
                   c * (tangential_part * velocity_tool_world);
  result.B = A * (k * h + d) * normal_part + c * tangential_part;
  return result;
}

Eigen::Vector3d contactForce(const LinearisedContact& contact, const Eigen::Vector3d& velocity_tissue_world) {
  return contact.force_0 - contact.B * velocity_tissue_world;
}

void addReaction(Wrench& wrench, const Eigen::Vector3d& force_on_tissue_world,
                 const Eigen::Vector3d& point_world, const Eigen::Isometry3d& T_world_tool) {
  const Eigen::Vector3d force_on_tool = T_world_tool.linear().transpose() * -force_on_tissue_world;
  const Eigen::Vector3d arm_tool =
      T_world_tool.linear().transpose() * (point_world - T_world_tool.translation());
  wrench.force += force_on_tool;
  wrench.torque += arm_tool.cross(force_on_tool);
}

}  // namespace polyscalpel
