// SPDX-License-Identifier: BSD-3-Clause
//
// Times of single stages, by Google Benchmark: polyscalpel_bench [--meshes folder] [--commit name] [options
// of Google Benchmark]. Each row is repeated, and its median counts.
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmark/bench_meshes.hpp"
#include "benchmark/bench_rows.hpp"

namespace {

/// Takes an option of ours and its value out of the arguments; `otherwise` where it is not given.
std::string takeOption(std::vector<char*>& arguments, const std::string& name, const std::string& otherwise) {
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    if (arguments[i] != name) continue;
    if (i + 1 == arguments.size()) throw std::invalid_argument(name + ": a value must follow");
    const std::string value = arguments[i + 1];
    arguments.erase(arguments.begin() + i, arguments.begin() + i + 2);
    return value;
  }
  return otherwise;
}

std::string cpuModel() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<char*> arguments(argv, argv + argc);
  const char* const folder = std::getenv("POLYSCALPEL_TEST_MESHES");
  const std::string meshes = takeOption(arguments, "--meshes", folder ? folder : "");
  benchmark::AddCustomContext("commit", takeOption(arguments, "--commit", "unknown"));
  benchmark::AddCustomContext("cpu", cpuModel());
  benchmark::AddCustomContext("compiler", std::string("g++ ") + __VERSION__);

  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 1;
  polyscalpel::bench::registerCutting(polyscalpel::bench::benchMeshes(meshes));
  polyscalpel::bench::registerSteps(meshes);
  polyscalpel::bench::registerStepStages(meshes);
  polyscalpel::bench::registerStepsAfterCuts(meshes);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
