// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "benchmark/bench_meshes.hpp"

namespace polyscalpel::bench {

/// cut/half_plane/<mesh>   a plane half through the body, with the new cells' matrices (1 point), the surface
///                         and the collision tree
/// cut/progressive/<mesh>  one step of half a local size of a short blade, with the same
/// cut/fine_steps/<mesh>   one step of a tenth of a local size, which touches about ten cells
/// the three with _4_points behind their name: the matrices with 4 points on two cores
/// cut/many/<n>            n cuts of the same size one after another: time and memory are to grow linearly
/// split/geometry/<mesh>   which edges a plane crosses and where, by exact decisions; items are the cells it
///                         passes
/// split/whole/<mesh>      the whole cut of the mesh by that plane; items are the cells split
void registerCutting(const std::vector<BenchMesh>& meshes);

}  // namespace polyscalpel::bench
