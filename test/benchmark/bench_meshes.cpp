// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/bench_meshes.hpp"

#include <filesystem>

#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/mesh_io.hpp"

namespace polyscalpel::bench {

std::vector<BenchMesh> benchMeshes(const std::string& folder) {
  constexpr double kRadius = 0.05;
  const auto ball = [](int half_count) {
    return [half_count] { return makeTetBall(Eigen::Vector3d::Zero(), kRadius, half_count); };
  };
  std::vector<BenchMesh> meshes = {{"ball9k", ball(6)}, {"ball40k", ball(10)}};
  if (folder.empty()) return meshes;
  for (const std::string name : {"bunny8k", "bunny44k"}) {
    const std::string path = (std::filesystem::path(folder) / (name + ".msh")).string();
    if (!std::filesystem::exists(path)) continue;
    meshes.push_back({name, [path] { return readMesh(MeshFileConfig{path, 1, 0}).mesh; }});
  }
  return meshes;
}

}  // namespace polyscalpel::bench
