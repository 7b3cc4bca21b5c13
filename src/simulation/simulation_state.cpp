// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/simulation_state.hpp"

#include <stdexcept>
#include <string>

namespace polyscalpel {

namespace {

struct Fixer {
  const PolyhedralMesh& mesh;
  const std::string& name;
  std::vector<bool>& fixed;

  template <class Contains>
  int fixWhere(const Contains& contains) const {
    int count = 0;
    for (int i = 0; i < mesh.numVertices(); ++i) {
      if (!contains(mesh.restPosition(VertexId(i)))) continue;
      fixed[i] = true;
      ++count;
    }
    return count;
  }

  int operator()(const FixedBox& box) const {
    return fixWhere([&](const Eigen::Vector3d& X) {
      return (X.array() >= box.lowest_m.array()).all() && (X.array() <= box.highest_m.array()).all();
    });
  }
  int operator()(const FixedSphere& sphere) const {
    return fixWhere(
        [&](const Eigen::Vector3d& X) { return (X - sphere.centre_m).norm() <= sphere.radius_m; });
  }
  int operator()(const FixedVertices& list) const {
    for (const int vertex : list.vertices) {
      if (vertex < 0 || vertex >= mesh.numVertices()) {
        throw std::invalid_argument(name + ".vertices = " + std::to_string(vertex) + ": must be in [0, " +
                                    std::to_string(mesh.numVertices() - 1) + "]");
      }
      fixed[vertex] = true;
    }
    return static_cast<int>(list.vertices.size());
  }
};

}  // namespace

SimulationState makeRestState(const PolyhedralMesh& mesh, const std::vector<FixedRegion>& fixed) {
  SimulationState state;
  state.positions = mesh.restPositions();
  state.velocities.setZero(3, mesh.numVertices());
  state.fixed.assign(mesh.numVertices(), false);
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    const std::string name = "fixed[" + std::to_string(i) + "]";
    if (std::visit(Fixer{mesh, name, state.fixed}, fixed[i]) == 0) {
      throw std::invalid_argument(name + ": holds no vertex of the mesh; it must hold at least one");
    }
  }
  return state;
}

void applyMeshChange(SimulationState& state, const MeshChange& change) {
  extendByNewVertices(change.new_vertices, state.positions);
  extendByNewVertices(change.new_vertices, state.velocities);
  for (const NewVertex& vertex : change.new_vertices) {
    state.fixed.push_back(state.fixed[vertex.parents[0].index()] && state.fixed[vertex.parents[1].index()]);
  }
  for (const VertexId vertex : change.retired_vertices) {
    state.velocities.col(vertex.index()).setZero();
    state.fixed[vertex.index()] = true;
  }
}

}  // namespace polyscalpel
