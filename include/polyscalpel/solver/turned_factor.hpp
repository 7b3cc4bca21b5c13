// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "polyscalpel/core/difference_matrix.hpp"
#include "polyscalpel/solver/added_vertex.hpp"
#include "polyscalpel/solver/held_factor.hpp"
#include "polyscalpel/solver/preconditioner.hpp"
#include "polyscalpel/solver/single_factor.hpp"

namespace polyscalpel {

/// R A_0^-1 R^T, A_0 the matrix in the rest shape and R the rotation of each vertex: a corotated matrix is
/// near R A_0 R^T, however far the body has bent, so a handful of iterations is left (60 without R on a beam
/// that has swung down). A_0 may as well be that of a shape in which vertices are turned by R_0; R R_0^T then
/// takes the place of R. After cuts that is better: thin parts turn otherwise than the vertices around them.
///
/// After a cut the factor stays what it was. The space of the uncut body lies in that of the cut one, new
/// vertices following their parents by P; what the crack adds is solved for exactly in a patch, the vertices
/// of all cells that the cuts have touched:
///
///   z_1 = S r,  z_2 = z_1 + R P A_0^-1 P^T R^T (r - A z_1),  z = z_2 + S (r - A z_2),
///
/// S the inverse of the patch's own part of A as it was after the last cut, turned as its vertices have
/// since.
///
/// What holds points of the body, contacts, may be far stiffer than the body: A_0 becomes A_0 + P^T R^T J^T k
/// J R P, and the patch's own part is taken anew where it is held.
class TurnedFactor final : public Preconditioner {
 public:
  /// factor: of a matrix of so many vertices. fixed: one flag for each. rotations: R_0, 9 numbers each column
  /// by column; empty: the identity.
  TurnedFactor(SingleFactor factor, const std::vector<bool>& fixed, std::vector<float> rotations = {});

  /// Follows a cut: added vertices in ascending order, and the vertices of all cells that it made or changed.
  void follow(const std::vector<AddedVertex>& added, const std::vector<int>& touched);
  /// Vertices that follow() has been told of, and those that the factor is of.
  int patchSize() const { return static_cast<int>(patch_.size()); }
  int numVertices() const { return num_vertices_; }
  /// Whether there is a patch that another update() than the last one has factored.
  bool hasOldPatch() const { return !patch_active_.empty() && is_patch_old_; }
  /// The next update() factors the patch anew.
  void renewPatch() { is_patch_factored_ = false; }

  /// rotations: 9 a vertex, column by column; active: ascending. All arguments must live on. The first one
  /// after a cut factors the patch. A status other than kSolved: not to be used with this matrix.
  SolveStatus update(const RowPattern& pattern, const DifferenceMatrix<float>& matrix,
                     const std::vector<float>& rotations, const std::vector<int>& active);
  void apply(const float* residual, float* result) override;

 private:
  struct Share {
    int vertex = 0;  // of the factor's
    float weight = 0;
  };
  template <class Visit>
  void forEachShare(int vertex, const Visit& visit) const;
  SolveStatus factorPatch();
  void turnCoarse();
  SolveStatus holdCoarse();
  bool isPatchHeld() const;
  double largestOfPatch();
  void addCoarse(const float* residual, float* result);
  void addPatch(const float* residual, float* result);

  HeldFactor factor_;
  int num_vertices_;              // of the factor
  std::vector<bool> is_fixed_;    // of these
  std::vector<int> first_share_;  // of each vertex beyond them, and one more
  std::vector<Share> shares_;     // P
  std::vector<float> coarse_;     // 3 a vertex of the factor
  std::vector<float> base_;       // R_0, of added vertices their nearer parent's; empty: the identity
  std::vector<float> turns_;      // R R_0^T; unused without R_0
  const float* coarse_turns_ = nullptr;

  std::vector<int> patch_;  // ascending
  bool is_patch_factored_ = true;
  bool is_patch_old_ = false;
  bool was_patch_held_ = false;  // when it was factored
  SingleFactor patch_factor_;
  std::vector<int> patch_active_;       // of these, those in its factor
  std::vector<int> beside_;             // rows that feel the patch; empty: the two are added up
  std::vector<float> patch_rotations_;  // 9 a vertex of patch_active_, when it was factored
  std::vector<float> patch_values_, moved_, left_;

  const RowPattern* pattern_ = nullptr;
  const DifferenceMatrix<float>* matrix_ = nullptr;
  const float* rotations_ = nullptr;
  const std::vector<int>* active_ = nullptr;
};

}  // namespace polyscalpel
