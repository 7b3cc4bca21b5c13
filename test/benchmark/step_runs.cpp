// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/step_runs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <malloc.h>

#include "benchmark/timing.hpp"
#ifdef POLYSCALPEL_HAS_BULLET
#include "benchmark/bullet_body.hpp"
#endif

namespace polyscalpel::report {
namespace {

class OurStepper final : public Stepper {
 public:
  OurStepper(const StepBody& body, const SolverConfig& solver)
      : assembly_(body.mesh, body.material, stepElement(body), 0),
        integrator_(stepIntegration(body), solver),
        state_(stepStart(body)),
        drive_(body.drive) {}

  void step() override {
    ++num_steps_;
    if (drive_) drive_(num_steps_, state_.positions);
    result_ = integrator_.step(state_, assembly_, {});
    if (result_.status != SolveStatus::kSolved) throw std::runtime_error(toString(result_.status));
  }
  Eigen::Matrix3Xd positions() const override { return state_.positions; }
  const IntegrationResult& result() const override { return result_; }

 private:
  Assembly assembly_;
  ImplicitEuler integrator_;
  SimulationState state_;
  std::function<void(int, Eigen::Matrix3Xd&)> drive_;
  int num_steps_ = 0;
  IntegrationResult result_;
};

#ifdef POLYSCALPEL_HAS_BULLET
class BulletStepper final : public Stepper {
 public:
  explicit BulletStepper(const StepBody& body)
      : time_step_s_(stepIntegration(body).time_step_s),
        bullet_(retessellate(body.mesh, Retessellation::kFewest),
                Assembly(body.mesh, body.material, ElementConfig(), 0).vertexMasses(), body.fixed,
                body.material, body.gravity_m_s2, BulletSettings()) {}

  void step() override { bullet_.step(time_step_s_); }
  Eigen::Matrix3Xd positions() const override { return bullet_.positions(); }
  const IntegrationResult& result() const override { return result_; }

 private:
  double time_step_s_;
  BulletBody bullet_;
  IntegrationResult result_;
};
#endif

double largestDisplacement(const StepBody& body, const Stepper& stepper) {
  return std::sqrt((stepper.positions() - body.mesh.restPositions()).colwise().squaredNorm().maxCoeff());
}

double heldMemory_mb() {
  const auto held = mallinfo2();
  return 1e-6 * static_cast<double>(held.uordblks + held.hblkhd);
}

SolverKind parseKind(const std::string& name) {
  for (const SolverKind kind : {SolverKind::kAuto, SolverKind::kDirect, SolverKind::kJacobi,
                                SolverKind::kFactor, SolverKind::kAggregates})
    if (name == toString(kind)) return kind;
  throw std::invalid_argument("solver " + name + ": there is none of this name");
}

}  // namespace

StepSolverChoice ours(const std::string& kind, int threads, double tolerance) {
  SolverConfig config;
  config.tolerance = tolerance;
  config.kind = parseKind(kind);
  config.threads = threads;
  // Diagonal blocks leave smooth errors that hardly show in the residual: on beam10k 1e-4 left 2.5e-4.
  if (config.kind == SolverKind::kJacobi) config.tolerance = 1e-5;
  return {kind, threads,
          [config](const StepBody& body) { return std::make_unique<OurStepper>(body, config); }};
}

StepSolverChoice bullet() {
#ifdef POLYSCALPEL_HAS_BULLET
  return {"bullet", 1, [](const StepBody& body) { return std::make_unique<BulletStepper>(body); }};
#else
  return {"bullet", 1, {}};
#endif
}

StepOutcome runSteps(const StepBody& body, const StepSolverChoice& choice, int steps,
                     const GateAnswers& answers, const StepObserver& observe) {
  StepOutcome outcome;
  try {
    const double memory_before = heldMemory_mb();
    const std::unique_ptr<Stepper> stepper = choice.start(body);
    const auto now = choice.threads == 1 ? threadSeconds : wallSeconds;
    std::vector<double> totals, assemblies, solves;
    for (int step = 1; step <= steps; ++step) {
      const double start = now();
      stepper->step();
      const double step_ms = 1e3 * (now() - start);
      if (observe) observe(*stepper);
      const IntegrationResult& result = stepper->result();
      outcome.residual = std::max(outcome.residual, result.relative_residual);
      outcome.fallbacks += result.solver.fallbacks;
      if (step == 1) {
        outcome.first_ms = step_ms;
      } else {
        totals.push_back(step_ms);
        assemblies.push_back(1e3 * result.assembly_s);
        solves.push_back(1e3 * result.solve_s);
        outcome.iterations += static_cast<double>(result.solver.iterations) / (steps - 1);
      }
      for (std::size_t gate = 0; gate < kGateSteps.size(); ++gate) {
        if (step != kGateSteps[gate]) continue;
        const double error = std::abs(largestDisplacement(body, *stepper) / answers[gate] - 1);
        outcome.gate_error = std::max(outcome.gate_error, error);
      }
    }
    outcome.memory_mb = heldMemory_mb() - memory_before;
    outcome.step_ms = median(totals);
    outcome.assembly_ms = median(assemblies);
    outcome.solve_ms = median(solves);
    outcome.solver = stepper->result().solver;
  } catch (const std::runtime_error& error) {
    outcome.failure = error.what();
  }
  return outcome;
}

GateAnswers gateAnswers(const StepBody& body, int steps) {
  if (body.answers) return *body.answers;
  constexpr double kLargestResidual = 1e-10;
  GateAnswers answers;
  answers.fill(std::numeric_limits<double>::quiet_NaN());
  const std::unique_ptr<Stepper> stepper = ours("direct").start(body);
  for (int step = 1; step <= std::min(steps, kGateSteps.back()); ++step) {
    stepper->step();
    if (stepper->result().relative_residual > kLargestResidual)
      throw std::runtime_error(body.name + ": the direct solver's residual is above 1e-10");
    for (std::size_t gate = 0; gate < kGateSteps.size(); ++gate)
      if (step == kGateSteps[gate]) answers[gate] = largestDisplacement(body, *stepper);
  }
  return answers;
}

StepOutcome medianOutcome(const std::vector<StepOutcome>& outcomes) {
  StepOutcome middle = outcomes.front();
  for (const StepOutcome& outcome : outcomes) {
    if (!outcome.failure.empty()) return outcome;
  }
  for (double StepOutcome::*value :
       {&StepOutcome::step_ms, &StepOutcome::first_ms, &StepOutcome::assembly_ms, &StepOutcome::solve_ms}) {
    std::vector<double> values;
    for (const StepOutcome& outcome : outcomes) values.push_back(outcome.*value);
    middle.*value = median(std::move(values));
  }
  return middle;
}

}  // namespace polyscalpel::report
