// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/resource_path.hpp"

#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include <ros/package.h>

namespace polyscalpel {
namespace {

const std::string kPackageScheme = "package://";

/// Where package://<package>/<rest> may lie.
std::vector<std::string> packageCandidates(const std::string& uri) {
  const std::string path = uri.substr(kPackageScheme.size());
  const std::size_t slash = path.find('/');
  if (slash == 0 || slash == std::string::npos || slash + 1 == path.size())
    throw std::invalid_argument(uri + ": must be package://<package>/<path in it>");
  const std::string package = path.substr(0, slash);
  const std::string rest = path.substr(slash + 1);
  std::vector<std::string> candidates;
  const std::string folder = ros::package::getPath(package);
  if (!folder.empty()) candidates.push_back(folder + "/" + rest);
  const char* prefixes = std::getenv("CMAKE_PREFIX_PATH");
  for (const std::string& prefix : splitSearchPath(prefixes == nullptr ? "" : prefixes))
    candidates.push_back(prefix + "/share/" + package + "/" + rest);
  return candidates;
}

}  // namespace

std::vector<std::string> splitSearchPath(const std::string& list) {
  std::vector<std::string> parts;
  std::istringstream stream(list);
  for (std::string part; std::getline(stream, part, ':');)
    if (!part.empty()) parts.push_back(part);
  return parts;
}

std::string findResource(const std::string& path, const std::vector<std::string>& folders) {
  std::vector<std::string> candidates;
  if (path.compare(0, kPackageScheme.size(), kPackageScheme) == 0) {
    candidates = packageCandidates(path);
  } else if (!path.empty() && path.front() == '/') {
    candidates = {path};
  } else {
    for (const std::string& folder : folders)
      candidates.push_back(folder.empty() ? path : folder + "/" + path);
    for (const std::string& candidate : packageCandidates(kPackageScheme + "polyscalpel/meshes/" + path))
      candidates.push_back(candidate);
  }
  std::string tried;
  for (const std::string& candidate : candidates) {
    if (std::filesystem::is_regular_file(candidate)) return candidate;
    tried += (tried.empty() ? "" : ", ") + candidate;
  }
  throw std::invalid_argument("file \"" + path + "\" not found; tried " +
                              (tried.empty() ? "nothing" : tried));
}

}  // namespace polyscalpel
