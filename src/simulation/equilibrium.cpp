// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "contact_terms.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/stage_timer.hpp"
#include "polyscalpel/simulation/loose_piece.hpp"

namespace polyscalpel {
namespace {

/// Part of the slope that a step has to gain (Armijo's rule).
constexpr double kSufficientDecrease = 1e-4;
constexpr int kMostHalvings = 40;
/// A gain expected below this part of the potential drowns in its rounding.
constexpr double kPotentialRounding = 1e-11;
/// A step of no vertex longer than this, in body sizes, is rounding: the equilibrium is as good as numbers
/// allow, also where there is no force to compare the residual with.
constexpr double kShortestStep = 1e-12;

class NewtonSearch {
 public:
  NewtonSearch(Assembly& assembly, const std::vector<bool>& fixed,
               const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
               const std::vector<LinearisedContact>& contacts, const IntegrationConfig& config,
               EquilibriumResult& result)
      : assembly_(assembly),
        fixed_(fixed),
        forces_(forces),
        contacts_(contacts),
        config_(config),
        result_(result),
        acts_(contacts.size(), true) {}

  /// Whether it converged, with x then at the equilibrium of the contacts that act.
  bool run(Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& start);
  /// Sets the contacts' forces at the displacements x - start, and lets go of those that pull if it may;
  /// whether it did.
  bool releasePulling(const Eigen::Matrix3Xd& displacements, bool may_release);

 private:
  void setResidual(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& start);
  bool factorise(const Eigen::Matrix3Xd& x);
  bool descend(Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& start);
  double potential(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& start) const;
  Eigen::Vector3d forceOf(std::size_t contact, const Eigen::Matrix3Xd& displacements) const {
    return contactForce(contacts_[contact],
                        atContact(contacts_[contact].contact, displacements) / config_.time_step_s);
  }
  SolveStatus factorise(const Blocks& blocks) {
    const StageTimer timer(result_.solve_s);
    return solver_.factorise(assembly_.pattern(), blocks);
  }
  void addContacts(Blocks& matrix) const {
    for (std::size_t c = 0; c < contacts_.size(); ++c) {
      if (acts_[c]) addContactMatrix(contacts_[c], 1 / config_.time_step_s, assembly_.pattern(), matrix);
    }
  }
  bool fail(const std::string& why) {
    result_.message = why;
    return false;
  }

  Assembly& assembly_;
  const std::vector<bool>& fixed_;
  const Eigen::Ref<const Eigen::Matrix3Xd> forces_;
  const std::vector<LinearisedContact>& contacts_;
  const IntegrationConfig& config_;
  EquilibriumResult& result_;
  std::vector<bool> acts_;

  DirectSolver solver_;
  bool is_analysed_ = false;
  bool matrix_stands_ = false;  // the factor is that of a constant stiffness and of the contacts that act
  Blocks matrix_;
  Eigen::Matrix3Xd residual_, step_, trial_;
  double residual_norm_ = 0;
  double force_scale_ = 0;
};

/// residual = f + contacts - f_int, zero at fixed vertices.
void NewtonSearch::setResidual(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& start) {
  const StageTimer timer(result_.assembly_s);
  assembly_.linearise(x);
  Eigen::Matrix3Xd internal;
  assembly_.internalForces(x, internal);
  Eigen::Matrix3Xd contact_forces = Eigen::Matrix3Xd::Zero(3, x.cols());
  const Eigen::Matrix3Xd displacements = x - start;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (acts_[c]) addAtContact(contacts_[c].contact, forceOf(c, displacements), contact_forces);
  }
  residual_ = forces_ + contact_forces - internal;
  double applied = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if (fixed_[i]) {
      residual_.col(i).setZero();
    } else {
      applied += forces_.col(i).squaredNorm() + contact_forces.col(i).squaredNorm();
    }
  }
  residual_norm_ = residual_.norm();
  force_scale_ = std::max(force_scale_, std::sqrt(applied));
}

double NewtonSearch::potential(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& start) const {
  const Eigen::Matrix3Xd displacements = x - start;
  double potential = assembly_.elasticEnergy(x);
  for (Eigen::Index i = 0; i < x.cols(); ++i) potential -= forces_.col(i).dot(displacements.col(i));
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (!acts_[c]) continue;
    const Eigen::Vector3d way = atContact(contacts_[c].contact, displacements);
    potential += way.dot(0.5 / config_.time_step_s * (contacts_[c].B * way) - contacts_[c].force_0);
  }
  return potential;
}

bool NewtonSearch::factorise(const Eigen::Matrix3Xd& x) {
  if (!is_analysed_) {
    const StageTimer timer(result_.solve_s);
    result_.status = solver_.analyse(assembly_.pattern(), fixed_);
    if (result_.status != SolveStatus::kSolved) return fail(toString(result_.status));
    is_analysed_ = true;
  }
  if (matrix_stands_) return true;
  {
    const StageTimer timer(result_.assembly_s);
    assembly_.assembleExactTangent(x, matrix_);
    addContacts(matrix_);
  }
  result_.status = factorise(matrix_);
  if (result_.status == SolveStatus::kNotPositiveDefinite) {
    ++result_.fallbacks;
    {
      const StageTimer timer(result_.assembly_s);
      assembly_.assemble(0, 1, matrix_);
      addContacts(matrix_);
    }
    result_.status = factorise(matrix_);
  }
  if (result_.status != SolveStatus::kSolved) return fail(toString(result_.status));
  matrix_stands_ = assembly_.hasConstantStiffness();
  return true;
}

/// Goes along step_ until the potential is lower by enough.
bool NewtonSearch::descend(Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& start) {
  const StageTimer timer(result_.assembly_s);
  const double gain = (residual_.array() * step_.array()).sum();
  const double here = potential(x, start);
  double length = 1;
  for (int halving = 0; halving <= kMostHalvings; ++halving, length /= 2) {
    trial_ = x + length * step_;
    const double there = potential(trial_, start);
    const bool drowns = length * gain <= kPotentialRounding * std::abs(here);
    if (there <= here - kSufficientDecrease * length * gain ||
        (drowns && there <= here + kPotentialRounding * std::abs(here))) {
      x.swap(trial_);
      return true;
    }
  }
  return fail("no lower potential along Newton's step");
}

bool NewtonSearch::run(Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& start) {
  setResidual(x, start);
  // A body let go has no force on it but its own.
  force_scale_ = std::max(force_scale_, residual_norm_);
  while (true) {
    result_.relative_residual = force_scale_ > 0 ? residual_norm_ / force_scale_ : 0;
    if (!std::isfinite(residual_norm_)) {
      result_.status = SolveStatus::kNotFinite;
      return fail(toString(result_.status));
    }
    if (result_.relative_residual <= config_.equilibrium_tolerance) return true;
    if (result_.iterations >= config_.equilibrium_iterations) {
      std::ostringstream message;
      message << "no equilibrium after " << result_.iterations << " Newton steps: relative residual "
              << result_.relative_residual << ", asked for " << config_.equilibrium_tolerance;
      return fail(message.str());
    }
    if (!factorise(x)) return false;
    {
      const StageTimer timer(result_.solve_s);
      result_.status = solver_.solve(residual_, step_).status;
    }
    if (result_.status != SolveStatus::kSolved) return fail(toString(result_.status));
    ++result_.iterations;
    const double size = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
    if (step_.cwiseAbs().maxCoeff() <= kShortestStep * size) return true;
    if (!descend(x, start)) return false;
    setResidual(x, start);
  }
}

bool NewtonSearch::releasePulling(const Eigen::Matrix3Xd& displacements, bool may_release) {
  const StageTimer timer(result_.contact_s);
  bool any = false;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    result_.contact_forces[c].setZero();
    if (!acts_[c]) continue;
    result_.contact_forces[c] = forceOf(c, displacements);
    if (!may_release || result_.contact_forces[c].dot(contacts_[c].contact.normal_world) >= 0) continue;
    acts_[c] = false;
    result_.contact_forces[c].setZero();
    any = true;
  }
  if (any) matrix_stands_ = false;
  return any;
}

}  // namespace

EquilibriumResult findEquilibrium(const PolyhedralMesh& mesh, Assembly& assembly,
                                  const std::vector<bool>& fixed,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& forces,
                                  const std::vector<LinearisedContact>& contacts,
                                  const IntegrationConfig& config, Eigen::Matrix3Xd& positions) {
  POLYSCALPEL_ASSERT(positions.cols() == mesh.numVertices() && forces.cols() == mesh.numVertices());
  POLYSCALPEL_ASSERT(assembly.numVertices() == mesh.numVertices());
  POLYSCALPEL_ASSERT(static_cast<int>(fixed.size()) == mesh.numVertices());
  EquilibriumResult result;
  result.contact_forces.assign(contacts.size(), Eigen::Vector3d::Zero());
  result.message = findLoosePiece(mesh, fixed);
  if (!result.message.empty()) {
    result.status = SolveStatus::kNotPositiveDefinite;
    return result;
  }
  const Eigen::Matrix3Xd start = positions;
  Eigen::Matrix3Xd x = positions;
  NewtonSearch search(assembly, fixed, forces, contacts, config, result);
  for (int round = 1;; ++round) {
    if (!search.run(x, start)) return result;
    if (!search.releasePulling(x - start, round < config.contact_iterations)) break;
  }
  result.converged = true;
  positions.swap(x);
  return result;
}

}  // namespace polyscalpel
