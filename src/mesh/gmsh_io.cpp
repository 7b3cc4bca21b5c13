// SPDX-License-Identifier: BSD-3-Clause
#include "gmsh_io.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <unordered_map>

#include <gmsh.h>

#include "standard_cells.hpp"

namespace polyscalpel {
namespace {

/// Gmsh's own numbers of element types.
constexpr int kGmshTriangle = 2;

/// One use of Gmsh, silent and without its configuration files; what it says is kept.
class GmshSession {
 public:
  GmshSession() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.NumThreads", 1);  // the same mesh on every machine
    gmsh::logger::start();
  }
  ~GmshSession() {
    try {
      gmsh::logger::stop();  // or the next session would find this one's messages
      gmsh::finalize();
    } catch (...) {  // a destructor must not throw; the next session starts from nothing anyway
    }
  }
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;

  /// Runs work; throws std::invalid_argument if Gmsh throws or has logged an error or, with refuse_warnings,
  /// a warning.
  template <class Work>
  void run(bool refuse_warnings, Work work) const {
    try {
      work();
    } catch (const std::invalid_argument&) {
      throw;
    } catch (const std::exception& error) {
      refuse(error.what());
    } catch (const std::string& error) {
      refuse(error);
    } catch (...) {
      refuse(lastComplaint(true));
    }
    const std::string complaint = lastComplaint(refuse_warnings);
    if (!complaint.empty()) refuse(complaint);
  }

 private:
  [[noreturn]] static void refuse(const std::string& reason) {
    throw std::invalid_argument("Gmsh says: " + (reason.empty() ? "unknown error" : reason));
  }

  static bool startsWith(const std::string& text, const char* start) { return text.rfind(start, 0) == 0; }

  static std::string lastComplaint(bool with_warnings) {
    std::vector<std::string> log;
    gmsh::logger::get(log);
    for (auto line = log.rbegin(); line != log.rend(); ++line) {
      if (startsWith(*line, "Error")) return *line;
      // Said of every binary .ply; what was read of it is checked by its counts.
      if (line->find("PLY files is experimental") != std::string::npos) continue;
      if (with_warnings && startsWith(*line, "Warning")) return *line;
    }
    return {};
  }
};

enum class Shape { kTetrahedron, kPyramid, kPrism, kHexahedron };

struct ElementType {
  std::string name;
  int num_nodes = 0;
  int num_corners = 0;
};

ElementType findElementType(int type) {
  ElementType result;
  int dimension = 0;
  int order = 0;
  std::vector<double> local_coordinates;
  gmsh::model::mesh::getElementProperties(type, result.name, dimension, order, result.num_nodes,
                                          local_coordinates, result.num_corners);
  return result;
}

Shape findShape(const ElementType& type) {
  static const std::vector<std::tuple<const char*, int, Shape>> kShapes = {
      {"Tetrahedron", 4, Shape::kTetrahedron},
      {"Pyramid", 5, Shape::kPyramid},
      {"Prism", 6, Shape::kPrism},
      {"Hexahedron", 8, Shape::kHexahedron},
  };
  for (const auto& [name, corners, shape] : kShapes) {
    if (type.name.rfind(name, 0) == 0 && type.num_corners == corners) return shape;
  }
  throw std::invalid_argument("cells of type \"" + type.name +
                              "\": only tetrahedra, hexahedra, prisms and pyramids are read");
}

PolyhedralMesh::CellLoops makeLoops(Shape shape, const std::vector<int>& v) {
  switch (shape) {
    case Shape::kTetrahedron:
      return makeTetLoops({v[0], v[1], v[2], v[3]});
    case Shape::kPyramid:
      return makePyramidLoops({v[0], v[1], v[2], v[3], v[4]});
    case Shape::kPrism:
      return makePrismLoops({v[0], v[1], v[2], v[3], v[4], v[5]});
    case Shape::kHexahedron:
      return makeHexLoops({v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]});
  }
  throw std::logic_error("unknown shape");
}

/// The nodes of Gmsh's current model, ascending by number.
class Nodes {
 public:
  explicit Nodes(double scale) {
    std::vector<std::size_t> tags;
    std::vector<double> coordinates;
    std::vector<double> parameters;
    gmsh::model::mesh::getNodes(tags, coordinates, parameters);
    std::vector<std::size_t> order(tags.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&tags](std::size_t a, std::size_t b) { return tags[a] < tags[b]; });
    points_.resize(3, tags.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      numbers_.push_back(tags[order[i]]);
      index_of_[tags[order[i]]] = static_cast<int>(i);
      points_.col(i) = scale * Eigen::Map<const Eigen::Vector3d>(coordinates.data() + 3 * order[i]);
    }
  }

  int index(std::size_t number) const {
    const auto found = index_of_.find(number);
    if (found == index_of_.end())
      throw std::invalid_argument("node " + std::to_string(number) + " is missing");
    return found->second;
  }

  const Eigen::Matrix3Xd& points() const { return points_; }
  const std::vector<std::size_t>& numbers() const { return numbers_; }

 private:
  Eigen::Matrix3Xd points_;
  std::vector<std::size_t> numbers_;
  std::unordered_map<std::size_t, int> index_of_;
};

/// Calls visit(type, number, corners as indices) for each element of the dimension in the entity (-1: in
/// all).
template <class Visit>
void forEachElement(const Nodes& nodes, int dimension, int entity, Visit visit) {
  std::vector<int> types;
  std::vector<std::vector<std::size_t>> numbers;
  std::vector<std::vector<std::size_t>> node_numbers;
  gmsh::model::mesh::getElements(types, numbers, node_numbers, dimension, entity);
  for (std::size_t t = 0; t < types.size(); ++t) {
    const ElementType type = findElementType(types[t]);
    std::vector<int> corners(type.num_corners);
    for (std::size_t e = 0; e < numbers[t].size(); ++e) {
      for (int c = 0; c < type.num_corners; ++c)
        corners[c] = nodes.index(node_numbers[t][e * type.num_nodes + c]);
      visit(type, numbers[t][e], corners);
    }
  }
}

/// The numbers of the physical groups that the volume belongs to, ascending.
std::vector<int> findGroups(int volume) {
  std::vector<int> groups;
  gmsh::model::getPhysicalGroupsForEntity(3, volume, groups);
  for (int& group : groups) group = std::abs(group);
  std::sort(groups.begin(), groups.end());
  return groups;
}

std::map<std::string, int> findRegionNames() {
  std::map<std::string, int> names;
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups, 3);
  for (const auto& [dimension, group] : groups) {
    std::string name;
    gmsh::model::getPhysicalName(dimension, group, name);
    if (!name.empty()) names.emplace(name, std::abs(group));
  }
  return names;
}

VolumeData collectVolume(const Nodes& nodes) {
  struct Item {
    std::size_t number;
    int region;
    Shape shape;
    PolyhedralMesh::CellLoops loops;
  };
  VolumeData volume;
  volume.points = nodes.points();
  volume.node_numbers = nodes.numbers();
  volume.region_names = findRegionNames();
  std::vector<Item> items;
  gmsh::vectorpair entities;
  gmsh::model::getEntities(entities, 3);
  for (const auto& [dimension, entity] : entities) {
    const std::vector<int> groups = findGroups(entity);
    const int region = groups.empty() ? 0 : groups.front();
    if (groups.size() > 1) volume.volumes_of_several_groups.push_back(entity);
    forEachElement(nodes, dimension, entity,
                   [&](const ElementType& type, std::size_t number, const std::vector<int>& corners) {
                     const Shape shape = findShape(type);
                     volume.has_higher_order |= type.num_nodes != type.num_corners;
                     items.push_back({number, region, shape, makeLoops(shape, corners)});
                   });
  }
  std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.number < b.number; });
  for (Item& item : items) {
    if (item.shape == Shape::kPrism) volume.prisms.push_back(volume.cells.size());
    volume.cells.push_back(std::move(item.loops));
    volume.cell_numbers.push_back(item.number);
    volume.regions.push_back(item.region);
  }
  return volume;
}

SurfaceData collectSurface(const Nodes& nodes) {
  SurfaceData surface;
  surface.points = nodes.points();
  forEachElement(nodes, 2, -1, [&](const ElementType&, std::size_t, const std::vector<int>& corners) {
    for (std::size_t i = 2; i < corners.size(); ++i) {
      surface.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
  });
  return surface;
}

/// Gives Gmsh's current model a surface of the given number; the first brings all points along.
void addSurface(int number, const Eigen::Matrix3Xd& points, const Shell& shell) {
  gmsh::model::addDiscreteEntity(2, number);
  if (number == 1) {
    std::vector<std::size_t> numbers(points.cols());
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = i + 1;
    gmsh::model::mesh::addNodes(2, number, numbers, {points.data(), points.data() + points.size()});
  }
  std::vector<std::size_t> corners;
  for (const auto& triangle : shell) {
    for (const int corner : triangle) corners.push_back(static_cast<std::size_t>(corner) + 1);
  }
  gmsh::model::mesh::addElementsByType(number, kGmshTriangle, {}, corners);
}

}  // namespace

GmshData readWithGmsh(const std::string& path, double scale) {
  const GmshSession session;
  GmshData data;
  session.run(true, [&] {
    gmsh::merge(path);
    const Nodes nodes(scale);
    data.volume = collectVolume(nodes);
    data.surface = collectSurface(nodes);
  });
  return data;
}

VolumeData fillWithTets(const Eigen::Matrix3Xd& points, const std::vector<std::vector<Shell>>& bodies,
                        double cell_size_m) {
  const GmshSession session;
  VolumeData data;
  session.run(false, [&] {
    gmsh::option::setNumber("Mesh.MeshSizeMax", cell_size_m);
    gmsh::model::add("bodies");
    int surface = 0;
    for (const std::vector<Shell>& shells : bodies) {
      for (const Shell& shell : shells) addSurface(++surface, points, shell);
    }
    gmsh::model::mesh::reclassifyNodes();
    gmsh::model::mesh::createTopology(false, true);
    surface = 0;
    for (const std::vector<Shell>& shells : bodies) {
      // Each shell is a surface of its own: Gmsh tells a cavity from the body by the surfaces around it.
      std::vector<int> loops;
      for (std::size_t i = 0; i < shells.size(); ++i)
        loops.push_back(gmsh::model::geo::addSurfaceLoop({++surface}));
      gmsh::model::geo::addVolume(loops);
    }
    gmsh::model::geo::synchronize();
    gmsh::model::mesh::generate(3);
    data = collectVolume(Nodes(1));
  });
  return data;
}

}  // namespace polyscalpel
