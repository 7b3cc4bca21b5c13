// SPDX-License-Identifier: BSD-3-Clause
#include "support/torture_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "polyscalpel/mesh/mesh_editing.hpp"
#include "support/torture_strokes.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

double uniform(TortureRandom& random, double lowest, double highest) {
  return std::uniform_real_distribution<double>(lowest, highest)(random);
}

int pick(TortureRandom& random, int count) {
  return std::uniform_int_distribution<int>(0, count - 1)(random);
}

/// 10^-k with whole k in [lowest, highest], of either sign.
double tiny(TortureRandom& random, int lowest, int highest) {
  const double size = std::pow(10.0, -(lowest + pick(random, highest - lowest + 1)));
  return pick(random, 2) ? size : -size;
}

Separator separatorOf(const PlaneCut& plane) {
  const Vector3d point = plane.point_world, normal = plane.normal_world.normalized();
  return {[point, normal](const Vector3d& x) { return normal.dot(x - point); }, 0};
}

TortureCut planeCut(const Vector3d& point, const Vector3d& normal) {
  TortureCut cut;
  const PlaneCut plane{point, normal};
  cut.operation = plane;
  cut.separator = separatorOf(plane);
  return cut;
}

/// What the makers of planes share: the body as it lies for the cut.
struct Posed {
  const PolyhedralMesh& mesh;
  double size;
  Matrix3Xd positions;

  Vector3d vertex(TortureRandom& random) const { return positions.col(pick(random, mesh.numVertices())); }
  FaceId face(TortureRandom& random) const {
    for (;;) {
      const FaceId id(pick(random, mesh.faceCapacity()));
      if (mesh.face(id).isAlive()) return id;
    }
  }
  /// Two ends of an edge.
  std::pair<Vector3d, Vector3d> edge(TortureRandom& random) const {
    const auto& loop = mesh.face(face(random)).loop;
    const int i = pick(random, static_cast<int>(loop.size()));
    return {positions.col(loop[i].index()), positions.col(loop[(i + 1) % loop.size()].index())};
  }
  Vector3d corner(FaceId id, int i) const { return positions.col(mesh.face(id).loop[i].index()); }
  /// Normal of a face by its area, of length 1; any direction where it has none.
  Vector3d normal(FaceId id) const {
    const auto& loop = mesh.face(id).loop;
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 1; i + 1 < loop.size(); ++i)
      sum += (corner(id, i) - corner(id, 0)).cross(corner(id, i + 1) - corner(id, 0));
    return sum.norm() > 0 ? Vector3d(sum.normalized()) : Vector3d(Vector3d::UnitX());
  }
};

Vector3d somePoint(const TortureBody& body, TortureRandom& random) {
  const Vector3d half = 0.5 * body.box().sizes();
  Vector3d point = body.box().center();
  for (int i = 0; i < 3; ++i) point[i] += uniform(random, -0.85, 0.85) * half[i];
  return point;
}

Posed posed(const TortureBody& body) {
  return {body.mesh(), body.size(), body.mesh().restPositions()};
}

using PlaneMaker = TortureCut (*)(const TortureBody&, const Posed&, TortureRandom&);

TortureCut randomPlane(const TortureBody& body, const Posed&, TortureRandom& random) {
  return planeCut(somePoint(body, random), someDirection(random));
}

TortureCut throughOneVertex(const TortureBody&, const Posed& at, TortureRandom& random) {
  return planeCut(at.vertex(random), someDirection(random));
}

/// Through two vertices: the ends of an edge as often as any two.
TortureCut throughTwoVertices(const TortureBody&, const Posed& at, TortureRandom& random) {
  auto [a, b] = at.edge(random);
  if (pick(random, 2)) b = at.vertex(random);
  const Vector3d normal = (b - a).cross(someDirection(random));
  return planeCut(a, normal.norm() > 0 ? normal : Vector3d(Vector3d::UnitX()));
}

TortureCut throughThreeVertices(const TortureBody&, const Posed& at, TortureRandom& random) {
  const auto [a, b] = at.edge(random);
  const Vector3d c = at.vertex(random);
  const Vector3d normal = (b - a).cross(c - a);
  return planeCut(a, normal.norm() > 0 ? normal : Vector3d(Vector3d::UnitZ()));
}

TortureCut alongAFace(const TortureBody&, const Posed& at, TortureRandom& random) {
  const FaceId face = at.face(random);
  return planeCut(at.corner(face, 0), at.normal(face));
}

/// 1e-3 to 1e-15 of the local size off a vertex, an edge or a face.
TortureCut hardlyOff(const TortureBody& body, const Posed& at, TortureRandom& random) {
  const PlaneMaker makers[] = {throughOneVertex, throughTwoVertices, throughThreeVertices, alongAFace};
  PlaneCut plane = std::get<PlaneCut>(makers[pick(random, 4)](body, at, random).operation);
  plane.normal_world.normalize();
  return planeCut(plane.point_world + tiny(random, 3, 15) * at.size * plane.normal_world, plane.normal_world);
}

/// Through the inside of a face, tilted against it by 0.1 to 1e-15.
TortureCut hardlyTilted(const TortureBody&, const Posed& at, TortureRandom& random) {
  const FaceId face = at.face(random);
  const Vector3d normal = at.normal(face), point = 0.4 * at.corner(face, 0) + 0.6 * at.corner(face, 1);
  return planeCut(point, normal + tiny(random, 1, 15) * someDirection(random));
}

/// All corners of the face with the most corners among some within the snap distance of the plane.
TortureCut snapsAllOfAFace(const TortureBody&, const Posed& at, TortureRandom& random) {
  FaceId face = at.face(random);
  for (int i = 0; i < 8; ++i) {
    const FaceId other = at.face(random);
    if (at.mesh.face(other).loop.size() > at.mesh.face(face).loop.size()) face = other;
  }
  const Vector3d normal = (at.normal(face) + 0.03 * someDirection(random)).normalized();
  return planeCut(at.corner(face, 0) + uniform(random, -0.03, 0.03) * at.size * normal, normal);
}

template <PlaneMaker make>
TortureCut makePlane(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const bool is_deformed = pick(random, 4) == 0;
  Posed at = posed(body);
  TortureCut probe;
  if (is_deformed) {
    probe.deformation = someDeformation(body, random);
    at.positions = body.positionsFor(probe);
  }
  TortureCut cut = make(body, at, random);
  cut.deformation = probe.deformation;
  return cut;
}

/// A star-shaped polygon, partly inside the body.
TortureCut makePolygon(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const Eigen::Matrix3d axes = someFrame(random);
  const Vector3d centre = somePoint(body, random);
  const double reach = body.box().diagonal().norm() * uniform(random, 0.1, 0.5);
  PolygonCut polygon;
  const int n = 3 + pick(random, 6);
  polygon.corners_world.resize(3, n);
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * M_PI * (i + uniform(random, 0, 0.5)) / n;
    polygon.corners_world.col(i) =
        centre +
        reach * uniform(random, 0.4, 1) * (std::cos(angle) * axes.col(0) + std::sin(angle) * axes.col(1));
  }
  TortureCut cut;
  cut.operation = polygon;
  if (pick(random, 4) == 0) cut.deformation = someDeformation(body, random);
  return cut;
}

}  // namespace

const std::vector<TortureKind>& tortureKinds() {
  static const std::vector<TortureKind> kinds = [] {
    std::vector<TortureKind> all = {{"plane", makePlane<randomPlane>},
                                    {"plane through a vertex", makePlane<throughOneVertex>},
                                    {"plane through 2 vertices", makePlane<throughTwoVertices>},
                                    {"plane through 3 vertices", makePlane<throughThreeVertices>},
                                    {"plane along a face", makePlane<alongAFace>},
                                    {"plane 1e-3 to 1e-15 h off", makePlane<hardlyOff>},
                                    {"plane hardly tilted against a face", makePlane<hardlyTilted>},
                                    {"plane that snaps a whole face", makePlane<snapsAllOfAFace>},
                                    {"polygon", makePolygon}};
    const std::vector<TortureKind> strokes = tortureStrokes();
    all.insert(all.end(), strokes.begin(), strokes.end());
    return all;
  }();
  return kinds;
}

TortureCut makeTortureCut(const TortureKind& kind, const TortureBody& body, const TortureCut* last,
                          TortureRandom& random) {
  TortureCut cut = kind.make(body, last, random);
  cut.kind = kind.name;
  return cut;
}

}  // namespace polyscalpel
