// SPDX-License-Identifier: BSD-3-Clause
//
// Many random cuts of every kind over several bodies, and what they did to the meshes. Fixed seeds: a row is
// the same in every run.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "support/torture_cuts.hpp"

namespace polyscalpel {

/// Sums over all cuts of one kind through one kind of body.
struct TortureRow {
  std::string mesh;
  std::string kind;
  int cuts = 0;
  int splits = 0;
  int left_whole = 0;
  int invalid = 0;                ///< cuts after which an invariant did not hold
  int pieces_missing = 0;         ///< parts thicker than the snap distance that still hang together
  int pieces_torn = 0;            ///< parts that no cut separates and that are apart
  double volume_error = 0;        ///< largest, relative to the whole body
  double shortest_edge = 1;       ///< rest length by local size
  double shortest_part = 1;       ///< the same, of the edges that cuts divided
  double piece_volume_error = 0;  ///< largest, see PlaneComparison
};

/// A body to torture.
struct TortureSubject {
  std::string name;
  std::function<PolyhedralMesh()> make;
  bool is_convex = false;
};

enum class TortureSize {
  kSmall,  ///< 27 to 320 cells: many cuts a second, and a surface everywhere near
  kUsual,  ///< 64 to 1,080 cells
};

/// A block of hexahedra, a beam and a ball of tetrahedra; with a path also the volume mesh in that file,
/// which is called "bunny".
std::vector<TortureSubject> tortureSubjects(TortureSize size, const std::string& bunny_mesh = "");

/// A failed cut, to be found again: the body is the subject's with this seed.
struct TortureFailure {
  std::string mesh;
  std::string kind;
  unsigned seed = 0;
  int cut = 0;  ///< of this body, counted from 1
  std::string what;
};

struct TorturePlan {
  int bodies = 1;                  ///< fresh bodies of each subject
  int cuts_per_body = 25;          ///< they accumulate
  unsigned first_seed = 1;         ///< of the first body, one more for each other
  std::vector<std::string> kinds;  ///< names; empty for all
  bool may_deform = true;          ///< whether some cuts go through a deformed body
};

/// Gives one cut after the other, kinds in a random order, each kind once before any comes again.
class TortureSequence {
 public:
  /// Throws std::invalid_argument for the name of a kind that does not exist.
  TortureSequence(const TorturePlan& plan, unsigned seed);

  /// The next cut for the body as it is now.
  const TortureCut& next(const TortureBody& body);

 private:
  TortureRandom random_;
  std::vector<TortureKind> kinds_;
  bool may_deform_ = true;
  std::vector<std::size_t> order_;  // of the kinds still to come, from the back
  std::optional<TortureCut> last_;
};

/// Cuts one fresh body again and again; ends early where a mesh is no longer valid. Adds to `rows`, which
/// hold one a kind, in the order of tortureKinds().
void tortureOne(const TortureSubject& subject, const TorturePlan& plan, unsigned seed,
                std::vector<TortureRow>& rows, std::vector<TortureFailure>& failures);

/// Adds what one row counted to another.
void addTortureRow(const TortureRow& row, TortureRow& sum);

/// Empty rows for all kinds.
std::vector<TortureRow> emptyTortureRows(const std::string& mesh);

/// Rows of the plan's kinds through one subject.
std::vector<TortureRow> torture(const TortureSubject& subject, const TorturePlan& plan,
                                std::vector<TortureFailure>& failures);

/// The same for one body of the subject of this name.
std::vector<TortureRow> torture(TortureSize size, const std::string& name, unsigned seed, int num_cuts,
                                std::vector<TortureFailure>& failures);

}  // namespace polyscalpel
