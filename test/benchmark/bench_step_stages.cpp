// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <random>
#include <stdexcept>

#include <benchmark/benchmark.h>

#include "benchmark/bench_rows.hpp"
#include "benchmark/step_runs.hpp"
#include "polyscalpel/solver/aggregates.hpp"
#include "polyscalpel/solver/block_jacobi.hpp"
#include "polyscalpel/solver/turned_factor.hpp"

namespace polyscalpel::bench {
namespace {

using report::StepBody;
using report::StepSubject;

constexpr int kRepetitions = 5;
constexpr int kStepsToBend = 10;

/// A body in a bent shape, with its matrix in single precision and its rest matrix.
struct BentBody {
  explicit BentBody(const StepBody& body)
      : assembly(body.mesh, body.material, report::stepElement(body), 0), state(report::stepStart(body)) {
    const double h = report::stepIntegration(body).time_step_s;
    stiffness_scale = h * h;
    SolverConfig solver;
    solver.kind = SolverKind::kAggregates;
    ImplicitEuler integrator(report::stepIntegration(body), solver);
    for (int i = 0; i < kStepsToBend; ++i) {
      if (integrator.step(state, assembly, {}).status != SolveStatus::kSolved)
        throw std::runtime_error("a step to bend the body failed");
    }
    ahead = state.positions + h * state.velocities;
    for (int i = 0; i < body.mesh.numVertices(); ++i)
      if (!body.fixed[i]) active.push_back(i);
    corotated().assembleAtRest(assembly.vertexMasses(), 1, stiffness_scale, {}, rest_matrix);
    assemble();
    corotated().vertexRotations(rotations);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(-1, 1);
    x.setZero(paddedSize(body.mesh.numVertices()));
    for (const int i : active)
      for (int c = 0; c < 3; ++c) x[3 * i + c] = uniform(random);
    y = x;
  }

  CorotatedBody& corotated() { return *assembly.corotatedBody(); }

  void assemble() {
    assembly.lineariseWithForces(state.positions, ahead, forces);
    corotated().assemble(assembly.vertexMasses(), 1, stiffness_scale, matrix);
  }

  Assembly assembly;
  SimulationState state;
  double stiffness_scale = 0;
  Eigen::Matrix3Xd ahead, forces;
  DifferenceMatrix<float> matrix;
  DifferenceMatrix<double> rest_matrix;
  std::vector<int> active;
  std::vector<float> rotations;
  Eigen::VectorXf x, y;
};

void assemblyRow(benchmark::State& state, const StepBody& body) {
  BentBody bent(body);
  for (auto _ : state) bent.assemble();
  state.SetItemsProcessed(state.iterations() * body.mesh.numCells());
}

void productRow(benchmark::State& state, const StepBody& body) {
  BentBody bent(body);
  const RowPattern& pattern = bent.corotated().pattern();
  for (auto _ : state) multiply(pattern, bent.matrix, bent.active, bent.x.data(), bent.y.data());
  // Each block and its column once, x once, y once.
  std::int64_t entries = 0;
  for (const int i : bent.active) entries += pattern.rows[i].count;
  const auto vertices = static_cast<std::int64_t>(bent.active.size());
  state.SetBytesProcessed(state.iterations() * (entries * (36 + 4) + vertices * (24 + 4)));
}

std::unique_ptr<Preconditioner> makePreconditioner(const std::string& solver, const StepBody& body,
                                                   BentBody& bent) {
  const RowPattern& pattern = bent.corotated().pattern();
  if (solver == "jacobi") {
    auto made = std::make_unique<BlockJacobi>();
    made->update(pattern, bent.matrix, bent.active, 1);
    return made;
  }
  if (solver == "aggregates") {
    auto made = std::make_unique<AggregatePreconditioner>();
    if (made->make(pattern, bent.rest_matrix, body.mesh.restPositions(), bent.active) != SolveStatus::kSolved)
      return nullptr;
    made->update(pattern, bent.matrix, bent.active, bent.rotations, 1);
    return made;
  }
  const BlockPattern block_pattern = toBlockPattern(pattern);
  Blocks blocks;
  convert(pattern, bent.rest_matrix, block_pattern, blocks);
  SingleFactor factor;
  if (factor.factorise(block_pattern, blocks, body.fixed) != SolveStatus::kSolved) return nullptr;
  auto made = std::make_unique<TurnedFactor>(std::move(factor), body.fixed);
  if (made->update(pattern, bent.matrix, bent.rotations, bent.active) != SolveStatus::kSolved) return nullptr;
  return made;
}

void preconditionRow(benchmark::State& state, const StepBody& body, const std::string& solver) {
  BentBody bent(body);
  const std::unique_ptr<Preconditioner> made = makePreconditioner(solver, body, bent);
  if (!made) {
    state.SkipWithError("the factor failed");
    return;
  }
  for (auto _ : state) made->apply(bent.x.data(), bent.y.data());
}

template <class Row>
void registerRow(const std::string& name, const StepSubject& subject, const Row& row) {
  if (!subject.make) {
    reportMissing(name, subject.missing);
    return;
  }
  const auto run = [subject, row](benchmark::State& state) { row(state, subject.make()); };
  benchmark::RegisterBenchmark(name.c_str(), run)
      ->Unit(benchmark::kMillisecond)
      ->Repetitions(kRepetitions)
      ->ReportAggregatesOnly();
}

}  // namespace

void registerStepStages(const std::string& folder) {
  for (const StepSubject& subject : stepSubjects(folder)) {
    registerRow("assembly/" + subject.name, subject, assemblyRow);
    registerRow("matvec/" + subject.name, subject, productRow);
    for (const std::string solver : {"factor", "aggregates", "jacobi"}) {
      registerRow("precondition/" + subject.name + "/" + solver, subject,
                  [solver](auto& state, const StepBody& body) { preconditionRow(state, body, solver); });
    }
  }
}

}  // namespace polyscalpel::bench
