// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/cell_mechanics.hpp"

#include <Eigen/Geometry>

#include "polyscalpel/elements/corotation.hpp"
#include "stress_tensors.hpp"

namespace polyscalpel {
namespace {

/// work.warped = d, work.stabilising = S^ d, in their first columns.
void warp(const Stabilisation& stabilisation, const Eigen::Matrix3d& R,
          const Eigen::Ref<const Eigen::Matrix3Xd>& positions, CellWorkspace& work) {
  const Eigen::Index m = stabilisation.numModes();
  auto modes = work.modes.leftCols(m);
  modes = positions.lazyProduct(stabilisation.modes);
  work.warped.leftCols(m) = R.transpose().lazyProduct(modes);
  work.warped.leftCols(m) -= stabilisation.rest_modes;
  const Eigen::Map<const Eigen::VectorXd> d(work.warped.data(), 3 * m);
  Eigen::Map<Eigen::VectorXd>(work.stabilising.data(), 3 * m) = stabilisation.stiffness.lazyProduct(d);
}

/// sum_k (R^T x H)_k x (S^ d)_k: what turning the frame does to the stabilising energy.
Eigen::Vector3d stabilisingTorque(const Stabilisation& stabilisation, const CellWorkspace& work) {
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < stabilisation.numModes(); ++k) {
    const Eigen::Vector3d y = work.warped.col(k) + stabilisation.rest_modes.col(k);
    torque += y.cross(Eigen::Vector3d(work.stabilising.col(k)));
  }
  return torque;
}

/// Adds d/dx of R (f H_i + c x g_i), f = S^ d, c = -T tau, T the turn of the rotation, column by column:
/// moving vertex j by v in the cell's frame turns that by w = T (g_j x v), and with y = R^T x H
///   dy_k = H_jk v - w x y_k,  df = S^ dy,  dtau = sum dy_k x f_k + y_k x df_k,
///   dU = v g_j^T - [w]_x U,  dc = -T (dtau + (tr(dU) I - dU) c).
void addStabilisingTangent(const CellView& cell, const Eigen::Matrix3d& F, const Eigen::Matrix3d& R,
                           const Eigen::Ref<const Eigen::Matrix3Xd>& positions, Eigen::MatrixXd& tangent) {
  const Stabilisation& stabilisation = *cell.stabilisation;
  const Eigen::Index n = positions.cols(), m = stabilisation.numModes();
  CellWorkspace work(static_cast<int>(n));
  warp(stabilisation, R, positions, work);
  const Eigen::Matrix3d U = symmetricPart(R.transpose() * F);
  const TurnOfRotation turn(U);
  const Eigen::Matrix3Xd y = work.warped.leftCols(m) + stabilisation.rest_modes,
                         f = work.stabilising.leftCols(m);
  const Eigen::Matrix3Xd f_at_vertices = f * stabilisation.modes.transpose();
  const Eigen::Vector3d c = -turn(stabilisingTorque(stabilisation, work));
  Eigen::Matrix3Xd dy(3, m), df(3, m), df_at_vertices(3, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d v = R.row(k).transpose(), g_j = cell.mean_gradient.col(j);
      const Eigen::Vector3d w = turn(g_j.cross(v));
      for (Eigen::Index i = 0; i < m; ++i)
        dy.col(i) = stabilisation.modes(j, i) * v - w.cross(Eigen::Vector3d(y.col(i)));
      df = (stabilisation.stiffness * dy.reshaped()).reshaped(3, m);
      df_at_vertices = df * stabilisation.modes.transpose();
      Eigen::Vector3d dtau = Eigen::Vector3d::Zero();
      for (Eigen::Index i = 0; i < m; ++i) {
        dtau += dy.col(i).cross(f.col(i)) + y.col(i).cross(df.col(i));
      }
      Eigen::Matrix3d dU = v * g_j.transpose();
      for (int column = 0; column < 3; ++column) dU.col(column) -= w.cross(Eigen::Vector3d(U.col(column)));
      const Eigen::Vector3d dc = -turn(dtau + dU.trace() * c - dU * c);
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Vector3d g = cell.mean_gradient.col(i), force = f_at_vertices.col(i) + c.cross(g);
        tangent.col(3 * j + k).segment<3>(3 * i) +=
            R * (w.cross(force) + df_at_vertices.col(i) + dc.cross(g));
      }
    }
  }
}

}  // namespace

CellLinearisation linearise(const StrainMeasure& measure, const CellView& cell,
                            const Eigen::Ref<const Eigen::Matrix3Xd>& positions, bool exact_force,
                            CellWorkspace& work) {
  const Eigen::Matrix3d F = meanDeformationGradient(positions, cell.mean_gradient);
  CellLinearisation result;
  result.R = measure.rotation(F);
  result.mean = measure.linearise(F, result.R, cell.moduli);
  if (!cell.stabilisation || !exact_force || !measure.rotates()) return result;
  warp(*cell.stabilisation, result.R, positions, work);
  const TurnOfRotation turn(result.R.transpose() * F);
  result.spin = -turn(stabilisingTorque(*cell.stabilisation, work));
  return result;
}

void addForces(const CellLinearisation& linearisation, const CellView& cell,
               const Eigen::Ref<const Eigen::Matrix3Xd>& positions, CellWorkspace& work,
               Eigen::Ref<Eigen::Matrix3Xd> forces) {
  const MeanLinearisation& mean = linearisation.mean;
  const Eigen::Matrix3d change =
      meanDeformationGradient(positions, cell.mean_gradient) - mean.reference_gradient;
  const Eigen::Matrix3d D = mean.A.transpose() * change;
  Eigen::Matrix3d stress = cell.moduli.mu_pa * (D + D.transpose());
  stress.diagonal().array() += cell.moduli.lambda_pa * D.trace();
  stress = mean.A * stress + change * mean.S + mean.reference_stress;
  stress *= cell.volume;
  if (!cell.stabilisation) {
    forces.noalias() += stress * cell.mean_gradient;
    return;
  }
  const Stabilisation& stabilisation = *cell.stabilisation;
  const Eigen::Matrix3d& R = linearisation.R;
  const Eigen::Vector3d& c = linearisation.spin;
  Eigen::Matrix3d spin;  // [c]_x
  spin << 0, -c.z(), c.y(), c.z(), 0, -c.x(), -c.y(), c.x(), 0;
  stress.noalias() += R * spin;
  forces.noalias() += stress * cell.mean_gradient;
  warp(stabilisation, R, positions, work);
  const Eigen::Index m = stabilisation.numModes();
  work.modes.leftCols(m) = R.lazyProduct(work.stabilising.leftCols(m));
  forces += work.modes.leftCols(m).lazyProduct(stabilisation.modes.transpose());
}

double elasticEnergy(const StrainMeasure& measure, const CellView& cell,
                     const Eigen::Ref<const Eigen::Matrix3Xd>& positions, CellWorkspace& work) {
  const Eigen::Matrix3d F = meanDeformationGradient(positions, cell.mean_gradient);
  const Eigen::Matrix3d R = measure.rotation(F);
  double energy = cell.volume * measure.energyDensity(F, R, cell.moduli);
  if (cell.stabilisation) {
    warp(*cell.stabilisation, R, positions, work);
    for (Eigen::Index k = 0; k < cell.stabilisation->numModes(); ++k) {
      energy += 0.5 * work.warped.col(k).dot(work.stabilising.col(k));
    }
  }
  return energy;
}

Eigen::MatrixXd exactTangent(const StrainMeasure& measure, const CellView& cell,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  const Eigen::Index n = positions.cols();
  const Eigen::Matrix3d F = meanDeformationGradient(positions, cell.mean_gradient);
  const Eigen::Matrix3d R = measure.rotation(F);
  const StressTangent stress_tangent = cell.volume * measure.exactTangent(F, R, cell.moduli);
  Eigen::MatrixXd tangent(3 * n, 3 * n);
  for (Eigen::Index b = 0; b < n; ++b) {
    Eigen::Matrix<double, 9, 3> moved = Eigen::Matrix<double, 9, 3>::Zero();  // dP for moves of vertex b
    for (int l = 0; l < 3; ++l) moved += stress_tangent.middleCols<3>(3 * l) * cell.mean_gradient(l, b);
    for (Eigen::Index a = 0; a < n; ++a) {
      Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) block += moved.middleRows<3>(3 * k) * cell.mean_gradient(k, a);
      tangent.block<3, 3>(3 * a, 3 * b) = block;
    }
  }
  if (cell.stabilisation) {
    if (measure.rotates()) {
      addStabilisingTangent(cell, F, R, positions, tangent);
    } else {
      tangent += cell.stabilisation->matrix();
    }
  }
  return tangent;
}

}  // namespace polyscalpel
