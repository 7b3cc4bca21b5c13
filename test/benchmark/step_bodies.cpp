// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/step_bodies.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "benchmark/cut_bodies.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel::report {
namespace {

StepBody makeBeam(int n, bool tetrahedra) {
  BoxMeshConfig box;
  box.size_m = {0.4, 0.1, 0.1};
  box.counts = {4 * n, n, n};
  box.tetrahedra = tetrahedra;
  StepBody body;
  body.mesh = tetrahedra ? makeTetBox(box.lowest_m, box.size_m, box.counts)
                         : makeHexBox(box.lowest_m, box.size_m, box.counts);
  body.name = (tetrahedra ? "beam of " : "hexahedra, beam of ") + std::to_string(body.mesh.numCells());
  body.fixed = makeRestState(body.mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}}).fixed;
  body.consistent_mass = tetrahedra;
  body.mesh_config = box;
  return body;
}

StepBody readKnown(const std::string& name, const std::filesystem::path& path, const GateAnswers& answers) {
  StepBody body;
  body.name = name;
  const MeshFileConfig file{path.string() + ".msh", 1, 0};
  body.mesh = readMesh(file).mesh;
  body.fixed.assign(body.mesh.numVertices(), false);
  std::ifstream list(path.string() + ".fix");
  for (int vertex = 0; list >> vertex;) body.fixed.at(vertex) = true;
  if (!list.eof()) throw std::invalid_argument(path.string() + ".fix: must hold numbers of vertices alone");
  body.mesh_config = file;
  body.answers = answers;
  return body;
}

}  // namespace

StepBody makeTetBeam(int n) {
  return makeBeam(n, true);
}

StepBody makeHexBeam(int n) {
  return makeBeam(n, false);
}

StepBody makeStepBall(int half_count) {
  BallMeshConfig ball;
  ball.half_count = half_count;
  StepBody body;
  body.mesh = makeTetBall(ball.centre_m, ball.radius_m, ball.half_count);
  body.name = "ball of " + std::to_string(body.mesh.numCells());
  for (int i = 0; i < body.mesh.numVertices(); ++i)
    body.fixed.push_back(body.mesh.restPosition(VertexId(i)).y() < -0.7 * ball.radius_m);
  body.mesh_config = ball;
  return body;
}

StepBody makeCutStepBall(int half_count, int num_cuts) {
  CutBody cut = makeCutBall(half_count, num_cuts);
  StepBody body;
  body.name = "cut ball of " + std::to_string(cut.mesh.numCells());
  body.mesh = std::move(cut.mesh);
  body.fixed = std::move(cut.fixed);
  body.gravity_m_s2 = cut.gravity_m_s2;
  body.consistent_mass = false;
  return body;
}

std::vector<StepSubject> knownSubjects(const std::string& folder) {
  const std::vector<std::pair<std::string, GateAnswers>> known = {
      {"bunny8k", {2.485235e-3, 2.429002e-3, 2.411976e-3}},
      {"beam10k", {4.915587e-2, 1.898572e-1, 2.204128e-1}}};
  std::vector<StepSubject> subjects;
  for (const auto& [name, answers] : known) {
    const std::filesystem::path path = std::filesystem::path(folder) / name;
    StepSubject subject{name, {}, {}};
    if (folder.empty() || !std::filesystem::exists(path.string() + ".msh") ||
        !std::filesystem::exists(path.string() + ".fix")) {
      subject.missing = name + ".msh and " + name + ".fix are in no folder that was given";
    } else {
      subject.make = [name = name, path, answers = answers] { return readKnown(name, path, answers); };
    }
    subjects.push_back(std::move(subject));
  }
  return subjects;
}

IntegrationConfig stepIntegration(const StepBody& body) {
  IntegrationConfig config;
  config.time_step_s = body.time_step_s;
  config.mass_damping_per_s = 0;
  config.stiffness_damping_s = 0;
  config.gravity_m_s2 = body.gravity_m_s2;
  return config;
}

ElementConfig stepElement(const StepBody& body) {
  ElementConfig config;
  config.consistent_mass = body.consistent_mass;
  return config;
}

SimulationState stepStart(const StepBody& body) {
  SimulationState state;
  state.positions = body.start ? *body.start : body.mesh.restPositions();
  state.velocities.setZero(3, body.mesh.numVertices());
  state.fixed = body.fixed;
  return state;
}

SimulationConfig stepScene(const StepBody& body, const SolverConfig& solver) {
  if (body.start || body.drive)
    throw std::invalid_argument(body.name + ": no scene lets a body go deformed, or moves what holds it");
  SimulationConfig config;
  config.mesh = body.mesh_config;
  config.material = body.material;
  config.element = stepElement(body);
  FixedVertices held;
  for (int i = 0; i < body.mesh.numVertices(); ++i)
    if (body.fixed[i]) held.vertices.push_back(i);
  config.fixed = {held};
  config.integration = stepIntegration(body);
  config.solver = solver;
  config.cutting = CuttingConfig();
  return config;
}

}  // namespace polyscalpel::report
