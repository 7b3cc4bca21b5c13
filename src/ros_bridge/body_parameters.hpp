// SPDX-License-Identifier: BSD-3-Clause
//
// The part of a scene that tells what the body is made of and where it is held.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "polyscalpel/ros_bridge/yaml_reader.hpp"
#include "polyscalpel/simulation/simulation_config.hpp"

namespace polyscalpel {

/// The words of a scene for the values of an enumeration.
template <class Value>
using Words = std::vector<std::pair<std::string, Value>>;

/// Reads a field that is one of several words. value: holds the default, which is one of the words' values.
template <class Value>
void readWord(YamlMap& map, const std::string& key, Value& value, const Words<Value>& words) {
  std::vector<std::string> list;
  std::string word;
  for (const auto& [candidate, meaning] : words) {
    list.push_back(candidate);
    if (meaning == value) word = candidate;
  }
  map.choice(key, word, list);
  for (const auto& [candidate, meaning] : words)
    if (candidate == word) value = meaning;
}

/// The same without a default: value stays as it is where the field is absent.
template <class Value>
void readOptionalWord(YamlMap& map, const std::string& key, std::optional<Value>& value,
                      const Words<Value>& words) {
  std::vector<std::string> list;
  for (const auto& entry : words) list.push_back(entry.first);
  std::optional<std::string> word;
  map.optionalChoice(key, word, list);
  for (const auto& [candidate, meaning] : words)
    if (word == candidate) value = meaning;
}

/// Path of a mesh file named in the scene, as an existing file. folders: where a relative one is looked for.
std::string findMeshFile(YamlMap& map, const std::string& key, const std::vector<std::string>& folders);

/// Each reads one section or list item and refuses what it does not know, as YamlMap does.
MeshConfig readMeshConfig(YamlMap map, const std::vector<std::string>& folders);
void readMaterial(YamlMap map, IsotropicMaterial& material);
void readElement(YamlMap map, ElementConfig& config);
FixedRegion readFixedRegion(YamlMap map);

/// The list `regions`. simulation: its mesh, material and element have been read; what the material of a
/// region leaves out is as in the scene's.
std::vector<RegionConfig> readRegions(YamlMap& scene, const SimulationConfig& simulation);

}  // namespace polyscalpel
