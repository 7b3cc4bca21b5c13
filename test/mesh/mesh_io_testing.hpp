// SPDX-License-Identifier: BSD-3-Clause
//
// Mesh files written, read and refused, for the tests of mesh_io.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_io.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {

/// A folder of its own for each test, removed at its end.
class MeshIo : public testing::Test {
 protected:
  MeshIo() {
    std::string pattern = (std::filesystem::temp_directory_path() / "polyscalpel_mesh_io_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    folder_ = pattern;
  }
  ~MeshIo() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  MeshFile read(const std::string& name, const std::string& bytes, double cell_size_m = 0) const {
    MeshFileConfig config;
    config.path = write(name, bytes);
    config.cell_size_m = cell_size_m;
    return readMesh(config);
  }

  /// What readMesh says about the file; fails if it takes it.
  std::string refusal(const std::string& name, const std::string& bytes, double cell_size_m = 0) const {
    try {
      read(name, bytes, cell_size_m);
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos)
          << "names the file: " << error.what();
      return error.what();
    }
    ADD_FAILURE() << name << " was accepted";
    return {};
  }

  std::filesystem::path folder_;
};

inline testing::AssertionResult contains(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "\"" << text << "\" is without \"" << part << "\"";
}

inline std::string joined(const std::vector<std::string>& remarks) {
  std::string all;
  for (const std::string& remark : remarks) all += remark + "\n";
  return all;
}

inline double totalVolume(const PolyhedralMesh& mesh) {
  return volume(mesh, mesh.restPositions());
}

inline void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}

}  // namespace polyscalpel
