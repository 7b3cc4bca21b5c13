// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/cap_facets.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "support/torture.hpp"

namespace polyscalpel {
namespace {

using Eigen::Vector3d;

/// Vertices of a mesh at the given points.
std::vector<VertexId> verticesAt(const PolyhedralMesh& mesh, const std::vector<Vector3d>& points) {
  std::vector<VertexId> vertices;
  for (const Vector3d& point : points) {
    for (int i = 0; i < mesh.numVertices(); ++i) {
      if (mesh.restPosition(VertexId(i)) == point) vertices.emplace_back(i);
    }
  }
  return vertices;
}

/// How far a loop turns inwards at the worst of its corners, as part of the area that it spans there; the
/// side that the normal points to is its outer one.
template <class Loop>
double deepestBay(const PolyhedralMesh& mesh, const Loop& loop, const Vector3d& normal) {
  double deepest = 0;
  const std::size_t n = loop.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3d a = mesh.restPosition(loop[i]), b = mesh.restPosition(loop[(i + 1) % n]),
                   c = mesh.restPosition(loop[(i + 2) % n]);
    const double size = mesh.localSize(loop[(i + 1) % n]);
    deepest = std::max(deepest, -normal.dot((b - a).cross(c - b)) / (size * size));
  }
  return deepest;
}

TEST(CapFacets, AFlatLoopIsOneFaceOnlyIfItIsConvex) {
  const PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d(3, 3, 1), {3, 3, 1});
  const Vector3d below(1, 1, -1), above(1, 1, 1);
  const std::vector<VertexId> square =
      verticesAt(mesh, {{0, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}});
  EXPECT_EQ(makeCapFacets(mesh, square, below, above).size(), 1u);

  const std::vector<VertexId> hook =
      verticesAt(mesh, {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {0, 1, 0}});
  double area = 0;
  for (const auto& facet : makeCapFacets(mesh, hook, below, above)) {
    EXPECT_EQ(deepestBay(mesh, facet, Vector3d::UnitZ()), 0);
    for (std::size_t i = 1; i + 1 < facet.size(); ++i) {
      const Vector3d a = mesh.restPosition(facet[0]);
      area +=
          0.5 * (mesh.restPosition(facet[i]) - a).cross(Vector3d(mesh.restPosition(facet[i + 1]) - a)).z();
    }
  }
  EXPECT_NEAR(area, 5, 1e-12);
}

TEST(CapFacets, RandomCutsLeaveNoFaceWithABay) {
  // Bent caps make cells that are not convex, in which a flat cut has bays; their parts would be folded by
  // the next cut through them. So do the planes that close a front within the tissue.
  const std::vector<TortureSubject> subjects = tortureSubjects(TortureSize::kSmall);
  TorturePlan plan;
  plan.kinds = {"plane",
                "plane through 2 vertices",
                "polygon",
                "stroke straight through",
                "stroke curved through",
                "stroke twisted at coarse steps",
                "stroke that stops inside"};
  for (const unsigned seed : {1u, 4u, 11u}) {
    TortureSequence sequence(plan, seed);
    TortureBody body(subjects[0].name, subjects[0].make(), subjects[0].is_convex);
    for (int i = 0; i < 16; ++i) {
      const TortureCut& cut = sequence.next(body);
      body.apply(cut, CuttingConfig());
    }
    const PolyhedralMesh& mesh = body.mesh();
    for (int i = 0; i < mesh.faceCapacity(); ++i) {
      const Face& face = mesh.face(FaceId(i));
      if (!face.isAlive()) continue;
      const Vector3d normal = planeOf(face, mesh.restPositions()).second.normalized();
      EXPECT_LT(deepestBay(mesh, face.loop, normal), 1e-12) << "seed " << seed << ", face " << i;
    }
  }
}

}  // namespace
}  // namespace polyscalpel
