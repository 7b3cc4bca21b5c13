// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <thread>

#include <benchmark/benchmark.h>
#include <malloc.h>

#include "benchmark/bench_cuts.hpp"
#include "benchmark/bench_rows.hpp"
#include "benchmark/timing.hpp"
#include "polyscalpel/collision/contact_detection.hpp"
#include "polyscalpel/cutting/blade_sweep.hpp"
#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/elements/element_formulation.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel::bench {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using report::median;

constexpr int kRepetitions = 15;

/// Seconds of this thread's own work since it was made or last asked: on a machine that others use too, the
/// wall clock tells how busy they are.
class StopWatch {
 public:
  double lap() {
    const double now = report::threadSeconds();
    const double seconds = now - last_;
    last_ = now;
    return seconds;
  }

 private:
  double last_ = report::threadSeconds();
};

/// How the matrices of cells are made.
struct Matrices {
  const char* suffix;  // of a row's name
  int quadrature_points;
  int num_threads;
};

constexpr Matrices kMatrices[] = {{"", 1, 1}, {"_4_points", 4, 2}};

/// Everything beside a mesh that a cut refreshes, but the assembled system.
class Body {
 public:
  Body(const PolyhedralMesh& rest, const Matrices& matrices)
      : mesh(rest),
        positions(rest.restPositions()),
        index(mesh),
        surface(mesh, positions),
        formulation_(withPoints(matrices.quadrature_points)),
        num_threads_(matrices.num_threads) {
    index.tree.fit(mesh, positions);
  }

  /// Matrices of the new and changed cells and the collision surface. Returns the seconds of each: those of
  /// the thread that takes longest.
  std::pair<double, double> follow(const MeshChange& change) {
    StopWatch watch;
    extendByNewVertices(change.new_vertices, positions);
    std::vector<CellId> cells = change.changed_cells;
    for (const NewCell& cell : change.new_cells) cells.push_back(cell.cell);
    const auto make = [&](std::size_t first, std::size_t step) {
      for (std::size_t i = first; i < cells.size(); i += step) {
        benchmark::DoNotOptimize(
            formulation_.makeMatrices(makeCellSurface(mesh, cells[i], mesh.restPositions()), {}));
      }
    };
    double helper_s = 0;
    // As Assembly::update() does it.
    if (num_threads_ == 1 || cells.size() < kFewCells) {
      make(0, 1);
    } else {
      std::thread helper([&] {
        StopWatch helper_watch;
        make(1, 2);
        helper_s = helper_watch.lap();
      });
      make(0, 2);
      helper.join();
    }
    const double matrices_s = std::max(watch.lap(), helper_s);
    surface.update(mesh, change, positions);
    return {matrices_s, watch.lap()};
  }

  PolyhedralMesh mesh;
  Matrix3Xd positions;
  MeshIndex index;
  TissueSurface surface;

 private:
  static constexpr std::size_t kFewCells = 32;

  static ElementConfig withPoints(int count) {
    ElementConfig config;
    config.quadrature_points = count;
    return config;
  }
  CellFormulation formulation_;
  int num_threads_;
};

void halfPlaneRow(benchmark::State& state, const PolyhedralMesh& rest, const Matrices& how) {
  const PolygonCut cut = halfPlane(rest.restPositions());
  double cut_s = 0, matrices_s = 0, surface_s = 0;
  for (auto _ : state) {
    Body body(rest, how);
    StopWatch watch;
    const CutResult result = cutMesh(body.mesh, body.positions, cut, {}, 1, &body.index);
    cut_s = watch.lap();
    std::tie(matrices_s, surface_s) = body.follow(result.change);
    state.SetIterationTime(cut_s + matrices_s + surface_s);
    state.counters["cells"] = rest.numCells();
    state.counters["cells_split"] = result.cells_split;
    state.counters["pieces"] = result.pieces_after;
  }
  state.counters["cut_ms"] = 1e3 * cut_s;
  state.counters["matrices_ms"] = 1e3 * matrices_s;
  state.counters["surface_ms"] = 1e3 * surface_s;
}

/// A short blade is drawn level through the top of the body, in steps of so many local sizes; the row's time
/// is the median of its steps that split something.
void progressiveRow(benchmark::State& state, const PolyhedralMesh& rest, double step_in_sizes,
                    const Matrices& how) {
  const Eigen::AlignedBox3d box = boxOf(rest.restPositions());
  const Vector3d centre = box.center(), half = 0.5 * box.sizes();
  const double h = medianSize(rest);
  Matrix3Xd edge(3, 2);
  edge << 0, 0, 0, 0.05 * h, -2.5 * h, 2.5 * h;
  const double step = step_in_sizes * h;
  const int num_steps = static_cast<int>(2.4 * half.x() / step);
  const auto pose = [&](int i) {
    Isometry3d T = Isometry3d::Identity();
    T.translation() = centre + Vector3d(-1.2 * half.x() + i * step, 0.31 * h, half.z() - 4.1 * h);
    return T;
  };
  for (auto _ : state) {
    Body body(rest, how);
    BladeCut blade(edge, {});
    std::vector<double> totals, cuts, matrices, surfaces, untouched, splits, touched;
    for (int i = 0; i < num_steps; ++i) {
      StopWatch watch;
      body.index.tree.fit(body.mesh, body.positions);
      const CutResult result =
          blade.advance(body.mesh, body.positions, body.positions, pose(i), pose(i + 1), 1, &body.index);
      const double cut_s = watch.lap();
      if (result.status != CutStatus::kCut) {
        untouched.push_back(cut_s);
        continue;
      }
      const auto [matrices_s, surface_s] = body.follow(result.change);
      cuts.push_back(cut_s);
      matrices.push_back(matrices_s);
      surfaces.push_back(surface_s);
      totals.push_back(cut_s + matrices_s + surface_s);
      splits.push_back(result.cells_split);
      touched.push_back(result.change.removed_cells.size() + result.change.changed_cells.size());
    }
    if (totals.empty() || untouched.empty()) {
      state.SkipWithError("the blade did not cut");
      return;
    }
    state.SetIterationTime(median(totals));
    state.counters["cut_ms"] = 1e3 * median(cuts);
    state.counters["matrices_ms"] = 1e3 * median(matrices);
    state.counters["surface_ms"] = 1e3 * median(surfaces);
    state.counters["untouched_ms"] = 1e3 * median(untouched);
    state.counters["slowest_ms"] = 1e3 * *std::max_element(totals.begin(), totals.end());
    state.counters["cells_split"] = median(splits);
    state.counters["cells_touched"] = median(touched);
    state.counters["cells"] = rest.numCells();
  }
}

/// Small flat blades at random places of a ball.
void manyRow(benchmark::State& state) {
  const int num_cuts = static_cast<int>(state.range(0));
  const PolyhedralMesh rest = makeTetBall(Vector3d::Zero(), 1, 6);
  const double h = medianSize(rest);
  for (auto _ : state) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto somewhere = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
    const std::size_t before = mallinfo2().uordblks;
    PolyhedralMesh mesh = rest;
    MeshIndex index(mesh);
    Matrix3Xd positions = mesh.restPositions();
    index.tree.fit(mesh, positions);
    double seconds = 0;
    int splits = 0, left_whole = 0;
    for (int i = 0; i < num_cuts; ++i) {
      const Vector3d centre = 0.8 * somewhere(), u = 2.5 * h * somewhere().normalized();
      const Vector3d v = 2.5 * h * u.cross(somewhere()).normalized();
      PolygonCut cut;
      cut.corners_world.resize(3, 4);
      cut.corners_world << centre - u - v, centre + u - v, centre + u + v, centre - u + v;
      StopWatch watch;
      const CutResult result = cutMesh(mesh, positions, cut, {}, i + 1, &index);
      extendByNewVertices(result.change.new_vertices, positions);
      seconds += watch.lap();
      splits += result.cells_split;
      left_whole += result.cells_left_whole;
    }
    state.SetIterationTime(seconds);
    state.counters["cut_ms"] = 1e3 * seconds / num_cuts;
    state.counters["cells"] = mesh.numCells();
    state.counters["cells_split"] = splits;
    state.counters["cells_left_whole"] = left_whole;
    state.counters["memory_mb"] = 1e-6 * static_cast<double>(mallinfo2().uordblks - before);
  }
}

PlaneCut wholePlane(const PolyhedralMesh& mesh) {
  return {middleOf(mesh.restPositions()), Vector3d(1, -0.31, 0.07)};
}

void geometryRow(benchmark::State& state, const PolyhedralMesh& rest) {
  const PlaneCut plane = wholePlane(rest);
  const Matrix3Xd positions = rest.restPositions();
  std::size_t hits = 0;
  CellTree tree;
  tree.fit(rest, positions);
  for (auto _ : state) hits = findHits(rest, tree, positions, plane).size();
  PolyhedralMesh mesh = rest;
  const int splits = cutMesh(mesh, positions, plane, {}, 1).cells_split;
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * splits);
  state.counters["edges"] = static_cast<double>(hits);
}

void wholeRow(benchmark::State& state, const PolyhedralMesh& rest) {
  const PlaneCut plane = wholePlane(rest);
  const Matrix3Xd positions = rest.restPositions();
  std::int64_t splits = 0;
  for (auto _ : state) {
    PolyhedralMesh mesh = rest;
    MeshIndex index(mesh);
    index.tree.fit(mesh, positions);
    StopWatch watch;
    splits += cutMesh(mesh, positions, plane, {}, 1, &index).cells_split;
    state.SetIterationTime(watch.lap());
  }
  state.SetItemsProcessed(splits);
}

/// Registers a row on a mesh that is made when the row runs.
template <class Row>
auto* registerRow(const std::string& name, const BenchMesh& mesh, Row row) {
  return benchmark::RegisterBenchmark((name + "/" + mesh.name).c_str(),
                                      [mesh, row](benchmark::State& state) { row(state, mesh.make()); })
      ->Unit(benchmark::kMillisecond)
      ->Repetitions(kRepetitions)
      ->ReportAggregatesOnly();
}

}  // namespace

void registerCutting(const std::vector<BenchMesh>& meshes) {
  for (const BenchMesh& mesh : meshes) {
    for (const Matrices& matrices : kMatrices) {
      const auto half_plane = [&matrices](auto& state, const auto& rest) {
        halfPlaneRow(state, rest, matrices);
      };
      registerRow(std::string("cut/half_plane") + matrices.suffix, mesh, half_plane)
          ->UseManualTime()
          ->Iterations(1);
      for (const auto& [name, step] : {std::pair("cut/progressive", 0.5), std::pair("cut/fine_steps", 0.1)}) {
        const auto row = [step = step, &matrices](auto& state, const auto& rest) {
          progressiveRow(state, rest, step, matrices);
        };
        registerRow(std::string(name) + matrices.suffix, mesh, row)->UseManualTime()->Iterations(1);
      }
    }
    registerRow("split/geometry", mesh, geometryRow);
    registerRow("split/whole", mesh, wholeRow)->UseManualTime()->Iterations(1);
  }
  benchmark::RegisterBenchmark("cut/many", manyRow)
      ->Unit(benchmark::kMillisecond)
      ->UseManualTime()
      ->Iterations(1)
      ->Arg(50)
      ->Arg(100)
      ->Arg(200)
      ->Arg(400)
      ->Arg(800);
}

}  // namespace polyscalpel::bench
