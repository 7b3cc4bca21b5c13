// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <string>

#include <Eigen/Core>

namespace polyscalpel {

/// A file with a text or a triangle surface, there as long as the object lives.
class ToolFile {
 public:
  ToolFile(const std::string& extension, const std::string& text) : path_(newPath(extension)) {
    std::ofstream(path_) << text;
  }

  /// triangles: 3 x 3k, three columns a triangle. Corners are written once a triangle.
  ToolFile(const std::string& extension, const Eigen::Matrix3Xd& triangles) : path_(newPath(extension)) {
    std::ofstream file(path_);
    file << std::setprecision(17);
    const Eigen::Index points = triangles.cols(), count = points / 3;
    if (extension == ".stl") {
      file << "solid tool\n";
      for (Eigen::Index i = 0; i < points; ++i) {
        if (i % 3 == 0) file << "facet normal 0 0 0\nouter loop\n";
        file << "vertex " << triangles.col(i).transpose() << "\n";
        if (i % 3 == 2) file << "endloop\nendfacet\n";
      }
      file << "endsolid tool\n";
      return;
    }
    if (extension == ".off") file << "OFF\n" << points << " " << count << " 0\n";
    if (extension == ".ply") {
      file << "ply\nformat ascii 1.0\nelement vertex " << points
           << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << count
           << "\nproperty list uchar int vertex_indices\nend_header\n";
    }
    const bool is_obj = extension == ".obj";
    for (Eigen::Index i = 0; i < points; ++i) {
      file << (is_obj ? "v " : "") << triangles.col(i).transpose() << "\n";
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index first = 3 * i + (is_obj ? 1 : 0);
      file << (is_obj ? "f " : "3 ") << first << " " << first + 1 << " " << first + 2 << "\n";
    }
  }

  ~ToolFile() { std::filesystem::remove(path_); }
  ToolFile(const ToolFile&) = delete;
  ToolFile& operator=(const ToolFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  static std::string newPath(const std::string& extension) {
    static int count = 0;
    const std::string name = "polyscalpel_tool_" + std::to_string(getpid()) + "_" + std::to_string(count++);
    return (std::filesystem::temp_directory_path() / (name + extension)).string();
  }

  std::string path_;
};

}  // namespace polyscalpel
