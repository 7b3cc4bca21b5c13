// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace polyscalpel {

/// The file that a path in a scene or a parameter means:
/// - an absolute path as it is;
/// - package://<package>/<rest>: below the package's folder, then below share/<package> of each folder in the
/// environment
///   variable CMAKE_PREFIX_PATH (where files made by the build lie in a devel space);
/// - a relative path below each of `folders` in order, then below package://polyscalpel/meshes.
/// Throws std::invalid_argument, naming every place that was tried, when there is no such file.
std::string findResource(const std::string& path, const std::vector<std::string>& folders);

/// The parts of a list separated by colons, empty ones left out.
std::vector<std::string> splitSearchPath(const std::string& list);

}  // namespace polyscalpel
