// SPDX-License-Identifier: BSD-3-Clause
//
// Papers: A. van Oosterom, J. Strackee, "The Solid Angle of a Plane Triangle", IEEE Transactions on
// Biomedical Engineering, 1983; M.-C. Rivara, "Algorithms for Refining Triangular Grids Suitable for Adaptive
// and Multigrid Techniques", International Journal for Numerical Methods in Engineering, 1984.
#include "surface_fill.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>
#include <sstream>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "gmsh_io.hpp"

namespace polyscalpel {
namespace {

using Triangle = std::array<int, 3>;
using Edge = std::pair<int, int>;

constexpr double kPi = 3.14159265358979323846;
/// Gmsh needs about 1 kB a cell: above this number it is taken for a mistake in the size.
constexpr double kMaxCells = 2e7;
/// Edges of the surface longer than this times the cell size are halved; halves are longer than half of it.
constexpr double kLongestRelativeEdge = 4.0 / 3;

template <class... Parts>
std::string makeText(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

/// Joins points that are equal in every bit, as triangle soups have them, and drops triangles that vanish by
/// that.
int weld(SurfaceData& surface) {
  const Eigen::Matrix3Xd& points = surface.points;
  std::vector<int> order(points.cols());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&points](int i) { return std::make_tuple(points(0, i), points(1, i), points(2, i), i); };
  std::sort(order.begin(), order.end(), [&key](int a, int b) { return key(a) < key(b); });
  std::vector<int> first(points.cols());
  int num_joined = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool is_equal = k > 0 && points.col(order[k]) == points.col(order[k - 1]);
    first[order[k]] = is_equal ? first[order[k - 1]] : order[k];
    num_joined += is_equal;
  }
  for (Triangle& triangle : surface.triangles) {
    for (int& corner : triangle) corner = first[corner];
  }
  const auto hasVanished = [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; };
  surface.triangles.erase(std::remove_if(surface.triangles.begin(), surface.triangles.end(), hasVanished),
                          surface.triangles.end());
  return num_joined;
}

/// Numbers the used points in a row, so that Gmsh gets no others.
void dropUnusedPoints(SurfaceData& surface) {
  std::vector<int> new_index(surface.points.cols(), -1);
  for (const Triangle& triangle : surface.triangles) {
    for (const int corner : triangle) new_index[corner] = 0;
  }
  int num_used = 0;
  for (int i = 0; i < surface.points.cols(); ++i) {
    if (new_index[i] < 0) continue;
    surface.points.col(num_used) = surface.points.col(i).eval();
    new_index[i] = num_used++;
  }
  surface.points.conservativeResize(3, num_used);
  for (Triangle& triangle : surface.triangles) {
    for (int& corner : triangle) corner = new_index[corner];
  }
}

/// The triangle to the left of each directed edge.
using EdgeMap = std::map<Edge, int>;

EdgeMap makeEdgeMap(const std::vector<Triangle>& triangles) {
  EdgeMap edges;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const Edge edge(triangles[t][i], triangles[t][(i + 1) % 3]);
      if (edges.emplace(edge, static_cast<int>(t)).second) continue;
      throw std::invalid_argument(
          makeText("the surface is not oriented alike everywhere, or more than two of its ",
                   "triangles meet in an edge (between its points ", edge.first, " and ", edge.second,
                   ", counted from 0)"));
    }
  }
  std::size_t num_open = 0;
  Edge open;
  for (const auto& entry : edges) {
    if (edges.count({entry.first.second, entry.first.first}) > 0) continue;
    if (num_open++ == 0) open = entry.first;
  }
  if (num_open > 0) {
    throw std::invalid_argument(makeText("the surface is not closed: ", num_open,
                                         " open edges, the first between its ", "points ", open.first,
                                         " and ", open.second, ", counted from 0"));
  }
  return edges;
}

/// The connected parts of the surface.
std::vector<Shell> findShells(const std::vector<Triangle>& triangles, const EdgeMap& edges) {
  std::vector<Shell> shells;
  std::vector<char> is_visited(triangles.size(), 0);
  for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
    if (is_visited[seed]) continue;
    std::vector<int> members = {static_cast<int>(seed)};
    is_visited[seed] = 1;
    for (std::size_t k = 0; k < members.size(); ++k) {
      const Triangle& triangle = triangles[members[k]];
      for (int i = 0; i < 3; ++i) {
        const int other = edges.at({triangle[(i + 1) % 3], triangle[i]});
        if (is_visited[other]) continue;
        is_visited[other] = 1;
        members.push_back(other);
      }
    }
    std::sort(members.begin(), members.end());
    Shell& shell = shells.emplace_back();
    for (const int member : members) shell.push_back(triangles[member]);
  }
  return shells;
}

/// Signed volume inside a shell [m^3].
double volume(const Eigen::Matrix3Xd& points, const Shell& shell) {
  const Eigen::Vector3d origin = points.col(shell.front()[0]);
  double sum = 0;
  for (const Triangle& t : shell) {
    const Eigen::Vector3d a = points.col(t[0]) - origin;
    const Eigen::Vector3d b = points.col(t[1]) - origin;
    const Eigen::Vector3d c = points.col(t[2]) - origin;
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

/// Whether the shell winds around the point: its solid angles (van Oosterom and Strackee 1983, equation 8)
/// sum to 4 pi, of either sign.
bool isInside(const Eigen::Matrix3Xd& points, const Shell& shell, const Eigen::Vector3d& point) {
  double angle = 0;
  for (const Triangle& t : shell) {
    const Eigen::Vector3d a = points.col(t[0]) - point;
    const Eigen::Vector3d b = points.col(t[1]) - point;
    const Eigen::Vector3d c = points.col(t[2]) - point;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(angle) > 2 * kPi;
}

/// Groups shells into bodies, an outer shell with its cavities each, and turns all triangles over if the
/// whole surface is oriented inward.
std::vector<std::vector<Shell>> groupIntoBodies(const Eigen::Matrix3Xd& points, std::vector<Shell> shells,
                                                std::vector<std::string>& remarks) {
  const int n = static_cast<int>(shells.size());
  std::vector<std::vector<int>> around(n);  // the shells that each lies inside of
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      if (i != j && isInside(points, shells[j], points.col(shells[i].front()[0]))) around[i].push_back(j);
    }
  }
  int num_wrong = 0;
  for (int i = 0; i < n; ++i) {
    const bool is_cavity = around[i].size() % 2 == 1;
    num_wrong += (volume(points, shells[i]) < 0) != is_cavity;
  }
  if (num_wrong > 0 && num_wrong < n) {
    throw std::invalid_argument(makeText(num_wrong, " of the surface's ", n,
                                         " shells are oriented against the others ",
                                         "(a shell must face outward, a cavity in it inward)"));
  }
  if (num_wrong == n) {
    for (Shell& shell : shells) {
      for (Triangle& triangle : shell) std::swap(triangle[1], triangle[2]);
    }
    remarks.push_back("the surface faces inward: all its triangles were turned over");
  }

  std::vector<std::vector<Shell>> bodies;
  std::vector<int> body_of_shell(n, -1);
  for (int i = 0; i < n; ++i) {
    if (around[i].size() % 2 == 1) continue;
    body_of_shell[i] = static_cast<int>(bodies.size());
    bodies.push_back({shells[i]});
  }
  for (int i = 0; i < n; ++i) {
    if (around[i].size() % 2 == 0) continue;
    // The innermost of the shells around a cavity is the one inside of most others.
    const int outer = *std::max_element(around[i].begin(), around[i].end(),
                                        [&](int a, int b) { return around[a].size() < around[b].size(); });
    if (body_of_shell[outer] < 0) throw std::invalid_argument("the surface's shells cut each other");
    bodies[body_of_shell[outer]].push_back(shells[i]);
  }
  return bodies;
}

double meanEdgeLength(const SurfaceData& surface) {
  double sum = 0;
  for (const Triangle& t : surface.triangles) {
    for (int i = 0; i < 3; ++i) sum += (surface.points.col(t[i]) - surface.points.col(t[(i + 1) % 3])).norm();
  }
  return sum / (3 * static_cast<double>(surface.triangles.size()));
}

double area(const SurfaceData& surface) {
  double sum = 0;
  for (const Triangle& t : surface.triangles) {
    const Eigen::Vector3d a = surface.points.col(t[1]) - surface.points.col(t[0]);
    const Eigen::Vector3d b = surface.points.col(t[2]) - surface.points.col(t[0]);
    sum += a.cross(b).norm() / 2;
  }
  return sum;
}

/// Halves edges longer than longest [m], the longest first (Rivara 1984), so that angles stay away from zero.
void refine(SurfaceData& surface, EdgeMap& edges, double longest) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < surface.points.cols(); ++i) points.push_back(surface.points.col(i));
  std::vector<Triangle>& triangles = surface.triangles;
  using Candidate = std::pair<double, Edge>;
  std::priority_queue<Candidate> candidates;
  const auto consider = [&](int a, int b) {
    const double length = (points[a] - points[b]).norm();
    if (length > longest) candidates.push({length, std::minmax(a, b)});
  };
  for (const auto& entry : edges) {
    if (entry.first.first < entry.first.second) consider(entry.first.first, entry.first.second);
  }
  while (!candidates.empty()) {
    const auto [start, end] = candidates.top().second;
    candidates.pop();
    const int middle = static_cast<int>(points.size());
    points.push_back((points[start] + points[end]) / 2);
    for (const Edge& side : {Edge(start, end), Edge(end, start)}) {
      const int near = edges.at(side);
      Triangle& triangle = triangles[near];
      int opposite = triangle[0];
      for (const int corner : triangle) {
        if (corner != side.first && corner != side.second) opposite = corner;
      }
      const int far = static_cast<int>(triangles.size());
      triangle = {side.first, middle, opposite};
      triangles.push_back({middle, side.second, opposite});
      edges.erase(side);
      edges[{side.first, middle}] = near;
      edges[{middle, opposite}] = near;
      edges[{middle, side.second}] = far;
      edges[{side.second, opposite}] = far;
      edges[{opposite, middle}] = far;
      consider(middle, opposite);
    }
    consider(start, middle);
    consider(middle, end);
  }
  surface.points.resize(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) surface.points.col(i) = points[i];
}

double tetVolume(const Eigen::Matrix3Xd& points, const PolyhedralMesh::CellLoops& loops) {
  Shell shell;
  for (const auto& loop : loops) shell.push_back({loop[0], loop[1], loop[2]});
  return volume(points, shell);
}

}  // namespace

VolumeData fillClosedSurface(SurfaceData surface, double cell_size_m, std::vector<std::string>& remarks) {
  if (!surface.points.allFinite()) throw std::invalid_argument("a point of the surface is not finite");
  const int num_joined = weld(surface);
  if (num_joined > 0) remarks.push_back(makeText(num_joined, " points equal to others were joined to them"));
  dropUnusedPoints(surface);
  if (surface.triangles.empty()) throw std::invalid_argument("no volume cells and no triangles");
  EdgeMap edges = makeEdgeMap(surface.triangles);

  const double mean_edge = meanEdgeLength(surface);
  const double size = cell_size_m > 0 ? cell_size_m : mean_edge;
  double enclosed = 0;
  for (const Shell& shell : findShells(surface.triangles, edges)) {
    const double shell_volume = volume(surface.points, shell);
    if (shell_volume == 0) throw std::invalid_argument("the surface has a shell that encloses no volume");
    enclosed += shell_volume;
  }
  enclosed = std::abs(enclosed);
  const double num_expected =
      std::max(enclosed / (size * size * size / (6 * std::sqrt(2.0))), area(surface) / (size * size));
  if (!(num_expected <= kMaxCells)) {
    throw std::invalid_argument(makeText("cell_size_m = ", size, ": would fill ", enclosed,
                                         " m^3 with about ", num_expected, " cells, must be at most ",
                                         kMaxCells));
  }
  if (cell_size_m > 0) refine(surface, edges, kLongestRelativeEdge * size);
  if (cell_size_m > 1.5 * mean_edge) {
    remarks.push_back(makeText("the surface keeps its edges of ", mean_edge,
                               " m in the mean, shorter than cell_size_m = ", cell_size_m));
  }

  const std::vector<std::vector<Shell>> bodies =
      groupIntoBodies(surface.points, findShells(surface.triangles, edges), remarks);
  VolumeData filled = fillWithTets(surface.points, bodies, size);
  double sum = 0;
  for (const auto& cell : filled.cells) sum += tetVolume(filled.points, cell);
  if (!(std::abs(sum - enclosed) <= 1e-9 * enclosed)) {
    throw std::invalid_argument(makeText("the surface could not be filled: it encloses ", enclosed,
                                         " m^3, the tetrahedra ", sum, " m^3 (does it cut itself?)"));
  }
  return filled;
}

}  // namespace polyscalpel
