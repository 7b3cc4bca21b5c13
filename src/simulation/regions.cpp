// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/regions.hpp"

#include <set>
#include <stdexcept>
#include <variant>
#include <vector>

namespace polyscalpel {

namespace {

std::string pathOf(const SimulationConfig& config, int region) {
  return "regions[" + std::to_string(region) + "] ('" + config.regions[region].name + "')";
}

template <class Words>
std::string join(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text.empty() ? "none" : text;
}

std::vector<std::string> groupNumbers(const PolyhedralMesh& mesh) {
  std::set<int> numbers;
  for (const CellId cell : mesh.cells()) numbers.insert(mesh.cell(cell).region);
  numbers.erase(0);  // cells of no group
  std::vector<std::string> words;
  for (const int number : numbers) words.push_back(std::to_string(number));
  return words;
}

// Whether a cell is in a region. Asked for cells that are alive.
struct CellTest {
  const PolyhedralMesh& mesh;
  const std::map<std::string, int>& region_names;
  CellId cell;

  bool operator()(const RegionBox& box) const {
    const Eigen::Array3d mean = vertexMean().array();
    return (mean >= box.lowest_m.array()).all() && (mean <= box.highest_m.array()).all();
  }
  bool operator()(const RegionSphere& sphere) const {
    return (vertexMean() - sphere.centre_m).norm() <= sphere.radius_m;
  }
  bool operator()(const RegionGroup& group) const {
    return mesh.cell(cell).region == (group.name.empty() ? group.group : region_names.at(group.name));
  }

 private:
  Eigen::Vector3d vertexMean() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const VertexId vertex : mesh.cell(cell).vertices) sum += mesh.restPosition(vertex);
    return sum / static_cast<double>(mesh.cell(cell).vertices.size());
  }
};

void requireKnownGroup(const std::string& path, const RegionConfig& region,
                       const std::map<std::string, int>& region_names) {
  const auto* group = std::get_if<RegionGroup>(&region.cells);
  if (group == nullptr || group->name.empty() || region_names.count(group->name) > 0) return;
  std::vector<std::string> names;
  for (const auto& entry : region_names) names.push_back(entry.first);
  throw std::invalid_argument(path + ".group.name = '" + group->name +
                              "': must be a physical group of the mesh; its names are: " + join(names));
}

// The region of highest order among those that hold the cell. holding: at least one.
int findHighest(const SimulationConfig& config, const std::vector<int>& holding, CellId cell) {
  int highest = holding.front();
  for (std::size_t i = 0; i < holding.size(); ++i) {
    const RegionConfig& region = config.regions[holding[i]];
    for (std::size_t j = 0; j < i; ++j) {
      const RegionConfig& other = config.regions[holding[j]];
      if (region.order && other.order && *region.order != *other.order) continue;
      throw std::invalid_argument(pathOf(config, holding[j]) + " and " + pathOf(config, holding[i]) +
                                  " overlap in cell " + std::to_string(cell.index()) +
                                  ": both must have an order, and not the same");
    }
    if (i > 0 && *region.order > *config.regions[highest].order) highest = holding[i];
  }
  return highest;
}

CellKind makeKind(const SimulationConfig& config, const RegionConfig& region) {
  CellKind kind{region.material, config.element};
  kind.element.formulation = region.formulation.value_or(kind.element.formulation);
  kind.element.quadrature_points = region.quadrature_points.value_or(kind.element.quadrature_points);
  return kind;
}

}  // namespace

CellKinds makeCellKinds(const PolyhedralMesh& mesh, const SimulationConfig& config,
                        const std::map<std::string, int>& region_names) {
  CellKinds kinds;
  kinds.kinds = {{config.material, config.element}};
  if (config.regions.empty()) return kinds;
  const int num_regions = static_cast<int>(config.regions.size());
  for (int i = 0; i < num_regions; ++i) {
    requireKnownGroup("regions[" + std::to_string(i) + "]", config.regions[i], region_names);
    kinds.kinds.push_back(makeKind(config, config.regions[i]));
  }

  kinds.of_cell.assign(mesh.cellCapacity(), 0);
  std::vector<int> num_held(num_regions, 0), num_taken(num_regions, 0);
  for (const CellId cell : mesh.cells()) {
    std::vector<int> holding;
    for (int i = 0; i < num_regions; ++i) {
      if (!std::visit(CellTest{mesh, region_names, cell}, config.regions[i].cells)) continue;
      holding.push_back(i);
      ++num_held[i];
    }
    if (holding.empty()) continue;
    const int region = findHighest(config, holding, cell);
    kinds.of_cell[cell.index()] = region + 1;
    ++num_taken[region];
  }
  for (int i = 0; i < num_regions; ++i) {
    if (num_taken[i] > 0) continue;
    std::string reason = ": all of its cells lie in regions of higher order";
    if (num_held[i] == 0) {
      reason = std::holds_alternative<RegionGroup>(config.regions[i].cells)
                   ? ": holds no cell; the mesh's physical groups are: " + join(groupNumbers(mesh))
                   : ": holds no cell; a cell belongs to it if the mean of its vertices does";
    }
    throw std::invalid_argument(pathOf(config, i) + reason);
  }
  return kinds;
}

}  // namespace polyscalpel
