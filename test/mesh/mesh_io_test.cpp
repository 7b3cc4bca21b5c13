// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/mesh_io.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "mesh_io_testing.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

/// ASCII .msh of version 2 with the nodes and elements given as lines.
std::string makeMsh2(const std::vector<std::string>& nodes, const std::vector<std::string>& elements) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(nodes.size()) + "\n";
  for (const std::string& line : nodes) text += line + "\n";
  text += "$EndNodes\n$Elements\n" + std::to_string(elements.size()) + "\n";
  for (const std::string& line : elements) text += line + "\n";
  return text + "$EndElements\n";
}

const std::vector<std::string> kTetNodes = {"1 0 0 0", "2 1 0 0", "3 0 1 0", "4 0 0 1"};

/// The tet box as .msh 2, written with full digits. Node numbers start at first_number and go up by stride.
std::string makeMsh2(const PolyhedralMesh& mesh, int first_number = 1, int stride = 1) {
  std::vector<std::string> nodes;
  for (int v = 0; v < mesh.numVertices(); ++v) {
    std::ostringstream line;
    line.precision(17);
    line << first_number + stride * v << " " << mesh.restPosition(VertexId(v)).transpose();
    nodes.push_back(line.str());
  }
  std::vector<std::string> elements;
  for (const CellId id : mesh.cells()) {
    // The first face from outside is clockwise from the fourth corner.
    const Face& face = mesh.face(mesh.cell(id).faces.front());
    std::vector<VertexId> corners(face.loop.begin(), face.loop.end());
    if (face.cells[0] == id) std::reverse(corners.begin(), corners.end());
    for (const VertexId vertex : mesh.cell(id).vertices) {
      if (std::find(face.loop.begin(), face.loop.end(), vertex) == face.loop.end()) corners.push_back(vertex);
    }
    std::string line = std::to_string(elements.size() + 1) + " 4 2 5 1";
    for (const VertexId corner : corners)
      line += " " + std::to_string(first_number + stride * corner.index());
    elements.push_back(line);
  }
  return makeMsh2(nodes, elements);
}

/// Two tets as binary .msh of version 2.
std::string makeBinaryMsh2() {
  std::string bytes = "$MeshFormat\n2.2 1 8\n";
  const std::int32_t one = 1;
  append(bytes, &one, 4);
  bytes += "\n$EndMeshFormat\n$Nodes\n5\n";
  const double points[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  for (std::int32_t i = 0; i < 5; ++i) {
    const std::int32_t number = i + 1;
    append(bytes, &number, 4);
    append(bytes, points[i], 24);
  }
  bytes += "\n$EndNodes\n$Elements\n2\n";
  const std::int32_t header[3] = {4, 2, 2};
  append(bytes, header, 12);
  const std::int32_t elements[2][7] = {{1, 6, 1, 1, 2, 3, 4}, {2, 6, 1, 2, 5, 3, 4}};
  append(bytes, elements, sizeof(elements));
  return bytes + "\n$EndElements\n";
}

/// The same two tets as ASCII .msh of version 4.1, in two volumes with their own physical groups.
std::string makeMsh4() {
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
         "$PhysicalNames\n2\n3 6 \"liver\"\n3 8 \"vein\"\n$EndPhysicalNames\n"
         "$Entities\n0 0 0 2\n1 0 0 0 1 1 1 1 6 0\n2 0 0 0 1 1 1 1 8 0\n$EndEntities\n"
         "$Nodes\n2 5 1 5\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 2 0 1\n5\n1 1 1\n$EndNodes\n"
         "$Elements\n2 2 1 2\n3 1 4 1\n1 1 2 3 4\n3 2 4 1\n2 2 5 3 4\n$EndElements\n";
}

/// One cell of each kind around the unit cube, in Gmsh's order.
std::string makeMixedMsh() {
  return makeMsh2(
      {"1 0 0 0", "2 1 0 0", "3 1 1 0", "4 0 1 0", "5 0 0 1", "6 1 0 1", "7 1 1 1", "8 0 1 1",  // cube
       "9 2 0 0", "10 2 0 1",                                                                   // prism
       "11 0.5 0.5 2",                                                                          // pyramid
       "12 0.5 -1 1.5"},                                                                        // tet
      {"1 5 2 1 1 1 2 3 4 5 6 7 8",                                                             // hexahedron
       "2 6 2 1 1 2 9 3 6 10 7",  // prism on x = 1
       "3 7 2 2 2 5 6 7 8 11",    // pyramid on z = 1
       "4 4 2 2 2 5 6 11 12"});   // tet on a side of the pyramid
}

TEST_F(MeshIo, ReadsEachKindOfCellAsItIs) {
  const MeshFile file = read("mixed.msh", makeMixedMsh());
  ASSERT_EQ(file.mesh.numCells(), 4);
  EXPECT_EQ(file.mesh.numVertices(), 12);
  EXPECT_EQ(checkMesh(file.mesh), std::vector<std::string>());
  EXPECT_EQ(findPieces(file.mesh).count, 1);
  EXPECT_TRUE(file.remarks.empty()) << joined(file.remarks);
  const std::size_t faces[] = {6, 5, 5, 4};
  // Tet: |(1, 0, 0) . ((.5, .5, 1) x (.5, -1, .5))| / 6 = (.25 + 1) / 6.
  const double volumes[] = {1, 0.5, 1.0 / 3, 1.25 / 6};
  const int regions[] = {1, 1, 2, 2};
  for (int c = 0; c < 4; ++c) {
    EXPECT_EQ(file.mesh.cell(CellId(c)).faces.size(), faces[c]);
    EXPECT_EQ(file.mesh.cell(CellId(c)).region, regions[c]);
    EXPECT_NEAR(volume(makeCellSurface(file.mesh, CellId(c), file.mesh.restPositions())), volumes[c], 1e-15);
  }
}

TEST_F(MeshIo, KeepsEveryVertexAndCellOfAMeshWrittenWithFullDigits) {
  const PolyhedralMesh box = makeTetBox({0, 0, 0}, {0.3, 0.2, 0.1}, {3, 2, 2});
  for (const int stride : {1, 7}) {
    const MeshFile file = read("box.msh", makeMsh2(box, 5, stride));
    ASSERT_EQ(file.mesh.numVertices(), box.numVertices());
    ASSERT_EQ(file.mesh.numCells(), box.numCells());
    EXPECT_EQ(file.mesh.restPositions(), box.restPositions())
        << "bit for bit, in the order of the node numbers";
    for (const CellId cell : box.cells()) {
      EXPECT_EQ(file.mesh.cell(cell).vertices, box.cell(cell).vertices);
      EXPECT_EQ(file.mesh.cell(cell).region, 5);
    }
    EXPECT_TRUE(file.remarks.empty()) << joined(file.remarks);
  }
}

TEST_F(MeshIo, ReadsVersion2BinaryAndVersion4) {
  for (const MeshFile& file : {read("binary.msh", makeBinaryMsh2()), read("four.msh", makeMsh4())}) {
    EXPECT_EQ(file.mesh.numCells(), 2);
    EXPECT_EQ(file.mesh.numVertices(), 5);
    EXPECT_NEAR(totalVolume(file.mesh), 1.0 / 6 + 1.0 / 3, 1e-15);
    EXPECT_EQ(file.mesh.cell(CellId(0)).region, 6);
    EXPECT_EQ(checkMesh(file.mesh), std::vector<std::string>());
  }
  EXPECT_EQ(read("four.msh", makeMsh4()).mesh.cell(CellId(1)).region, 8);
}

/// Physical groups of a file of version 2.2, after its format.
std::string withNames(std::string msh2, const std::string& names) {
  const std::string end = "$EndMeshFormat\n";
  return msh2.insert(msh2.find(end) + end.size(), "$PhysicalNames\n" + names + "$EndPhysicalNames\n");
}

TEST_F(MeshIo, ReadsTheNamesOfPhysicalGroups) {
  using Names = std::map<std::string, int>;
  EXPECT_EQ(read("four.msh", makeMsh4()).region_names, (Names{{"liver", 6}, {"vein", 8}}));
  // Names of volume groups alone: group 1 of the cells has none, the name of group 1 is that of a surface.
  const std::string nameless = makeMixedMsh();
  EXPECT_EQ(read("two.msh", nameless).region_names, Names());
  const MeshFile named = read("two.msh", withNames(nameless, "2\n2 1 \"skin\"\n3 2 \"inner part\"\n"));
  EXPECT_EQ(named.region_names, (Names{{"inner part", 2}}));
  EXPECT_EQ(named.mesh.cell(CellId(3)).region, 2);
  EXPECT_TRUE(named.remarks.empty()) << joined(named.remarks);
}

TEST_F(MeshIo, TellsOfVolumesInSeveralPhysicalGroups) {
  std::string text = makeMsh4();
  const std::string one = "2 0 0 0 1 1 1 1 8 0\n";
  text.replace(text.find(one), one.size(), "2 0 0 0 1 1 1 2 8 6 0\n");
  const MeshFile file = read("both.msh", text);
  EXPECT_EQ(file.mesh.cell(CellId(1)).region, 6);
  EXPECT_TRUE(contains(joined(file.remarks), "volume 2 is in several physical groups"));
}

std::string makeVtk(const std::string& cells, const std::string& types) {
  return "# vtk DataFile Version 2.0\ntest\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n"
         "0 0 0 1 0 0 0 1 0 0 0 1 1 0 1 0 1 1\nCELLS 1 " +
         cells + "\nCELL_TYPES 1\n" + types + "\n";
}

TEST_F(MeshIo, ReadsVtkWedgesInEitherOrder) {
  const MeshFile gmsh_order = read("gmsh.vtk", makeVtk("7\n6 0 1 2 3 4 5", "13"));
  EXPECT_NEAR(totalVolume(gmsh_order.mesh), 0.5, 1e-15);
  EXPECT_TRUE(gmsh_order.remarks.empty());
  // VTK File Formats, VTK_WEDGE: the triangle of the first three points has its normal outward.
  const MeshFile vtk_order = read("vtk.vtk", makeVtk("7\n6 0 2 1 3 5 4", "13"));
  EXPECT_NEAR(totalVolume(vtk_order.mesh), 0.5, 1e-15);
  EXPECT_TRUE(contains(joined(vtk_order.remarks), "VTK's own order"));
  EXPECT_EQ(checkMesh(vtk_order.mesh), std::vector<std::string>());
}

const char kMedit[] =
    "MeshVersionFormatted 2\n# a comment\nDimension 3\n\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 "
    "1 1 "
    "0\n"
    "Tetrahedra\n2\n1 2 3 4 1\n2 5 3 4 1\nEnd\n";

TEST_F(MeshIo, ReadsMeditFiles) {
  const MeshFile file = read("two.mesh", kMedit);
  EXPECT_EQ(file.mesh.numCells(), 2);
  EXPECT_NEAR(totalVolume(file.mesh), 0.5, 1e-15);
}

TEST_F(MeshIo, RefusesMeditLayoutsThatGmshMisreads) {
  std::string text = kMedit;
  text.replace(text.find("Dimension 3\n\n"), 13, "Dimension 3\n");
  EXPECT_TRUE(contains(refusal("dimension.mesh", text), "after Dimension must stand on a line of its own"));
  text = kMedit;
  text.replace(text.find("Vertices\n"), 9, "Vertices ");
  EXPECT_TRUE(contains(refusal("vertices.mesh", text), "number of Vertices must stand on a line of its own"));
}

TEST_F(MeshIo, ScalesToMetres) {
  MeshFileConfig config;
  config.path = write("mm.msh", makeMixedMsh());
  config.scale = 1e-3;
  const MeshFile file = readMesh(config);
  EXPECT_NEAR(totalVolume(file.mesh), (1 + 0.5 + 1.0 / 3 + 1.25 / 6) * 1e-9, 1e-23);
}

TEST_F(MeshIo, LeavesOutUnusedNodesAndSaysSo) {
  std::vector<std::string> nodes = kTetNodes;
  nodes.insert(nodes.begin(), "9 0 0 0");
  nodes.push_back("10 5 5 5");
  const MeshFile file = read("unused.msh", makeMsh2(nodes, {"1 4 2 0 1 1 2 3 4", "2 1 2 0 1 9 10"}));
  EXPECT_EQ(file.mesh.numVertices(), 4);
  EXPECT_TRUE(contains(joined(file.remarks), "2 nodes belong to no volume cell"));
}

TEST_F(MeshIo, AllowsUnconnectedBodiesAndSaysSo) {
  const std::vector<std::string> nodes = {"1 0 0 0", "2 1 0 0", "3 0 1 0", "4 0 0 1",
                                          "5 5 0 0", "6 6 0 0", "7 5 1 0", "8 5 0 1"};
  const MeshFile apart = read("apart.msh", makeMsh2(nodes, {"1 4 2 0 1 1 2 3 4", "2 4 2 0 1 5 6 7 8"}));
  EXPECT_EQ(findPieces(apart.mesh).count, 2);
  EXPECT_EQ(joined(apart.remarks), "2 unconnected bodies\n");
  // Two that share the vertex 2 alone.
  const MeshFile touching = read("touching.msh", makeMsh2(nodes, {"1 4 2 0 1 1 2 3 4", "2 4 2 0 1 2 6 7 8"}));
  EXPECT_EQ(touching.mesh.numVertices(), 8);
  EXPECT_TRUE(contains(joined(touching.remarks), "2 unconnected bodies"));
  EXPECT_TRUE(contains(joined(touching.remarks), "1 vertices were copied"));
  EXPECT_EQ(checkMesh(touching.mesh), std::vector<std::string>());
}

TEST_F(MeshIo, UsesTheCornersOfCellsOfHigherOrder) {
  std::vector<std::string> nodes = kTetNodes;
  for (const char* middle : {"5 .5 0 0", "6 .5 .5 0", "7 0 .5 0", "8 0 0 .5", "9 0 .5 .5", "10 .5 0 .5"}) {
    nodes.push_back(middle);
  }
  const MeshFile file = read("second.msh", makeMsh2(nodes, {"1 11 2 0 1 1 2 3 4 5 6 7 8 9 10"}));
  EXPECT_EQ(file.mesh.numVertices(), 4);
  EXPECT_TRUE(contains(joined(file.remarks), "higher order"));
}

TEST_F(MeshIo, RefusesFilesThatAreNoMeshes) {
  EXPECT_TRUE(contains(refusal("empty.msh", ""), "the file is empty"));
  EXPECT_TRUE(contains(refusal("script.msh", "Point(1) = {0, 0, 0};"), "wrong type"));
  EXPECT_TRUE(contains(refusal("text.vtk", "hello"), "wrong type"));
  EXPECT_TRUE(contains(refusal("text.mesh", "hello"), "wrong type"));
  EXPECT_TRUE(contains(refusal("text.stl", "hello"), "wrong type"));
  EXPECT_TRUE(contains(refusal("text.ply", "hello"), "wrong type"));
  EXPECT_TRUE(contains(refusal("text.obj", "hello"), "wrong type"));
  EXPECT_TRUE(contains(refusal("text.off", "hello"), "wrong type"));
  EXPECT_TRUE(contains(refusal("table.csv", "1,2,3"), "unknown type \".csv\": must be one of .msh"));
  EXPECT_TRUE(contains(refusal("script.geo", "Exit;"), "unknown type"));
  MeshFileConfig config;
  config.path = (folder_ / "missing.msh").string();
  try {
    readMesh(config);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_TRUE(contains(error.what(), "missing.msh\": no such file"));
  }
  config.path = (folder_ / "folder.msh").string();
  std::filesystem::create_directory(config.path);
  EXPECT_THROW(readMesh(config), std::invalid_argument);
}

TEST_F(MeshIo, RefusesBadScaleAndCellSize) {
  MeshFileConfig config;
  config.path = write("mixed.msh", makeMixedMsh());
  for (const double scale : {0.0, -1.0, std::nan(""), kInfinity}) {
    config.scale = scale;
    EXPECT_THROW(readMesh(config), std::invalid_argument) << scale;
  }
  config.scale = 1;
  for (const double size : {-1.0, std::nan(""), kInfinity}) {
    config.cell_size_m = size;
    EXPECT_THROW(readMesh(config), std::invalid_argument) << size;
  }
}

TEST_F(MeshIo, RefusesAFileThatEndsAnywhereBeforeItsEnd) {
  const std::string off = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const struct {
    const char* name;
    std::string bytes;
    std::size_t end;  // of what is needed; from here on nothing is lost
  } kFiles[] = {{"t.msh", makeMixedMsh(), makeMixedMsh().find("$EndElements") + 12},
                {"b.msh", makeBinaryMsh2(), makeBinaryMsh2().find("$EndElements") + 12},
                {"4.msh", makeMsh4(), makeMsh4().find("$EndElements") + 12},
                {"t.vtk", makeVtk("7\n6 0 1 2 3 4 5", "13"), makeVtk("7\n6 0 1 2 3 4 5", "13").size() - 1},
                {"t.mesh", kMedit, std::strlen(kMedit) - 1},
                {"t.off", off, off.size() - 1}};
  for (const auto& file : kFiles) {
    EXPECT_NO_THROW(read(file.name, file.bytes.substr(0, file.end)));
    for (std::size_t size = 0; size < file.end; size += 1 + file.end / 60) {
      EXPECT_NE(refusal(file.name, file.bytes.substr(0, size)), "")
          << file.name << " of " << size << " bytes";
    }
    EXPECT_NE(refusal(file.name, file.bytes.substr(0, file.end - 1)), "");
  }
}

TEST_F(MeshIo, RefusesCountsThatAreNotMet) {
  std::string text = kMedit;
  text.replace(text.find("Tetrahedra\n2"), 12, "Tetrahedra\n3");
  EXPECT_TRUE(contains(refusal("more.mesh", text), "truncated or damaged"));
  // Gmsh skips these without a word.
  std::string prisms =
      "MeshVersionFormatted 2\nDimension\n3\nVertices\n6\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 0 1 0\n0 1 1 "
      "0\n"
      "Prisms\n1\n1 2 3 4 5 6 0\nEnd\n";
  EXPECT_TRUE(contains(refusal("prisms.mesh", prisms), "announces 1 volume cells, Gmsh reads 0"));
  EXPECT_TRUE(
      contains(refusal("new.vtk",
                       "# vtk DataFile Version 5.1\nw\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
                       "0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 2 4\nOFFSETS vtktypeint64\n0 4\n"
                       "CONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES 1\n10\n"),
               "version 4.2"));
}

TEST_F(MeshIo, RefusesInvertedAndFlatCellsWithNumberAndVolume) {
  EXPECT_TRUE(contains(refusal("inverted.msh", makeMsh2(kTetNodes, {"17 4 2 0 1 1 3 2 4"})),
                       "cell 17 is inverted: volume -0.166667 m^3, must be > 0"));
  std::vector<std::string> flat = kTetNodes;
  flat[3] = "4 1 1 0";
  EXPECT_TRUE(contains(refusal("flat.msh", makeMsh2(flat, {"17 4 2 0 1 1 2 3 4"})),
                       "cell 17 has zero volume: volume 0 m^3"));
  // A hexahedron of positive volume with a corner drawn through the opposite one.
  EXPECT_TRUE(contains(refusal("folded.msh", makeMsh2({"1 0 0 0", "2 1 0 0", "3 1 1 0", "4 0 1 0", "5 0 0 1",
                                                       "6 1 0 1", "7 -.3 -.3 -.3", "8 0 1 1"},
                                                      {"23 5 2 0 1 1 2 3 4 5 6 7 8"})),
                       "cell 23 is folded"));
}

TEST_F(MeshIo, RefusesDuplicateVertices) {
  std::vector<std::string> nodes = kTetNodes;
  nodes.push_back("8 0 0 1.0000000001");
  nodes.push_back("9 1 1 1");
  EXPECT_TRUE(contains(refusal("double.msh", makeMsh2(nodes, {"1 4 2 0 1 1 2 3 4", "2 4 2 0 1 2 9 3 8"})),
                       "duplicate vertices: nodes 4 and 8 lie"));
}

TEST_F(MeshIo, RefusesOtherDefects) {
  EXPECT_TRUE(contains(refusal("lines.msh", makeMsh2(kTetNodes, {"1 1 2 0 1 1 2"})), "no volume cells"));
  EXPECT_NE(
      refusal("nan.msh", makeMsh2({"1 0 0 0", "2 1 0 0", "3 0 1 0", "4 0 nan 1"}, {"1 4 2 0 1 1 2 3 4"})),
      "");
  EXPECT_NE(refusal("missing_node.msh", makeMsh2(kTetNodes, {"1 4 2 0 1 1 2 3 99"})), "");
  // Three cells on one face.
  std::vector<std::string> nodes = kTetNodes;
  nodes.push_back("5 1 1 1");
  nodes.push_back("6 2 2 2");
  EXPECT_TRUE(contains(
      refusal("three.msh", makeMsh2(nodes, {"1 4 2 0 1 1 2 3 4", "2 4 2 0 1 2 5 3 4", "3 4 2 0 1 2 6 3 4"})),
      "belongs already to cells"));
}

TEST_F(MeshIo, ReadsTheBunnyAndTheBeam) {
  const char* folder = std::getenv("POLYSCALPEL_TEST_MESHES");
  if (folder == nullptr) GTEST_SKIP() << "POLYSCALPEL_TEST_MESHES is not set";
  MeshFileConfig config;
  config.path = std::string(folder) + "/bunny8k.msh";
  const MeshFile bunny = readMesh(config);
  EXPECT_EQ(bunny.mesh.numVertices(), 2341);
  EXPECT_EQ(bunny.mesh.numCells(), 8275);
  EXPECT_EQ(checkMesh(bunny.mesh), std::vector<std::string>());
  EXPECT_EQ(findPieces(bunny.mesh).count, 1);

  config.path = std::string(folder) + "/beam10k.msh";
  const MeshFile beam = readMesh(config);
  const PolyhedralMesh generated = makeTetBox({0, 0, 0}, {0.4, 0.1, 0.1}, {32, 8, 8});
  EXPECT_EQ(beam.mesh.numVertices(), generated.numVertices());
  EXPECT_EQ(beam.mesh.numCells(), generated.numCells());
  EXPECT_NEAR(totalVolume(beam.mesh), totalVolume(generated), 1e-15);
}

}  // namespace
}  // namespace polyscalpel
