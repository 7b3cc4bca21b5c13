// SPDX-License-Identifier: BSD-3-Clause
#include "support/torture.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/mesh_io.hpp"

namespace polyscalpel {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

void add(const TortureOutcome& outcome, TortureRow& row) {
  TortureRow one;
  one.cuts = 1;
  one.splits = outcome.splits;
  one.left_whole = outcome.left_whole;
  one.invalid = !outcome.violations.empty();
  one.pieces_missing = outcome.pieces_missing;
  one.pieces_torn = outcome.pieces_torn;
  if (outcome.violations.empty()) {
    one.volume_error = std::abs(outcome.volume_error);
    one.shortest_edge = outcome.shortest_edge;
    one.shortest_part = outcome.shortest_part;
    one.piece_volume_error = outcome.piece_volume_error;
  }
  addTortureRow(one, row);
}

std::string describe(const TortureOutcome& outcome) {
  std::string what;
  if (!outcome.violations.empty())
    what += std::to_string(outcome.violations.size()) + " violations, first: " + outcome.violations.front() +
            "; ";
  if (outcome.pieces_missing > 0) what += std::to_string(outcome.pieces_missing) + " pieces missing; ";
  if (outcome.pieces_torn > 0) what += std::to_string(outcome.pieces_torn) + " pieces torn; ";
  if (outcome.left_whole > 0) what += std::to_string(outcome.left_whole) + " left whole; ";
  return what;
}

}  // namespace

std::vector<TortureSubject> tortureSubjects(TortureSize size, const std::string& bunny_mesh) {
  const bool is_small = size == TortureSize::kSmall;
  const Vector3i block = Vector3i::Constant(is_small ? 3 : 4),
                 beam = is_small ? Vector3i(6, 2, 2) : Vector3i(12, 3, 3);
  const int ball = is_small ? 2 : 3;
  std::vector<TortureSubject> subjects = {
      {"block", [=] { return makeHexBox(Vector3d::Zero(), Vector3d::Ones(), block); }, true},
      {"beam", [=] { return makeTetBox(Vector3d::Zero(), Vector3d(2, 0.5, 0.5), beam); }, true},
      {"ball", [=] { return makeTetBall(Vector3d::Zero(), 1, ball); }, false}};
  if (!bunny_mesh.empty())
    subjects.push_back({"bunny", [=] { return readMesh(MeshFileConfig{bunny_mesh, 1, 0}).mesh; }, false});
  return subjects;
}

TortureSequence::TortureSequence(const TorturePlan& plan, unsigned seed)
    : random_(seed), may_deform_(plan.may_deform) {
  for (const std::string& name : plan.kinds) {
    const auto& all = tortureKinds();
    const auto kind = std::find_if(all.begin(), all.end(), [&](const auto& k) { return k.name == name; });
    if (kind == all.end()) throw std::invalid_argument("torture: no kind is called " + name);
    kinds_.push_back(*kind);
  }
  if (plan.kinds.empty()) kinds_ = tortureKinds();
}

const TortureCut& TortureSequence::next(const TortureBody& body) {
  if (order_.empty()) {
    order_.resize(kinds_.size());
    std::iota(order_.begin(), order_.end(), 0);
    std::shuffle(order_.begin(), order_.end(), random_);
  }
  const TortureKind& kind = kinds_[order_.back()];
  order_.pop_back();
  const std::optional<TortureCut> before = last_;
  do {
    last_ = makeTortureCut(kind, body, before ? &*before : nullptr, random_);
  } while (last_->deformation && !may_deform_);
  return *last_;
}

void tortureOne(const TortureSubject& subject, const TorturePlan& plan, unsigned seed,
                std::vector<TortureRow>& rows, std::vector<TortureFailure>& failures) {
  TortureSequence sequence(plan, seed);
  TortureBody body(subject.name, subject.make(), subject.is_convex);
  for (int i = 0; i < plan.cuts_per_body; ++i) {
    const TortureCut& cut = sequence.next(body);
    const TortureOutcome outcome = body.apply(cut, CuttingConfig());
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const TortureRow& r) { return r.kind == cut.kind; });
    add(outcome, *row);
    if (const std::string what = describe(outcome); !what.empty())
      failures.push_back({subject.name, cut.kind, seed, i + 1, what});
    if (!outcome.violations.empty()) return;
  }
}

void addTortureRow(const TortureRow& row, TortureRow& sum) {
  sum.cuts += row.cuts;
  sum.splits += row.splits;
  sum.left_whole += row.left_whole;
  sum.invalid += row.invalid;
  sum.pieces_missing += row.pieces_missing;
  sum.pieces_torn += row.pieces_torn;
  sum.volume_error = std::max(sum.volume_error, row.volume_error);
  sum.shortest_edge = std::min(sum.shortest_edge, row.shortest_edge);
  sum.shortest_part = std::min(sum.shortest_part, row.shortest_part);
  sum.piece_volume_error = std::max(sum.piece_volume_error, row.piece_volume_error);
}

std::vector<TortureRow> emptyTortureRows(const std::string& mesh) {
  std::vector<TortureRow> rows;
  for (const TortureKind& kind : tortureKinds()) {
    TortureRow row;
    row.mesh = mesh;
    row.kind = kind.name;
    rows.push_back(row);
  }
  return rows;
}

std::vector<TortureRow> torture(const TortureSubject& subject, const TorturePlan& plan,
                                std::vector<TortureFailure>& failures) {
  std::vector<TortureRow> rows = emptyTortureRows(subject.name);
  for (int i = 0; i < plan.bodies; ++i) tortureOne(subject, plan, plan.first_seed + i, rows, failures);
  rows.erase(std::remove_if(rows.begin(), rows.end(), [](const TortureRow& row) { return row.cuts == 0; }),
             rows.end());
  return rows;
}

std::vector<TortureRow> torture(TortureSize size, const std::string& name, unsigned seed, int num_cuts,
                                std::vector<TortureFailure>& failures) {
  for (const TortureSubject& subject : tortureSubjects(size)) {
    if (subject.name != name) continue;
    TorturePlan plan;
    plan.first_seed = seed;
    plan.cuts_per_body = num_cuts;
    return torture(subject, plan, failures);
  }
  throw std::invalid_argument("no body to torture is called " + name);
}

}  // namespace polyscalpel
