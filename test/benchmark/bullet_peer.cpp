// SPDX-License-Identifier: BSD-3-Clause
//
// The same tetrahedra, material, gravity, clamped end and step by us and by Bullet, in turns.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "benchmark/report.hpp"
#include "benchmark/timing.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/mesh_io.hpp"
#include "polyscalpel/simulation/equilibrium.hpp"
#include "polyscalpel/simulation/time_integration.hpp"
#ifdef POLYSCALPEL_HAS_BULLET
#include "benchmark/bullet_body.hpp"
#endif

namespace polyscalpel::report {
namespace {

/// Times are compared over stretches of this length, in turns.
constexpr double kStretch_s = 1.0 / 60;
/// Our ways to solve that run beside Bullet.
constexpr SolverKind kOurs[] = {SolverKind::kDirect, SolverKind::kAuto};

struct Body {
  std::string name;
  PolyhedralMesh mesh;
  std::vector<bool> fixed;
  IsotropicMaterial material;
  Eigen::Vector3d gravity_m_s2;
  double time_step_s = kStretch_s;
};

/// A simulator of a body with its settings.
struct Contestant {
  std::string peer, settings;
  double time_step_s = 0;
  std::function<void()> step;
  std::function<Eigen::Matrix3Xd()> positions;
  std::vector<double> stretch_times_s = {};
  double squared_error = 0;  // over all stretches so far
};

IntegrationConfig undamped(const Body& body, double time_step_s) {
  IntegrationConfig config;
  config.time_step_s = time_step_s;
  config.mass_damping_per_s = 0;
  config.stiffness_damping_s = 0;
  config.gravity_m_s2 = body.gravity_m_s2;
  return config;
}

SimulationState atRest(const Body& body) {
  return {body.mesh.restPositions(), Eigen::Matrix3Xd::Zero(3, body.mesh.numVertices()), body.fixed, {}};
}

Contestant makeOurs(const Body& body, double time_step_s, SolverKind kind) {
  struct Ours {
    Assembly assembly;
    ImplicitEuler integrator;
    SimulationState state;
  };
  SolverConfig solver;
  solver.kind = kind;
  const auto ours =
      std::make_shared<Ours>(Ours{Assembly(body.mesh, body.material, ElementConfig(), 0),
                                  ImplicitEuler(undamped(body, time_step_s), solver), atRest(body)});
  return {"polyscalpel",
          kind == SolverKind::kDirect ? "direct: CHOLMOD in every step" : "auto, tolerance 1e-4", time_step_s,
          [ours] {
            const IntegrationResult result = ours->integrator.step(ours->state, ours->assembly, {});
            if (result.status != SolveStatus::kSolved) throw std::runtime_error(toString(result.status));
          },
          [ours] { return ours->state.positions; }};
}

#ifdef POLYSCALPEL_HAS_BULLET
Tetrahedra tetrahedraOf(const PolyhedralMesh& mesh) {
  return retessellate(mesh, Retessellation::kFewest);
}

Contestant makeBullet(const Body& body, double time_step_s, const BulletSettings& settings) {
  const Assembly assembly(body.mesh, body.material, ElementConfig(), 0);
  const auto bullet = std::make_shared<BulletBody>(tetrahedraOf(body.mesh), assembly.vertexMasses(),
                                                   body.fixed, body.material, body.gravity_m_s2, settings);
  char text[160];
  std::snprintf(text, sizeof text, "%d Newton iteration%s a step, at most %d of CG to %.0e",
                settings.newton_iterations, settings.newton_iterations == 1 ? "" : "s",
                settings.cg_iterations, settings.cg_tolerance);
  return {BulletBody::version(), text, time_step_s, [bullet, time_step_s] { bullet->step(time_step_s); },
          [bullet] { return bullet->positions(); }};
}
#endif

void simulate(Contestant& contestant, double duration_s) {
  const long steps = std::lround(duration_s / contestant.time_step_s);
  for (long i = 0; i < steps; ++i) contestant.step();
}

/// Positions at the end of each stretch, to second order in the step: by us, whose error at one step is twice
/// that at half.
std::vector<Eigen::Matrix3Xd> referenceMotion(const Body& body, long stretches, double finest_s) {
  Contestant coarse = makeOurs(body, finest_s, SolverKind::kDirect);
  Contestant fine = makeOurs(body, finest_s / 2, SolverKind::kDirect);
  std::vector<Eigen::Matrix3Xd> motion;
  for (long i = 0; i < stretches; ++i) {
    simulate(coarse, kStretch_s);
    simulate(fine, kStretch_s);
    motion.push_back(2 * fine.positions() - coarse.positions());
  }
  return motion;
}

double relativeError(const Body& body, const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& reference) {
  return (positions - reference).norm() / (reference - body.mesh.restPositions()).norm();
}

Row describe(const Body& body, const Contestant& contestant) {
  Row row;
  row["peer"] = contestant.peer;
  row["settings"] = contestant.settings;
  row["body"] = body.name;
  row["cells"] = body.mesh.numCells();
  row["unknowns"] = 3 * static_cast<int>(std::count(body.fixed.begin(), body.fixed.end(), false));
  row["time_step_s"] = contestant.time_step_s;
  return row;
}

/// Motion for duration_s: time, and error over all of it, stretch by stretch in turns.
Rows race(const Body& body, std::vector<Contestant> contestants, double duration_s, double finest_s) {
  const long stretches = std::lround(duration_s / kStretch_s);
  const std::vector<Eigen::Matrix3Xd> reference = referenceMotion(body, stretches, finest_s);
  double squared_motion = 0;
  for (const Eigen::Matrix3Xd& positions : reference) {
    squared_motion += (positions - body.mesh.restPositions()).squaredNorm();
    for (Contestant& contestant : contestants) {
      contestant.stretch_times_s.push_back(secondsOf([&] { simulate(contestant, kStretch_s); }));
      contestant.squared_error += (contestant.positions() - positions).squaredNorm();
    }
  }
  Rows rows;
  for (const Contestant& contestant : contestants) {
    Row row = describe(body, contestant);
    row["duration_s"] = duration_s;
    row["motion_error"] = std::sqrt(contestant.squared_error / squared_motion);
    const double stretch_s = median(contestant.stretch_times_s);
    row["step_ms"] = 1e3 * stretch_s * contestant.time_step_s / kStretch_s;
    row["wall_ms_per_simulated_s"] = 1e3 * stretch_s / kStretch_s;
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Sag once the motion has died away, which the damping of implicit Euler does, against the exact minimum of
/// the same energy.
void addSags(const Body& body, std::vector<Contestant> contestants, double duration_s, Rows& rows) {
  Assembly assembly(body.mesh, body.material, ElementConfig(), 0);
  IntegrationConfig config;
  config.equilibrium_tolerance = 1e-10;
  Eigen::Matrix3Xd equilibrium = body.mesh.restPositions();
  const Eigen::Matrix3Xd weights = body.gravity_m_s2 * assembly.vertexMasses().transpose();
  const EquilibriumResult found =
      findEquilibrium(body.mesh, assembly, body.fixed, weights, {}, config, equilibrium);
  for (Contestant& contestant : contestants) {
    Row row = describe(body, contestant);
    row["duration_s"] = duration_s;
    const double wall_s = secondsOf([&] { simulate(contestant, duration_s); });
    row["sag_error"] = relativeError(body, contestant.positions(), equilibrium);
    row["wall_ms_to_sag"] = 1e3 * wall_s;
    if (!found.converged) holdFailed(row, "equilibrium: " + found.message);
    if (contestant.peer == "polyscalpel") holdAtMost(row, "sag_error", 1e-3);
    rows.push_back(std::move(row));
  }
}

Body makeBeam(int n) {
  Body body;
  body.mesh = makeTetBox(Eigen::Vector3d::Zero(), {0.4, 0.1, 0.1}, {4 * n, n, n});
  body.name = "beam of " + std::to_string(body.mesh.numCells()) + " tetrahedra";
  body.fixed = makeRestState(body.mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}}).fixed;
  body.material = {1e5, 0.45, 1000};
  body.gravity_m_s2 = {0, -9.81, 0};
  return body;
}

Body makeBunny(const std::string& path) {
  Body body;
  body.name = "bunny";
  body.mesh = readMesh(MeshFileConfig{path, 1, 0}).mesh;
  const double lowest = body.mesh.restPositions().row(2).minCoeff();
  const double highest = body.mesh.restPositions().row(2).maxCoeff();
  for (int i = 0; i < body.mesh.numVertices(); ++i)
    body.fixed.push_back(body.mesh.restPosition(VertexId(i)).z() < lowest + 0.1 * (highest - lowest));
  body.material = {3e3, 0.45, 1000};
  body.gravity_m_s2 = {9.81, 0, 0};
  body.time_step_s = kStretch_s / 2;  // stiffer in bending than the beams, so it swings faster
  return body;
}

void append(Rows& rows, const Rows& more) {
  rows.insert(rows.end(), more.begin(), more.end());
}

}  // namespace

Rows studyPeers(const Context& context) {
  Progress& progress = *context.progress;
  progress.beginSection("peers", 4);
  Rows rows;
  const Body small = makeBeam(context.byMode(2, 4, 4));
  const std::vector<double> steps_s =
      context.byMode<std::vector<double>>({1.0 / 60, 1.0 / 240}, {1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480},
                                          {1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480, 1.0 / 960});
  std::vector<Contestant> contestants;
  for (const SolverKind kind : kOurs)
    for (const double h : steps_s) contestants.push_back(makeOurs(small, h, kind));
#ifdef POLYSCALPEL_HAS_BULLET
  for (const double tolerance : {1e-6, 1e-3, 1e-1})
    for (const double h : steps_s) contestants.push_back(makeBullet(small, h, {1, 300, tolerance}));
  contestants.push_back(makeBullet(small, steps_s[0], {1, 300, 1e-9}));
  contestants.push_back(makeBullet(small, steps_s[0], {1, 20, 1e-6}));
  contestants.push_back(makeBullet(small, steps_s[0], {4, 300, 1e-6}));
#endif
  progress.beginTask(small.name);
  append(rows, race(small, std::move(contestants), 0.5, context.byMode(1.0 / 960, 1.0 / 1920, 1.0 / 3840)));

  progress.beginTask(small.name + ", sag");
  contestants.clear();
  // Long steps and a long time, so that nothing of the swing is left.
  constexpr double kSagStep_s = 2 * kStretch_s, kSagDuration_s = 20;
  for (const SolverKind kind : kOurs) contestants.push_back(makeOurs(small, kSagStep_s, kind));
#ifdef POLYSCALPEL_HAS_BULLET
  contestants.push_back(makeBullet(small, kSagStep_s, {1, 300, 1e-6}));
#endif
  addSags(small, std::move(contestants), kSagDuration_s, rows);

  std::vector<Body> large;
  if (context.mode != Mode::kQuick) large.push_back(makeBeam(8));
  if (context.mode != Mode::kQuick && !context.bunny_mesh.empty())
    large.push_back(makeBunny(context.bunny_mesh));
  for (const Body& body : large) {
    progress.beginTask(body.name);
    contestants.clear();
    for (const SolverKind kind : kOurs) contestants.push_back(makeOurs(body, body.time_step_s, kind));
#ifdef POLYSCALPEL_HAS_BULLET
    contestants.push_back(makeBullet(body, body.time_step_s, {1, 300, 1e-6}));
    contestants.push_back(makeBullet(body, body.time_step_s, {1, 300, 1e-3}));
#endif
    append(rows, race(body, std::move(contestants), 0.2, context.byMode(1.0 / 480, 1.0 / 480, 1.0 / 960)));
  }
#ifndef POLYSCALPEL_HAS_BULLET
  Row row;
  row["peer"] = "Bullet";
  row["settings"] = "not measured: its headers and libraries were not there when the report was built";
  rows.push_back(row);
#endif
  return rows;
}

}  // namespace polyscalpel::report
