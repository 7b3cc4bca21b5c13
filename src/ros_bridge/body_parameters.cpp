// SPDX-License-Identifier: BSD-3-Clause
#include "body_parameters.hpp"

#include <set>
#include <stdexcept>
#include <variant>

#include "polyscalpel/ros_bridge/resource_path.hpp"

namespace polyscalpel {
namespace {

constexpr double kLargestInt = 2147483647;
const Range kCount{0, kLargestInt};
const Words<Formulation> kFormulations = {{"mean_value", Formulation::kMeanValue},
                                          {"virtual", Formulation::kVirtual}};
const Words<int> kQuadratures = {{"1", 1}, {"4", 4}, {"11", 11}};
constexpr const char* kRegionName = "text that no other region has";
constexpr const char* kGroupName = "the name of a physical group of the mesh file";

template <class Box>
Box readBox(YamlMap map) {
  Box box;
  map.require("lowest_m");
  map.require("highest_m");
  map.numbers("lowest_m", box.lowest_m, kAnyNumber);
  map.numbers("highest_m", box.highest_m, kAnyNumber);
  if (!(box.lowest_m.array() <= box.highest_m.array()).all())
    map.refuse("highest_m", "no component may be below that of lowest_m");
  map.finish();
  return box;
}

template <class Sphere>
Sphere readSphere(YamlMap map) {
  Sphere sphere;
  map.require("radius_m");
  map.numbers("centre_m", sphere.centre_m, kAnyNumber);
  map.number("radius_m", sphere.radius_m, kPositive);
  map.finish();
  return sphere;
}

RegionGroup readGroup(YamlMap map, const SimulationConfig& simulation) {
  if (!std::holds_alternative<MeshFileConfig>(simulation.mesh))
    map.refuse("", "only a mesh file has physical groups");
  RegionGroup group;
  if (map.oneOf({"number", "name"}) == "number") {
    map.integer("number", group.group, {1, kLargestInt});
  } else {
    map.text("name", group.name, kGroupName);
    if (group.name.empty()) map.refuse("name", std::string("must be ") + kGroupName);
  }
  map.finish();
  return group;
}

RegionConfig readRegion(YamlMap& map, const SimulationConfig& simulation) {
  RegionConfig region;
  map.require("name");
  map.text("name", region.name, kRegionName);
  if (region.name.empty()) map.refuse("name", std::string("must be ") + kRegionName);
  const std::string kind = map.oneOf({"box", "sphere", "group"});
  if (kind == "group") {
    region.cells = readGroup(map.map(kind), simulation);
  } else if (kind == "sphere") {
    region.cells = readSphere<RegionSphere>(map.map(kind));
  } else {
    region.cells = readBox<RegionBox>(map.map(kind));
  }
  region.material = simulation.material;
  readMaterial(map.map("material"), region.material);
  readOptionalWord(map, "formulation", region.formulation, kFormulations);
  readOptionalWord(map, "quadrature_points", region.quadrature_points, kQuadratures);
  if (region.quadrature_points &&
      region.formulation.value_or(simulation.element.formulation) == Formulation::kVirtual)
    map.refuse("quadrature_points", "a virtual element has none");
  map.optionalInteger("order", region.order, {-kLargestInt, kLargestInt});
  map.finish();
  return region;
}

}  // namespace

std::string findMeshFile(YamlMap& map, const std::string& key, const std::vector<std::string>& folders) {
  map.require(key);
  std::string path;
  map.text(key, path, "the path of a mesh file");
  try {
    return findResource(path, folders);
  } catch (const std::invalid_argument& exception) {
    map.refuse(key, std::string("must be an existing file: ") + exception.what());
  }
}

MeshConfig readMeshConfig(YamlMap mesh, const std::vector<std::string>& folders) {
  const std::string kind = mesh.oneOf({"box", "ball", "file"});
  mesh.finish();
  YamlMap map = mesh.map(kind);
  if (kind == "box") {
    BoxMeshConfig config;
    map.numbers("lowest_m", config.lowest_m, kAnyNumber);
    map.numbers("size_m", config.size_m, kPositive);
    map.integers("counts", config.counts, {1, 200});
    map.boolean("tetrahedra", config.tetrahedra);
    map.finish();
    return config;
  }
  if (kind == "ball") {
    BallMeshConfig config;
    map.numbers("centre_m", config.centre_m, kAnyNumber);
    map.number("radius_m", config.radius_m, kPositive);
    map.integer("half_count", config.half_count, {1, 40});
    map.finish();
    return config;
  }
  MeshFileConfig config;
  config.path = findMeshFile(map, "path", folders);
  map.number("scale", config.scale, kPositive);
  map.number("cell_size_m", config.cell_size_m, kNotNegative);
  map.finish();
  return config;
}

void readMaterial(YamlMap map, IsotropicMaterial& material) {
  map.number("youngs_modulus_pa", material.youngs_modulus_pa, kPositive);
  map.number("poisson_ratio", material.poisson_ratio, {-1, 0.5, true, true});
  map.number("density_kg_m3", material.density_kg_m3, kPositive);
  map.number("strength_pa", material.strength_pa, kNotNegative);
  map.number("fracture_toughness_j_m2", material.fracture_toughness_j_m2, {0, 1e5});
  map.finish();
}

void readElement(YamlMap map, ElementConfig& config) {
  readWord(map, "formulation", config.formulation, kFormulations);
  readWord(map, "quadrature_points", config.quadrature_points, kQuadratures);
  readWord(map, "stabilisation_modulus", config.stabilisation_modulus,
           {{"automatic", StabilisationModulus::kAutomatic},
            {"full", StabilisationModulus::kFull},
            {"shear", StabilisationModulus::kShear}});
  map.number("stabilisation_scale", config.stabilisation_scale, kPositive);
  map.boolean("consistent_mass", config.consistent_mass);
  readWord(map, "strain", config.strain,
           {{"corotated", Strain::kCorotated}, {"linear", Strain::kLinear}, {"green", Strain::kGreen}});
  map.boolean("exact_force", config.exact_force);
  map.finish();
}

FixedRegion readFixedRegion(YamlMap fixed) {
  const std::string kind = fixed.oneOf({"box", "sphere", "vertices"});
  if (kind == "vertices") {
    FixedVertices region;
    fixed.integerList("vertices", region.vertices, kCount);
    fixed.finish();
    return region;
  }
  fixed.finish();
  if (kind == "sphere") return readSphere<FixedSphere>(fixed.map(kind));
  return readBox<FixedBox>(fixed.map(kind));
}

std::vector<RegionConfig> readRegions(YamlMap& scene, const SimulationConfig& simulation) {
  std::vector<RegionConfig> regions;
  std::set<std::string> names;
  for (YamlMap& map : scene.maps("regions")) {
    regions.push_back(readRegion(map, simulation));
    if (!names.insert(regions.back().name).second)
      map.refuse("name", "must differ from every other region's");
  }
  return regions;
}

}  // namespace polyscalpel
