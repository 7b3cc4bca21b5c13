// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/collision/contact_detection.hpp"

namespace polyscalpel {

/// Penalty contact with damping and regularised Coulomb friction, all per surface area so that a finer mesh
/// feels the same.
struct ContactConfig {
  double stiffness_pa_m = 5e6;        ///< pressure per depth of overlap, > 0
  double damping_pa_s_m = 1e3;        ///< pressure per approach speed, >= 0
  double friction_coefficient = 0.1;  ///< Coulomb, in [0, 10]
  double friction_speed_m_s = 1e-3;   ///< slip speed below which friction is viscous, > 0
  double margin_m = 1e-3;             ///< contacts are looked for up to this gap, > 0
};

/// Throws std::invalid_argument with name, value and range.
void validate(const ContactConfig& config);

/// A contact's force on the tissue as a function of its point's velocity v at the end of the step: force_0 -
/// B v, B symmetric positive semi-definite. Enters the step's matrix as h w_i w_j B.
struct LinearisedContact {
  int tool = 0;
  Contact contact;
  Eigen::Vector3d force_0 = Eigen::Vector3d::Zero();  ///< [N]
  Eigen::Matrix3d B = Eigen::Matrix3d::Zero();        ///< [N s/m]
};

/// Implicit penalty, damping and friction of one contact over a step of h seconds. velocity_tissue_world: of
/// the contact point at the start of the step; velocity_tool_world: of the tool's material point there over
/// the step [m/s].
///
/// The contact's gap lies between the tissue at the start of the step and the tool at its end: the tool's
/// motion is in the gap already, so only the tissue's motion h n.v opens it further, while damping acts on
/// the relative velocity. With v the velocity of the tissue's point at the end of the step, n the normal, A
/// the area, k and d stiffness and damping:
///   normal force      f_n = A (-k (gap + h n.v) - d n.(v - v_tool))
///   friction          f_t = -c (1 - n n^T)(v - v_tool),  c = mu f_n* / max(|v_t*|, friction_speed)
/// where * is the value at the start velocity, so |f_t| <= mu f_n* as long as the slip does not grow in the
/// step. Nothing (force_0 = B = 0) when at the start velocity the gap would be open at the end of the step or
/// f_n* <= 0.
LinearisedContact lineariseContact(const Contact& contact, int tool,
                                   const Eigen::Vector3d& velocity_tissue_world,
                                   const Eigen::Vector3d& velocity_tool_world, double time_step_s,
                                   const ContactConfig& config);

/// Force on the tissue for the solved velocity of its contact point [N].
Eigen::Vector3d contactForce(const LinearisedContact& contact, const Eigen::Vector3d& velocity_tissue_world);

/// Force and torque about a frame's origin, in that frame [N], [N m].
struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
};

/// Adds to `wrench` (in the tool's frame, at its origin) the reaction to a force on the tissue at a point.
void addReaction(Wrench& wrench, const Eigen::Vector3d& force_on_tissue_world,
                 const Eigen::Vector3d& point_world, const Eigen::Isometry3d& T_world_tool);

}  // namespace polyscalpel
