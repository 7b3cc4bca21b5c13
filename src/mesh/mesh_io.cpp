// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/mesh_io.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

#include "gmsh_io.hpp"
#include "mesh_file_checks.hpp"
#include "polygon_file_io.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "surface_fill.hpp"

namespace polyscalpel {
namespace {

/// Two vertices nearer than this times the diagonal of the body's box are the same vertex twice.
constexpr double kSmallestRelativeDistance = 1e-9;

template <class... Parts>
std::string makeText(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  throw std::invalid_argument(makeText(parts...));
}

/// Volume and shortest edge of a cell before there is a mesh: the one surface model (surface.hpp) on loops of
/// points.
struct CellMeasures {
  double volume = 0;
  double shortest_edge = kInfinity;
};

CellMeasures measure(const Eigen::Matrix3Xd& points, const PolyhedralMesh::CellLoops& loops) {
  CellMeasures measures;
  const Eigen::Vector3d origin = points.col(loops.front().front());
  for (const auto& loop : loops) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const int vertex : loop) mean += (points.col(vertex) - origin) / static_cast<double>(loop.size());
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Eigen::Vector3d a = points.col(loop[i]) - origin;
      const Eigen::Vector3d b = points.col(loop[(i + 1) % loop.size()]) - origin;
      measures.volume += mean.dot(a.cross(b)) / 6;
      measures.shortest_edge = std::min(measures.shortest_edge, (b - a).norm());
    }
  }
  return measures;
}

std::vector<char> findUsedPoints(const VolumeData& data) {
  std::vector<char> is_used(data.points.cols(), 0);
  for (const auto& cell : data.cells) {
    for (const auto& loop : cell) {
      for (const int vertex : loop) is_used[vertex] = 1;
    }
  }
  return is_used;
}

void requireNoDuplicates(const VolumeData& data, const std::vector<char>& is_used) {
  Eigen::AlignedBox3d box;
  for (int i = 0; i < data.points.cols(); ++i) {
    if (!is_used[i]) continue;
    if (!data.points.col(i).allFinite())
      refuse("node ", data.node_numbers[i], " has a coordinate that is not finite");
    box.extend(data.points.col(i));
  }
  const double tolerance = kSmallestRelativeDistance * box.diagonal().norm();
  if (!(tolerance > 0 && std::isfinite(tolerance)))
    refuse("all vertices lie in one point, or beyond all bounds");
  // Boxes of twice the tolerance, by a hash of their place: equal points lie in the same or in neighbouring
  // ones.
  using Place = std::array<std::int64_t, 3>;
  const auto hash = [](const Place& place) {
    std::uint64_t sum = 0;
    for (const std::int64_t k : place) sum = (sum ^ static_cast<std::uint64_t>(k)) * 0x9E3779B97F4A7C15u;
    return sum;
  };
  std::unordered_multimap<std::uint64_t, int> boxes;
  boxes.reserve(data.points.cols());
  for (int i = 0; i < data.points.cols(); ++i) {
    if (!is_used[i]) continue;
    const Eigen::Vector3d point = data.points.col(i);
    const Eigen::Array3d relative = (point - box.min()).array() / (2 * tolerance);
    Place place;
    for (int axis = 0; axis < 3; ++axis) place[axis] = static_cast<std::int64_t>(std::floor(relative(axis)));
    // Only the neighbours that the point is nearer to than half a box can hold its double.
    for (int corner = 0; corner < 8; ++corner) {
      Place other = place;
      for (int axis = 0; axis < 3; ++axis) {
        if ((corner >> axis & 1) == 0) continue;
        other[axis] += relative(axis) - static_cast<double>(place[axis]) < 0.5 ? -1 : 1;
      }
      const auto [first, last] = boxes.equal_range(hash(other));
      for (auto candidate = first; candidate != last; ++candidate) {
        const double distance = (data.points.col(candidate->second) - point).norm();
        if (distance > tolerance) continue;
        refuse("duplicate vertices: nodes ", data.node_numbers[candidate->second], " and ",
               data.node_numbers[i], " lie ", distance, " m apart at [", point.transpose(),
               "], must be more than ", tolerance, " m");
      }
    }
    boxes.emplace(hash(place), i);
  }
}

/// VTK's wedges begin with the triangle that Gmsh takes for the opposite one, yet some writers follow Gmsh. A
/// file is all one or all the other.
void turnVtkPrisms(VolumeData& data, std::vector<std::string>& remarks) {
  const bool are_all_inverted =
      !data.prisms.empty() && std::all_of(data.prisms.begin(), data.prisms.end(), [&data](std::size_t c) {
        return measure(data.points, data.cells[c]).volume < 0;
      });
  if (!are_all_inverted) return;
  for (const std::size_t c : data.prisms) {
    for (auto& loop : data.cells[c]) std::reverse(loop.begin(), loop.end());
  }
  remarks.push_back(makeText(data.prisms.size(), " prisms are in VTK's own order"));
}

void requirePositiveVolumes(const VolumeData& data) {
  std::size_t num_bad = 0;
  std::string first;
  for (std::size_t c = 0; c < data.cells.size(); ++c) {
    const CellMeasures cell = measure(data.points, data.cells[c]);
    const double smallest = kSmallestRelativeSubTet * std::pow(cell.shortest_edge, 3);
    if (cell.volume > smallest) continue;
    if (num_bad++ > 0) continue;
    first =
        makeText("cell ", data.cell_numbers[c], cell.volume < -smallest ? " is inverted" : " has zero volume",
                 ": volume ", cell.volume, " m^3, must be > 0");
  }
  if (num_bad > 1) refuse(first, " (and ", num_bad - 1, " more such cells)");
  if (num_bad == 1) refuse(first);
}

/// A cell of positive volume may still be folded, or flat in a part.
void requireStarShaped(const PolyhedralMesh& mesh, const VolumeData& data) {
  for (const CellId id : mesh.cells()) {
    const CellSurface surface = makeCellSurface(mesh, id, mesh.restPositions());
    const double smallest = smallestSubTetVolume(surface);
    const double bound = smallestSubTetAllowed(surface, mesh.localSize(id));
    if (smallest > bound) continue;
    refuse("cell ", data.cell_numbers[id.index()],
           " is folded or flat: its smallest part between centre and surface ", "has ", smallest,
           " m^3, must be above ", bound, " m^3");
  }
}

/// Reads what the file holds, cells or a closed surface, which is filled.
VolumeData readVolume(const MeshFileConfig& config, std::vector<std::string>& remarks) {
  const MeshFileType type = findMeshFileType(config.path);
  const DeclaredCounts declared = requireCompleteMeshFile(config.path, type);
  if (type == MeshFileType::kObj || type == MeshFileType::kOff) {
    return fillClosedSurface(readPolygonFile(config.path, config.scale), config.cell_size_m, remarks);
  }

  GmshData data = readWithGmsh(config.path, config.scale);
  if (declared.volume_cells && *declared.volume_cells != data.volume.cells.size()) {
    refuse("it announces ", *declared.volume_cells, " volume cells, Gmsh reads ", data.volume.cells.size(),
           " of them (truncated, or of a kind that Gmsh does not read in this format)");
  }
  if (!data.volume.cells.empty()) {
    if (type == MeshFileType::kVtk) turnVtkPrisms(data.volume, remarks);
    if (data.volume.has_higher_order) remarks.push_back("cells of higher order: only their corners are used");
    if (config.cell_size_m > 0) remarks.push_back("cell_size_m has no effect: the file has volume cells");
    return std::move(data.volume);
  }
  if (declared.polygons && *declared.polygons > data.surface.triangles.size()) {
    refuse("it announces ", *declared.polygons, " polygons, Gmsh reads ", data.surface.triangles.size(),
           " triangles of them (truncated?)");
  }
  if (data.surface.triangles.empty()) refuse("no volume cells and no closed surface");
  return fillClosedSurface(std::move(data.surface), config.cell_size_m, remarks);
}

MeshFile makeMeshFile(const MeshFileConfig& config) {
  requirePositive("scale", config.scale);
  requireInRange("cell_size_m", config.cell_size_m, 0, kInfinity);
  MeshFile file;
  VolumeData data = readVolume(config, file.remarks);
  file.region_names = std::move(data.region_names);
  const std::vector<char> is_used = findUsedPoints(data);
  const auto num_used = std::count(is_used.begin(), is_used.end(), 1);
  requireNoDuplicates(data, is_used);
  requirePositiveVolumes(data);
  file.mesh = PolyhedralMesh(data.points, data.cells, data.regions);
  requireStarShaped(file.mesh, data);

  if (num_used < data.points.cols()) {
    file.remarks.push_back(
        makeText(data.points.cols() - num_used, " nodes belong to no volume cell and were left out"));
  }
  if (file.mesh.numVertices() > num_used) {
    file.remarks.push_back(makeText(file.mesh.numVertices() - num_used,
                                    " vertices were copied where cells touch in an edge or a vertex alone"));
  }
  if (!data.volumes_of_several_groups.empty()) {
    file.remarks.push_back(makeText("volume ", data.volumes_of_several_groups.front(),
                                    " is in several physical groups: its cells are in the region of the "
                                    "smallest number alone"));
  }
  const int num_bodies = findPieces(file.mesh).count;
  if (num_bodies > 1) file.remarks.push_back(makeText(num_bodies, " unconnected bodies"));
  return file;
}

}  // namespace

MeshFile readMesh(const MeshFileConfig& config) {
  try {
    return makeMeshFile(config);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("mesh file \"" + config.path + "\": " + error.what());
  }
}

}  // namespace polyscalpel
