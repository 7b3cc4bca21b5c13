// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/collision/tool_shape.hpp"
#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {

/// A place where a tool touches, or is about to touch, a triangle of the tissue's surface.
/// Which triangles a tool pushes, where to, and what area and gap mean is written in triangle_contact.hpp;
/// for mesh tools, each part of a triangle is pushed the shortest way out of the tool, unless that would pull
/// the tissue.
struct Contact {
  FaceId face;
  std::vector<WeightedVertex> weights;  ///< of the tissue's contact point on the face's vertices; sum 1
  Eigen::Vector3d point_world;          ///< the contact point on the tissue's surface [m]
  Eigen::Vector3d normal_world;         ///< unit, the direction in which the tool pushes the tissue
  double gap_m = 0;    ///< distance between tool and tissue along the normal, negative in overlap
  double area_m2 = 0;  ///< part of the surface that the contact stands for
};

/// The tissue's boundary faces as patches of about 50 triangles, each a bounding volume tree, in a
/// broad-phase manager.
class TissueSurface {
 public:
  TissueSurface(const PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions);
  ~TissueSurface();
  TissueSurface(TissueSurface&&) noexcept;
  TissueSurface& operator=(TissueSurface&&) noexcept;

  /// Follows a change of the mesh: the touched patches are rebuilt, with these positions of the changed mesh;
  /// all others stay as they were last refitted.
  void update(const PolyhedralMesh& mesh, const MeshChange& change,
              const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

  /// Follows a motion of the vertices.
  void refit(const PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

  /// Contacts with gap < margin_m, in a reproducible order (by face, then triangle). positions: those
  /// of every patch, so refit() comes first where vertices have moved.
  std::vector<Contact> findContacts(const PolyhedralMesh& mesh,
                                    const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                    const ToolShape& shape, const Eigen::Isometry3d& T_world_tool,
                                    double margin_m) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace polyscalpel
