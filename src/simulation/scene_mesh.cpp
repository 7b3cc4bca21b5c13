// SPDX-License-Identifier: BSD-3-Clause
#include "scene_mesh.hpp"

#include <stdexcept>
#include <string>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {

namespace {

struct MeshMaker {
  MeshFile operator()(const BoxMeshConfig& box) const {
    return {box.tetrahedra ? makeTetBox(box.lowest_m, box.size_m, box.counts)
                           : makeHexBox(box.lowest_m, box.size_m, box.counts),
            {},
            {}};
  }
  MeshFile operator()(const BallMeshConfig& ball) const {
    return {makeTetBall(ball.centre_m, ball.radius_m, ball.half_count), {}, {}};
  }
  MeshFile operator()(const MeshFileConfig& file) const { return readMesh(file); }
};

}  // namespace

MeshFile makeSceneMesh(const MeshConfig& config) {
  MeshFile file = std::visit(MeshMaker{}, config);
  const std::vector<std::string> violations = checkMesh(file.mesh);
  if (!violations.empty()) {
    throw std::invalid_argument("mesh: is not sound in " + std::to_string(violations.size()) +
                                (violations.size() == 1 ? " place: " : " places, the first: ") +
                                violations.front());
  }
  return file;
}

}  // namespace polyscalpel
