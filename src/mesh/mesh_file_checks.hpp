// SPDX-License-Identifier: BSD-3-Clause
//
// Gmsh takes an unknown file for a script and runs it, and reads many truncated files in part without a word.
// These checks come before it, on the bytes of the file.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace polyscalpel {

/// Kinds of mesh files, by the end of their names.
enum class MeshFileType { kMsh, kVtk, kMedit, kStl, kPly, kObj, kOff };

/// What a file says of itself, where it does.
struct DeclaredCounts {
  std::optional<std::size_t> volume_cells;
  std::optional<std::size_t> polygons;
};

/// The type by the ending of the name, upper or lower case. Throws std::invalid_argument for an unknown one.
MeshFileType findMeshFileType(const std::string& path);

/// Reads the file's bytes and checks that it begins as its type must and goes on to its end.
/// Throws std::invalid_argument: missing, not a file, empty, not of its type, truncated.
DeclaredCounts requireCompleteMeshFile(const std::string& path, MeshFileType type);

}  // namespace polyscalpel
