// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "benchmark/bench_meshes.hpp"
#include "benchmark/step_bodies.hpp"

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

/// Bodies for the rows of steps: those with known displacements, where the folder holds them, and tet_beam10k
/// and ball40k (10,240 and 40,000 tetrahedra) of our generator.
std::vector<report::StepSubject> stepSubjects(const std::string& folder);

/// A row that is not measured and says why.
void reportMissing(const std::string& row, const std::string& why);

/// step/<body>/<solver>            the median of steps 2 to 60, all solvers of a body in turns; the thread's
/// own
///                                 work, since others use the machine too
/// step/<body>/<solver>/threads:2  the same by two threads: wall time
/// step/<body>/bullet              Bullet's deformable body in the same turns
/// gate_error is the largest relative error of the largest displacement after 5, 10 and 60 steps.
void registerSteps(const std::string& folder);

/// assembly/<body>               forces and the matrix in single precision, in a bent shape
/// matvec/<body>                 one product with that matrix
/// precondition/<body>/<solver>  one application of what the solver divides by
void registerStepStages(const std::string& folder);

/// step_after_cut/<body>/<cut>  the first step after a cut; before_ms: the step before it, tenth_ms: the
/// tenth
///                              after it; ratio: first over before, the worst one of a series of cuts
void registerStepsAfterCuts(const std::string& folder);

}  // namespace polyscalpel::bench
