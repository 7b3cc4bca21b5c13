// SPDX-License-Identifier: BSD-3-Clause
//
// A liver-like organ, about 15 cm long [m]: a large right lobe (-x), a smaller left lobe (+x), a notch between them in
// front, an underside flattened so that it rests on a table at z = 0. Made of deformed spheres by boolean operations.
//
//   gmsh -3 -nt 1 config/meshes/liver.geo -o liver.msh
SetFactory("OpenCASCADE");


edge = 0.0073;  // edge length of the tets [m]

// Each lobe is a unit sphere under an affine map; the maps turn the spheres so that their seams and most poles lie inside
// the others or below the table: they would leave rows of small cells.
// Right lobe: thick and round.
Sphere(1) = {0, 0, 0, 1};
Affine {0.050, 0, 0, -0.028,   0, 0.047, 0, 0,   0, 0, 0.034, 0.022} { Volume{1}; }

// The middle, which makes the dome one slope from right to left.
Sphere(6) = {0, 0, 0, 1};
Affine {0, 0.006, 0.058, 0.003,   0, 0.044, 0, 0.003,   -0.029, 0, -0.006, 0.019} { Volume{6}; }

// Left lobe: long, thin.
Sphere(2) = {0, 0, 0, 1};
Affine {-0.046, -0.008, 0, 0.040,   0.006, -0.032, 0, 0.006,   0, 0, 0.020, 0.015} { Volume{2}; }

// Notch in the front rim, where the ligament runs.
Sphere(3) = {0, 0, 0, 1};
Affine {0.009, 0.004, 0, 0.016,   -0.003, 0.024, 0, -0.046,   0, 0, 0.070, 0.020} { Volume{3}; }

// Hollow of the underside, where other organs lie.
Sphere(4) = {0, 0, 0, 1};
Affine {0.032, 0, 0, 0.016,   0, 0.020, 0, 0.004,   0, 0, 0.009, 0.001} { Volume{4}; }

// All that lies above the table.
Box(5) = {-0.2, -0.2, 0.002, 0.4, 0.4, 0.2};

BooleanUnion(10) = { Volume{1}; Delete; }{ Volume{2, 6}; Delete; };
BooleanDifference(11) = { Volume{10}; Delete; }{ Volume{3, 4}; Delete; };
BooleanIntersection(12) = { Volume{11}; Delete; }{ Volume{5}; Delete; };

Translate {0, 0, -0.002} { Volume{12}; }
Dilate {{0, 0, 0}, 0.915} { Volume{12}; }  // to 15 cm

Physical Volume("liver") = {12};

Mesh.MeshSizeMin = edge;
Mesh.MeshSizeMax = edge;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.Algorithm = 6;        // frontal Delaunay on the surface
Mesh.Algorithm3D = 1;      // Delaunay in the volume
Mesh.Optimize = 1;
Mesh.OptimizeThreshold = 0.4;

Mesh.RandomSeed = 1;
Mesh.SaveAll = 0;          // the volume alone
