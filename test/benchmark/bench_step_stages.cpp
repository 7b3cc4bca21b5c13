// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include <benchmark/benchmark.h>

#include "benchmark/bench_rows.hpp"
#include "benchmark/step_stages.hpp"

namespace polyscalpel::bench {
namespace {

using report::BentBody;
using report::StepBody;
using report::StepSubject;

constexpr int kRepetitions = 5;

void assemblyRow(benchmark::State& state, const StepBody& body) {
  BentBody bent(body);
  for (auto _ : state) {
    bent.linearise();
    bent.assemble();
  }
  state.SetItemsProcessed(state.iterations() * body.mesh.numCells());
}

void productRow(benchmark::State& state, const StepBody& body) {
  BentBody bent(body);
  for (auto _ : state) bent.multiply();
  state.SetBytesProcessed(state.iterations() *
                          static_cast<std::int64_t>(report::productTraffic(bent).moved_bytes));
}

void preconditionRow(benchmark::State& state, const StepBody& body, const std::string& solver) {
  BentBody bent(body);
  const std::unique_ptr<Preconditioner> made = report::makePreconditioner(solver, bent);
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
