// SPDX-License-Identifier: BSD-3-Clause
#include "polygon_file_io.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/Simple_cartesian.h>

namespace polyscalpel {

SurfaceData readPolygonFile(const std::string& path, double scale) {
  // A kernel of plain doubles: no predicate is asked of CGAL here.
  std::vector<CGAL::Simple_cartesian<double>::Point_3> points;
  std::vector<std::vector<std::size_t>> polygons;
  const bool is_off = path.size() >= 4 && (path.back() == 'f' || path.back() == 'F');
  const bool is_read = is_off ? CGAL::IO::read_OFF(path, points, polygons, CGAL::parameters::verbose(false))
                              : CGAL::IO::read_OBJ(path, points, polygons, CGAL::parameters::verbose(false));
  if (!is_read)
    throw std::invalid_argument(std::string("not a complete ") + (is_off ? ".off" : ".obj") + " file");

  SurfaceData surface;
  surface.points.resize(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    surface.points.col(i) = scale * Eigen::Vector3d(points[i].x(), points[i].y(), points[i].z());
  }
  for (const auto& polygon : polygons) {
    for (const std::size_t corner : polygon) {
      if (corner < points.size()) continue;
      throw std::invalid_argument("a polygon has point " + std::to_string(corner) + ", but there are only " +
                                  std::to_string(points.size()));
    }
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      surface.triangles.push_back(
          {static_cast<int>(polygon[0]), static_cast<int>(polygon[i - 1]), static_cast<int>(polygon[i])});
    }
  }
  return surface;
}

}  // namespace polyscalpel
