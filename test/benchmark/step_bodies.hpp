// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies that whole time steps are measured on: no damping, one solve a step and, unless a body says
// otherwise, steps of 1/60 s from rest, Young's modulus 100 kPa, Poisson's ratio 0.45, 1000 kg/m^3, gravity
// along -y.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/simulation/simulation_config.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"

namespace polyscalpel::report {

/// A solver's error is told by the body's largest displacement after so many steps.
constexpr std::array<int, 3> kGateSteps = {5, 10, 60};
/// Largest displacement of a vertex after kGateSteps [m].
using GateAnswers = std::array<double, 3>;

struct StepBody {
  std::string name;
  PolyhedralMesh mesh;
  std::vector<bool> fixed;  ///< one flag a vertex
  IsotropicMaterial material = {1e5, 0.45, 1000};
  Eigen::Vector3d gravity_m_s2 = {0, -9.81, 0};
  bool consistent_mass = true;
  double time_step_s = 1.0 / 60;
  std::optional<Eigen::Matrix3Xd> start;  ///< 3 x n [m]: where it is let go, at rest; none: the rest shape
  /// Moves fixed vertices before each step, which are counted from 1; empty: they stay where they are.
  std::function<void(int step, Eigen::Matrix3Xd& positions)> drive;
  MeshConfig mesh_config;              ///< what a scene makes the same mesh from; not for a body cut before
  std::optional<GateAnswers> answers;  ///< of two other programs, where they are known
};

/// A body to measure on, made when it is first needed.
struct StepSubject {
  std::string name;
  std::function<StepBody()> make;  ///< empty: the body is not there
  std::string missing;             ///< why it is not there
};

/// 0.4 x 0.1 x 0.1 m of 20 n^3 tetrahedra, held at x = 0.
StepBody makeTetBeam(int n);
/// The same of 4 n^3 hexahedra with lumped mass.
StepBody makeHexBeam(int n);
/// Radius 50 mm, 5 (2 half_count)^3 tetrahedra, held below 0.7 of the radius under its middle.
StepBody makeStepBall(int half_count);
/// makeCutBall() held and loaded as that is, with lumped mass.
StepBody makeCutStepBall(int half_count, int num_cuts);

/// The Stanford bunny and a beam whose displacements two other programs agree on, VegaFEM 4 with a direct
/// solver and SOFA's fast corotational tetrahedra: bunny8k.msh and beam10k.msh in the folder, each with a
/// list of its fixed vertices, .fix. folder: may be empty.
std::vector<StepSubject> knownSubjects(const std::string& folder);

IntegrationConfig stepIntegration(const StepBody& body);
ElementConfig stepElement(const StepBody& body);
SimulationState stepStart(const StepBody& body);
/// The same motion as a scene, with cutting. Throws std::invalid_argument for a body with a start or a drive.
SimulationConfig stepScene(const StepBody& body, const SolverConfig& solver);

}  // namespace polyscalpel::report
