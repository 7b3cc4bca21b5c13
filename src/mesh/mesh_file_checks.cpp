// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_file_checks.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace polyscalpel {
namespace {

constexpr const char* kWhitespace = " \t\r\n\v\f";

[[noreturn]] void refuse(const std::string& reason) {
  throw std::invalid_argument(reason);
}

std::string toLower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

std::string readBytes(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) refuse("no such file");
  if (!std::filesystem::is_regular_file(path, error)) refuse("not a file");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) refuse("cannot be opened for reading");
  std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (bytes.empty()) refuse("the file is empty");
  return bytes;
}

/// Walks through the bytes of a file by words and lines.
class Scanner {
 public:
  explicit Scanner(const std::string& bytes) : bytes_(bytes) {}

  /// The next word; empty at the end.
  std::string nextWord() {
    position_ = std::min(bytes_.find_first_not_of(kWhitespace, position_), bytes_.size());
    const std::size_t end = std::min(bytes_.find_first_of(kWhitespace, position_), bytes_.size());
    std::string word = bytes_.substr(position_, end - position_);
    position_ = end;
    return word;
  }

  /// The rest of the current line, without its end.
  std::string nextLine() {
    const std::size_t end = std::min(bytes_.find('\n', position_), bytes_.size());
    std::string line = bytes_.substr(position_, end - position_);
    position_ = std::min(end + 1, bytes_.size());
    return line;
  }

  /// A count that must follow here.
  std::size_t nextCount(const std::string& what) {
    const std::string word = nextWord();
    const bool is_count =
        !word.empty() && word.size() < 16 &&
        std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isdigit(c); });
    if (!is_count)
      refuse(word.empty() ? "truncated before the number of " + what
                          : "\"" + word + "\" is not a number of " + what);
    return std::stoull(word);
  }

  /// Skips words, each of which must be a number.
  void skipNumbers(std::size_t count, const std::string& what) {
    for (std::size_t i = 0; i < count; ++i) nextNumber(count, i, what);
  }

  double nextNumber(std::size_t count, std::size_t i, const std::string& what) {
    const std::string word = nextWord();
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (word.empty() || end != word.c_str() + word.size()) {
      std::ostringstream message;
      message << "truncated or damaged in " << what << ": " << count << " numbers are announced, after " << i;
      if (word.empty()) {
        message << " the file ends";
      } else {
        message << " follows \"" << word << "\"";
      }
      refuse(message.str());
    }
    return value;
  }

  /// Skips bytes and returns where they began.
  std::size_t skipBytes(std::size_t count, const std::string& what) {
    const std::size_t start = position_;
    if (count > bytes_.size() - position_) {
      refuse("truncated in " + what + ": " + std::to_string(count) + " bytes are announced, " +
             std::to_string(bytes_.size() - position_) + " are there");
    }
    position_ += count;
    return start;
  }

  /// Whether nothing but blanks is left on the current line.
  bool isLineOver() const {
    const std::size_t next = bytes_.find_first_not_of(" \t\r", position_);
    return next == std::string::npos || bytes_[next] == '\n';
  }

  bool isAtEnd() const { return position_ >= bytes_.size(); }

 private:
  const std::string& bytes_;
  std::size_t position_ = 0;
};

std::string firstWord(const std::string& bytes) {
  return Scanner(bytes).nextWord();
}

DeclaredCounts checkMsh(const std::string& bytes) {
  const std::string first = firstWord(bytes);
  if (first != "$MeshFormat" && first != "$Comments")
    refuse("wrong type: a .msh file begins with $MeshFormat");
  for (const char* section : {"Nodes", "Elements"}) {
    if (bytes.find(std::string("$") + section) == std::string::npos) {
      refuse(std::string("truncated, or not a mesh: no section $") + section);
    }
    if (bytes.find(std::string("$End") + section) == std::string::npos) {
      refuse(std::string("truncated: section $") + section + " does not end");
    }
  }
  return {};
}

/// VTK's numbers of cell types that fill no volume: points, lines, polygons and their kin of higher order.
bool isVtkVolume(int type) {
  static const std::set<int> kFlat = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  21, 22, 23, 28, 30,
                                      34, 35, 36, 51, 52, 60, 61, 62, 68, 69, 70, 75, 76, 77};
  return kFlat.count(type) == 0;
}

DeclaredCounts checkVtk(const std::string& bytes) {
  if (bytes.rfind("# vtk DataFile", 0) != 0) refuse("wrong type: a .vtk file begins with \"# vtk DataFile\"");
  Scanner scanner(bytes);
  scanner.nextLine();
  scanner.nextLine();
  const std::string encoding = scanner.nextWord();
  if (encoding != "ASCII" && encoding != "BINARY")
    refuse("wrong type: third line is neither ASCII nor BINARY");
  const bool is_binary = encoding == "BINARY";
  scanner.nextLine();
  const std::map<std::string, std::size_t> sizes = {{"float", 4}, {"double", 8}};
  const auto skip = [&](std::size_t count, std::size_t size, const std::string& what) {
    if (!is_binary) {
      scanner.skipNumbers(count, what);
    } else {
      scanner.nextLine();
      scanner.skipBytes(count * size, what);
    }
  };

  DeclaredCounts counts;
  bool has_points = false;
  bool has_cells = false;
  for (std::string word = scanner.nextWord(); !word.empty(); word = scanner.nextWord()) {
    if (word == "DATASET") {
      const std::string kind = scanner.nextWord();
      if (kind != "UNSTRUCTURED_GRID" && kind != "POLYDATA") {
        refuse("dataset " + kind + ": only UNSTRUCTURED_GRID and POLYDATA are read");
      }
    } else if (word == "POINTS") {
      const std::size_t count = scanner.nextCount("points");
      const auto size = sizes.find(scanner.nextWord());
      if (size == sizes.end()) refuse("points must be float or double");
      skip(3 * count, size->second, "the points");
      has_points = true;
    } else if (word == "POLYGONS") {
      counts.polygons = scanner.nextCount("polygons");
      skip(scanner.nextCount("entries"), 4, "the polygons");
      has_cells = true;
    } else if (word == "CELLS") {
      scanner.nextCount("cells");
      const std::size_t size = scanner.nextCount("entries");
      if (bytes.find("OFFSETS") != std::string::npos) {
        refuse("cells as OFFSETS and CONNECTIVITY (version 5) are not read: save it as version 4.2 or older");
      }
      skip(size, 4, "the cells");
    } else if (word == "CELL_TYPES") {
      const std::size_t count = scanner.nextCount("cell types");
      std::size_t num_volumes = 0;
      if (is_binary) scanner.nextLine();
      for (std::size_t i = 0; i < count; ++i) {
        int type = 0;
        if (is_binary) {
          const std::size_t start = scanner.skipBytes(4, "the cell types");
          for (int k = 0; k < 4; ++k) type = (type << 8) | static_cast<std::uint8_t>(bytes[start + k]);
        } else {
          type = static_cast<int>(scanner.nextNumber(count, i, "the cell types"));
        }
        num_volumes += isVtkVolume(type);
      }
      counts.volume_cells = num_volumes;
      has_cells = true;
    } else if (word == "CELL_DATA" || word == "POINT_DATA") {
      break;  // fields, which may hold anything and are not used
    }
  }
  if (!has_points) refuse("truncated, or not a mesh: no POINTS");
  if (!has_cells) refuse("truncated, or not a mesh: no CELL_TYPES or POLYGONS");
  return counts;
}

DeclaredCounts checkMedit(const std::string& bytes) {
  // Numbers that follow on each entity of a section, the reference included.
  static const std::map<std::string, int> kVolumes = {
      {"Tetrahedra", 5}, {"Hexahedra", 9}, {"Prisms", 7}, {"Pyramids", 6}, {"TetrahedraP2", 11}};
  static const std::map<std::string, int> kPolygons = {{"Triangles", 4}, {"Quadrilaterals", 5}};
  std::string plain;  // without comments
  std::istringstream lines(bytes);
  for (std::string line; std::getline(lines, line);) plain += line.substr(0, line.find('#')) + "\n";
  if (firstWord(plain).rfind("MeshVersionFormatted", 0) != 0) {
    refuse("wrong type: an ASCII .mesh file begins with MeshVersionFormatted");
  }
  Scanner scanner(plain);
  // Medit leaves the lines free; Gmsh looks for numbers on the line after the word, and skips the one after
  // Dimension.
  const auto requireLineOver = [&scanner](const std::string& word) {
    if (!scanner.isLineOver())
      refuse("the number of " + word + " must stand on a line of its own for Gmsh to read it");
  };
  DeclaredCounts counts;
  std::size_t num_volumes = 0;
  std::size_t num_polygons = 0;
  bool has_end = false;
  for (std::string word = scanner.nextWord(); !word.empty(); word = scanner.nextWord()) {
    const auto volumes = kVolumes.find(word);
    const auto polygons = kPolygons.find(word);
    if (word == "End") {
      has_end = true;
      break;
    }
    if (word == "Dimension") {
      const bool is_on_own_line = scanner.isLineOver();
      if (scanner.nextCount("dimensions") != 3) refuse("the dimension must be 3");
      scanner.nextLine();
      if (!is_on_own_line && !scanner.isLineOver()) {
        refuse("the number after Dimension must stand on a line of its own for Gmsh to read it");
      }
    } else if (word == "Vertices") {
      requireLineOver(word);
      scanner.skipNumbers(4 * scanner.nextCount("vertices"), "the vertices");
    } else if (volumes != kVolumes.end()) {
      requireLineOver(word);
      const std::size_t count = scanner.nextCount(word);
      num_volumes += count;
      scanner.skipNumbers(count * volumes->second, word);
    } else if (polygons != kPolygons.end()) {
      requireLineOver(word);
      const std::size_t count = scanner.nextCount(word);
      num_polygons += count;
      scanner.skipNumbers(count * polygons->second, word);
    }
  }
  if (!has_end) refuse("truncated: the file does not close with End");
  counts.volume_cells = num_volumes;
  counts.polygons = num_polygons;
  return counts;
}

DeclaredCounts checkStl(const std::string& bytes) {
  // The number of facets is not compared with what is read: degenerate ones are left out, and what is missing
  // is a hole. Binary files may begin with "solid" too, text files hold no zero byte.
  const bool is_text = bytes.rfind("solid", 0) == 0 && bytes.find('\0') == std::string::npos;
  if (is_text) {
    const std::string text = toLower(bytes);
    const std::size_t last_facet = text.rfind("facet");
    if (last_facet == std::string::npos) refuse("truncated or wrong type: no facets");
    if (text.find("endsolid", last_facet) == std::string::npos) {
      refuse("truncated: the file does not close with endsolid");
    }
    return {};
  }
  constexpr std::size_t kHeader = 84;
  constexpr std::size_t kTriangle = 50;
  if (bytes.size() < kHeader) refuse("wrong type or truncated: neither a text nor a binary .stl file");
  std::uint32_t count = 0;
  for (int k = 3; k >= 0; --k) count = (count << 8) | static_cast<std::uint8_t>(bytes[80 + k]);
  const std::size_t expected = kHeader + kTriangle * static_cast<std::size_t>(count);
  if (bytes.size() != expected) {
    refuse("truncated or wrong type: a binary .stl file of " + std::to_string(count) + " triangles has " +
           std::to_string(expected) + " bytes, not " + std::to_string(bytes.size()));
  }
  return {};
}

DeclaredCounts checkPly(const std::string& bytes) {
  if (firstWord(bytes) != "ply") refuse("wrong type: a .ply file begins with ply");
  if (bytes.find("end_header") == std::string::npos) refuse("truncated: no end_header");
  Scanner scanner(bytes);
  DeclaredCounts counts;
  for (std::string word = scanner.nextWord(); word != "end_header"; word = scanner.nextWord()) {
    if (word == "comment" || word == "obj_info") {
      scanner.nextLine();
    } else if (word == "element" && scanner.nextWord() == "face") {
      counts.polygons = scanner.nextCount("faces");
    }
    if (scanner.isAtEnd()) refuse("truncated: no end_header");
  }
  if (!counts.polygons) refuse("no faces");
  return counts;
}

DeclaredCounts checkOff(const std::string& bytes) {
  if (firstWord(bytes).find("OFF") == std::string::npos) refuse("wrong type: an .off file begins with OFF");
  return {};
}

DeclaredCounts checkObj(const std::string& bytes) {
  // Each line begins with a word that .obj files know; that is all there is to tell them by.
  std::istringstream lines(bytes);
  bool has_vertex = false;
  for (std::string line; std::getline(lines, line);) {
    const std::string word = firstWord(line);
    if (std::any_of(line.begin(), line.end(), [](unsigned char c) { return c < 9; })) {
      refuse("wrong type: an .obj file is text");
    }
    has_vertex |= word == "v";
  }
  if (!has_vertex) refuse("wrong type or truncated: no vertex lines (v x y z)");
  return {};
}

}  // namespace

MeshFileType findMeshFileType(const std::string& path) {
  static const std::map<std::string, MeshFileType> kTypes = {
      {".msh", MeshFileType::kMsh}, {".vtk", MeshFileType::kVtk}, {".mesh", MeshFileType::kMedit},
      {".stl", MeshFileType::kStl}, {".ply", MeshFileType::kPly}, {".obj", MeshFileType::kObj},
      {".off", MeshFileType::kOff}};
  const std::string ending = std::filesystem::path(path).extension().string();
  const auto found = kTypes.find(toLower(ending));
  if (found == kTypes.end()) {
    refuse("unknown type \"" + ending + "\": must be one of .msh, .vtk, .mesh, .stl, .ply, .obj, .off");
  }
  return found->second;
}

DeclaredCounts requireCompleteMeshFile(const std::string& path, MeshFileType type) {
  const std::string bytes = readBytes(path);
  switch (type) {
    case MeshFileType::kMsh:
      return checkMsh(bytes);
    case MeshFileType::kVtk:
      return checkVtk(bytes);
    case MeshFileType::kMedit:
      return checkMedit(bytes);
    case MeshFileType::kStl:
      return checkStl(bytes);
    case MeshFileType::kPly:
      return checkPly(bytes);
    case MeshFileType::kObj:
      return checkObj(bytes);
    case MeshFileType::kOff:
      return checkOff(bytes);
  }
  throw std::logic_error("unknown mesh file type");
}

}  // namespace polyscalpel
