// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/collision/contact_detection.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision_object.h>

#include "polyscalpel/core/checks.hpp"
#include "tool_shape_impl.hpp"

namespace polyscalpel {
namespace {

constexpr int kPatchTriangles = 64;  // patches are halved until they have no more, so most have half to all
                                     // of it; a cut rebuilds whole ones
constexpr int kNone = -1, kWaiting = -2;     // instead of a patch's number
constexpr int kLargestPatchTriangles = 100;  // a patch that a cut has grown beyond is halved anew

using Positions = Eigen::Ref<const Eigen::Matrix3Xd>;
using Tree = fcl::BVHModel<fcl::AABBd>;

struct SurfaceTriangle {
  FaceId face;
  int triangle = 0;
  friend bool operator<(const SurfaceTriangle& a, const SurfaceTriangle& b) {
    return a.face != b.face ? a.face < b.face : a.triangle < b.triangle;
  }
};

/// Some neighbouring faces of the surface with the bounding volume tree of their triangles. Stays where it is
/// in memory.
struct Patch {
  std::vector<FaceId> faces;               // ascending
  std::vector<SurfaceTriangle> triangles;  // those of the faces, in their order
  std::shared_ptr<Tree> tree;
  std::unique_ptr<fcl::CollisionObjectd> object;  // user data: this patch
};

std::vector<fcl::Vector3d> cornersOf(const PolyhedralMesh& mesh, const Positions& positions,
                                     const Patch& patch) {
  std::vector<fcl::Vector3d> corners;
  corners.reserve(3 * patch.triangles.size());
  for (const FaceId id : patch.faces) {
    // As triangleCorners(), with the virtual vertex of a fan computed once for all its triangles.
    const Face& face = mesh.face(id);
    const auto& loop = face.loop;
    const bool is_fan = numTriangles(face) > 1;
    const fcl::Vector3d first = is_fan ? virtualVertex(face, positions) : positions.col(loop[0].index());
    for (int i = 0; i < numTriangles(face); ++i) {
      const std::size_t second = is_fan ? i : 1;
      corners.push_back(first);
      corners.push_back(positions.col(loop[second].index()));
      corners.push_back(positions.col(loop[(second + 1) % loop.size()].index()));
    }
  }
  return corners;
}

/// Makes the tree from the faces.
void buildTree(const PolyhedralMesh& mesh, const Positions& positions, Patch& patch) {
  patch.triangles.clear();
  for (const FaceId face : patch.faces) {
    for (int i = 0; i < numTriangles(mesh.face(face)); ++i) patch.triangles.push_back({face, i});
  }
  const std::vector<fcl::Vector3d> corners = cornersOf(mesh, positions, patch);
  const int count = static_cast<int>(patch.triangles.size());
  std::vector<fcl::Triangle> indices;
  for (int i = 0; i < count; ++i) indices.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  patch.tree = std::make_shared<Tree>();
  bool is_built = patch.tree->beginModel(count, 3 * count) == fcl::BVH_OK;
  is_built = is_built && patch.tree->addSubModel(corners, indices) == fcl::BVH_OK;
  is_built = is_built && patch.tree->endModel() == fcl::BVH_OK;
  POLYSCALPEL_ASSERT(is_built);
  patch.object = std::make_unique<fcl::CollisionObjectd>(patch.tree);  // computes the bounds
  patch.object->setUserData(&patch);
}

/// Moves the tree's triangles and fits its boxes from the leaves to the root.
void refitTree(const PolyhedralMesh& mesh, const Positions& positions, Patch& patch) {
  bool is_refitted = patch.tree->beginReplaceModel() == fcl::BVH_OK;
  is_refitted = is_refitted && patch.tree->replaceSubModel(cornersOf(mesh, positions, patch)) == fcl::BVH_OK;
  is_refitted = is_refitted && patch.tree->endReplaceModel(true, true) == fcl::BVH_OK;
  POLYSCALPEL_ASSERT(is_refitted);
  // FCL's own computeLocalAABB() goes over all vertices twice; the root's box is the same.
  patch.tree->aabb_local = patch.tree->getBV(0).bv;
  patch.tree->aabb_center = patch.tree->aabb_local.center();
  patch.tree->aabb_radius = 0.5 * (patch.tree->aabb_local.max_ - patch.tree->aabb_local.min_).norm();
  patch.object->computeAABB();
}

Eigen::Vector3d centreOf(const PolyhedralMesh& mesh, const Positions& positions, FaceId face) {
  return virtualVertex(mesh.face(face), positions);
}

/// Halves a set of faces at the median along its longest extent until no part has more than kPatchTriangles
/// triangles.
void splitFaces(const PolyhedralMesh& mesh, const Positions& positions, std::vector<FaceId> faces,
                std::vector<std::vector<FaceId>>& parts) {
  int triangles = 0;
  Eigen::AlignedBox3d box;
  for (const FaceId face : faces) {
    triangles += numTriangles(mesh.face(face));
    box.extend(centreOf(mesh, positions, face));
  }
  if (triangles <= kPatchTriangles || faces.size() < 2) {
    std::sort(faces.begin(), faces.end());
    parts.push_back(std::move(faces));
    return;
  }
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  std::vector<std::pair<double, FaceId>> sorted;
  for (const FaceId face : faces) sorted.emplace_back(centreOf(mesh, positions, face)(axis), face);
  std::sort(sorted.begin(), sorted.end());
  std::vector<FaceId> lower, upper;
  for (std::size_t i = 0; i < sorted.size(); ++i)
    (2 * i < sorted.size() ? lower : upper).push_back(sorted[i].second);
  splitFaces(mesh, positions, std::move(lower), parts);
  splitFaces(mesh, positions, std::move(upper), parts);
}

bool isOnSurface(const PolyhedralMesh& mesh, FaceId face) {
  return mesh.face(face).isAlive() && mesh.face(face).isBoundary();
}

/// The tool's bounding box, grown by the margin, for tests against the boxes of the trees.
struct Query {
  Eigen::Matrix3d R_shape_world;
  Eigen::Vector3d centre_world;
  Eigen::Vector3d half_size;

  bool misses(const fcl::AABBd& box) const {
    return fcl::obbDisjoint<double>(R_shape_world, R_shape_world * (box.center() - centre_world), half_size,
                                    0.5 * (box.max_ - box.min_));
  }
};

void collectTriangles(const Patch& patch, int node_id, const Query& query,
                      std::vector<SurfaceTriangle>& candidates) {
  const fcl::BVNode<fcl::AABBd>& node = patch.tree->getBV(node_id);
  if (query.misses(node.bv)) return;
  if (node.isLeaf()) {
    candidates.push_back(patch.triangles[node.primitiveId()]);
    return;
  }
  collectTriangles(patch, node.leftChild(), query, candidates);
  collectTriangles(patch, node.rightChild(), query, candidates);
}

bool rememberPatch(fcl::CollisionObjectd* first, fcl::CollisionObjectd* second, void* patches) {
  // The manager hands over its own object and the query, which has no user data.
  const fcl::CollisionObjectd* object = first->getUserData() != nullptr ? first : second;
  static_cast<std::vector<const Patch*>*>(patches)->push_back(
      static_cast<const Patch*>(object->getUserData()));
  return false;
}

}  // namespace

struct TissueSurface::Impl {
  std::map<int, Patch> patches;    // by number; numbers are never given again
  std::vector<int> patch_of_face;  // kNone: not on the surface
  int next_patch = 0;
  fcl::DynamicAABBTreeCollisionManagerd manager;

  void addPatches(const PolyhedralMesh& mesh, const Positions& positions, const std::vector<FaceId>& faces) {
    std::vector<std::vector<FaceId>> parts;
    splitFaces(mesh, positions, faces, parts);
    for (std::vector<FaceId>& part : parts) {
      Patch& patch = patches[next_patch];
      for (const FaceId face : part) patch_of_face[face.index()] = next_patch;
      patch.faces = std::move(part);
      buildTree(mesh, positions, patch);
      manager.registerObject(patch.object.get());
      ++next_patch;
    }
  }

  void removePatch(int number) {
    Patch& patch = patches.at(number);
    manager.unregisterObject(patch.object.get());
    patches.erase(number);
  }

  /// The patch that holds most faces around the face's vertices, the lowest number of several; -1 if there is
  /// none.
  int patchAround(const PolyhedralMesh& mesh, FaceId face) const {
    std::vector<int> numbers;
    for (const VertexId vertex : mesh.face(face).loop) {
      for (const FaceId other : mesh.facesAround(vertex)) {
        if (patch_of_face[other.index()] >= 0) numbers.push_back(patch_of_face[other.index()]);
      }
    }
    std::sort(numbers.begin(), numbers.end());
    int best = -1;
    std::ptrdiff_t most = 0;
    for (auto first = numbers.begin(); first != numbers.end();) {
      const auto last = std::upper_bound(first, numbers.end(), *first);
      if (last - first > most) {
        most = last - first;
        best = *first;
      }
      first = last;
    }
    return best;
  }

  /// The patch whose bounding box is nearest; -1 if there is no patch.
  int nearestPatch(const Eigen::Vector3d& point) const {
    int best = -1;
    double best_distance = kInfinity;
    for (const auto& [number, patch] : patches) {
      const fcl::AABBd& box = patch.object->getAABB();
      const double distance = (box.min_ - point).cwiseMax(point - box.max_).cwiseMax(0.0).squaredNorm();
      if (distance < best_distance) {
        best = number;
        best_distance = distance;
      }
    }
    return best;
  }
};

TissueSurface::TissueSurface(const PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions)
    : impl_(std::make_unique<Impl>()) {
  impl_->patch_of_face.assign(mesh.faceCapacity(), kNone);
  std::vector<FaceId> faces;
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    if (isOnSurface(mesh, FaceId(i))) faces.emplace_back(i);
  }
  if (!faces.empty()) impl_->addPatches(mesh, positions, faces);
  impl_->manager.setup();
}

TissueSurface::~TissueSurface() = default;
TissueSurface::TissueSurface(TissueSurface&&) noexcept = default;
TissueSurface& TissueSurface::operator=(TissueSurface&&) noexcept = default;

void TissueSurface::update(const PolyhedralMesh& mesh, const MeshChange& change,
                           const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  Impl& impl = *impl_;
  impl.patch_of_face.resize(mesh.faceCapacity(), kNone);

  std::map<int, std::vector<FaceId>> faces_of_touched;
  const auto touch = [&](int number) -> std::vector<FaceId>& {
    const auto [entry, is_new] = faces_of_touched.try_emplace(number);
    if (is_new) entry->second = impl.patches.at(number).faces;
    return entry->second;
  };
  // Take out what died or went inside. A face that only changed its loop stays in its patch.
  std::vector<FaceId> to_place;
  for (const FaceId face : change.changed_faces) {
    int& number = impl.patch_of_face[face.index()];
    const bool is_on_surface = isOnSurface(mesh, face);
    if (number >= 0) {
      std::vector<FaceId>& faces = touch(number);
      if (!is_on_surface) {
        faces.erase(std::lower_bound(faces.begin(), faces.end(), face));
        number = kNone;
      }
    } else if (is_on_surface) {
      to_place.push_back(face);
    }
  }
  // Place the new ones beside their neighbours, in rounds from the placed ones outward.
  for (const FaceId face : to_place) impl.patch_of_face[face.index()] = kWaiting;
  std::vector<FaceId> candidates = to_place;
  auto next_alone = to_place.begin();  // where a part of the surface has no patch around it
  while (true) {
    std::vector<std::pair<FaceId, int>> placed;
    for (const FaceId face : candidates) {
      const int number = impl.patchAround(mesh, face);
      if (number >= 0) placed.emplace_back(face, number);
    }
    if (placed.empty()) {
      next_alone = std::find_if(next_alone, to_place.end(),
                                [&](FaceId face) { return impl.patch_of_face[face.index()] == kWaiting; });
      if (next_alone == to_place.end()) break;
      const int number = impl.nearestPatch(centreOf(mesh, positions, *next_alone));
      if (number < 0) break;  // the surface had no patch at all
      placed.emplace_back(*next_alone, number);
    }
    candidates.clear();
    for (const auto& [face, number] : placed) {
      impl.patch_of_face[face.index()] = number;
      touch(number).push_back(face);
    }
    for (const auto& [face, number] : placed) {
      for (const VertexId vertex : mesh.face(face).loop) {
        for (const FaceId other : mesh.facesAround(vertex)) {
          if (impl.patch_of_face[other.index()] == kWaiting) candidates.push_back(other);
        }
      }
    }
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  }
  to_place.erase(std::remove_if(to_place.begin(), to_place.end(),
                                [&](FaceId face) { return impl.patch_of_face[face.index()] != kWaiting; }),
                 to_place.end());

  for (auto& [number, faces] : faces_of_touched) {
    int triangles = 0;
    for (const FaceId face : faces) triangles += numTriangles(mesh.face(face));
    if (faces.empty() || triangles > kLargestPatchTriangles) {
      impl.removePatch(number);
      if (!faces.empty()) impl.addPatches(mesh, positions, faces);
      continue;
    }
    Patch& patch = impl.patches.at(number);
    impl.manager.unregisterObject(patch.object.get());
    std::sort(faces.begin(), faces.end());
    patch.faces = std::move(faces);
    buildTree(mesh, positions, patch);
    impl.manager.registerObject(patch.object.get());
  }
  if (!to_place.empty()) impl.addPatches(mesh, positions, to_place);
  impl.manager.update();
}

void TissueSurface::refit(const PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  for (auto& [number, patch] : impl_->patches) refitTree(mesh, positions, patch);
  impl_->manager.update();
}

std::vector<Contact> TissueSurface::findContacts(const PolyhedralMesh& mesh,
                                                 const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                                 const ToolShape& shape,
                                                 const Eigen::Isometry3d& T_world_tool,
                                                 double margin_m) const {
  const ToolShape::Impl& tool = shape.impl();
  const Eigen::Isometry3d T_world_shape = T_world_tool * tool.config.T_tool_shape;
  Query query;
  query.R_shape_world = T_world_shape.linear().transpose();
  query.centre_world = T_world_shape * tool.box_shape.center();
  query.half_size = 0.5 * tool.box_shape.sizes() + Eigen::Vector3d::Constant(margin_m);

  const Eigen::Vector3d extent_world = 2 * T_world_shape.linear().cwiseAbs() * query.half_size;
  fcl::CollisionObjectd box(std::make_shared<fcl::Boxd>(extent_world), Eigen::Matrix3d::Identity(),
                            query.centre_world);
  std::vector<const Patch*> patches;
  impl_->manager.collide(&box, &patches, &rememberPatch);
  std::vector<SurfaceTriangle> candidates;
  for (const Patch* patch : patches) collectTriangles(*patch, 0, query, candidates);
  std::sort(candidates.begin(), candidates.end());

  const Eigen::Isometry3d T_shape_world = T_world_shape.inverse();
  std::vector<Contact> contacts;
  std::vector<TriangleContact> parts;
  for (const SurfaceTriangle& candidate : candidates) {
    const Face& face = mesh.face(candidate.face);
    const Eigen::Matrix3d corners_world = triangleCorners(face, candidate.triangle, positions);
    const Eigen::Matrix3d corners_shape = T_shape_world * corners_world;
    parts.clear();
    if (tool.convex) {
      appendContacts(*tool.convex, corners_shape, margin_m, parts);
    } else {
      tool.mesh->appendContacts(corners_shape, margin_m, parts);
    }
    for (const TriangleContact& part : parts) {
      Contact contact;
      contact.face = candidate.face;
      contact.weights = vertexWeights(face, candidate.triangle, part.barycentric);
      contact.point_world = corners_world * part.barycentric;
      contact.normal_world = (T_world_shape.linear() * part.normal).normalized();
      contact.gap_m = part.gap;
      contact.area_m2 = part.area;
      contacts.push_back(std::move(contact));
    }
  }
  return contacts;
}

}  // namespace polyscalpel
