// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/machine.hpp"

#include <fstream>
#include <thread>

namespace polyscalpel::report {
namespace {

/// What follows the key and its separator in the first line that starts with the key; "unknown" without one.
std::string readValue(const std::string& path, const std::string& key, char separator) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, key.size(), key) != 0) continue;
    const std::size_t colon = line.find(separator);
    if (colon == std::string::npos) continue;
    const std::size_t first = line.find_first_not_of(" \t\"", colon + 1);
    if (first == std::string::npos) continue;
    return line.substr(first, line.find_last_not_of(" \t\"") - first + 1);
  }
  return "unknown";
}

}  // namespace

Row describeMachine() {
  Row machine;
  machine["cpu"] = readValue("/proc/cpuinfo", "model name", ':');
  machine["cores"] = static_cast<int>(std::thread::hardware_concurrency());
  machine["memory"] = readValue("/proc/meminfo", "MemTotal", ':');
  machine["os"] = readValue("/etc/os-release", "PRETTY_NAME", '=');
  machine["compiler"] = std::string("g++ ") + __VERSION__;
  machine["flags"] = POLYSCALPEL_REPORT_FLAGS;
  return machine;
}

}  // namespace polyscalpel::report
