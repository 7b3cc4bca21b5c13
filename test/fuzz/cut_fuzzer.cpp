// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/cut_fuzzer.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "support/torture_body.hpp"

namespace polyscalpel {
namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr int kMostCuts = 12;
constexpr int kMostPoses = 12;
constexpr int kMostCorners = 8;
/// Bent caps that are cut again change the volume a little; more than this is a hole.
constexpr double kLargestVolumeError = 1e-2;

class ByteReader {
 public:
  ByteReader(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool isAtEnd() const { return at_ >= size_; }
  int byte() { return isAtEnd() ? 0 : data_[at_++]; }
  /// In [0, count).
  int choice(int count) { return byte() % count; }

  double number() {
    static const double hard[] = {0,
                                  1.0 / 3,
                                  0.5,
                                  2.0 / 3,
                                  1,
                                  -1,
                                  1e-9,
                                  -1e-9,
                                  1e-15,
                                  1.0 / 3 + 1e-12,
                                  0.5 - 1e-16,
                                  1e9,
                                  -1e300,
                                  std::numeric_limits<double>::infinity(),
                                  std::numeric_limits<double>::quiet_NaN(),
                                  std::numeric_limits<double>::denorm_min()};
    const int high = byte(), low = byte();
    if (high >= 240) return hard[high - 240];
    return (256 * high + low) / (0.25 * 240 * 256) - 2;
  }
  Vector3d vector() {
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

PolyhedralMesh makeBody(int choice) {
  if (choice == 0) return makeHexBox(Vector3d::Zero(), Vector3d::Ones(), Vector3i::Constant(3));
  if (choice == 1) return makeTetBox(Vector3d::Zero(), Vector3d(1, 0.5, 0.5), Vector3i(4, 2, 2));
  return makeTetBall(Vector3d::Constant(0.5), 0.5, 1);
}

TortureCut readCut(ByteReader& bytes) {
  TortureCut cut;
  const int kind = bytes.choice(4);
  if (kind == 0) {
    PlaneCut plane;
    plane.point_world = bytes.vector();
    plane.normal_world = bytes.vector();
    cut.operation = plane;
  } else if (kind == 1) {
    // In a plane, as corners that are not are refused: point + s * u + t * v.
    const Vector3d point = bytes.vector(), u = bytes.vector(), v = bytes.vector();
    PolygonCut polygon;
    polygon.corners_world.resize(3, bytes.choice(kMostCorners + 1));
    for (int i = 0; i < polygon.corners_world.cols(); ++i) {
      const double s = bytes.number(), t = bytes.number();
      polygon.corners_world.col(i) = point + s * u + t * v;
    }
    cut.operation = polygon;
  } else {
    SweepCut sweep;
    sweep.edge_tool.resize(3, bytes.choice(5));
    for (int i = 0; i < sweep.edge_tool.cols(); ++i) sweep.edge_tool.col(i) = bytes.vector();
    const int poses = bytes.choice(kMostPoses + 1);
    for (int i = 0; i < poses; ++i) {
      Isometry3d T = Isometry3d::Identity();
      T.translation() = bytes.vector();
      const Vector3d turn = bytes.vector();
      if (turn.norm() < 10) T.linear() = Quaterniond(1, turn.x(), turn.y(), turn.z()).normalized().matrix();
      sweep.T_world_tool.push_back(T);
    }
    cut.operation = sweep;
    cut.is_progressive = kind == 3;
  }
  return cut;
}

}  // namespace

std::string cutFromBytes(const std::uint8_t* data, std::size_t size) {
  ByteReader bytes(data, size);
  TortureBody body("body", makeBody(bytes.choice(3)), false);
  for (int i = 0; i < kMostCuts && !bytes.isAtEnd(); ++i) {
    const TortureCut cut = readCut(bytes);
    const int vertices = body.mesh().numVertices(), faces = body.mesh().faceCapacity();
    const TortureOutcome outcome = body.apply(cut, CuttingConfig());
    const std::string where = "cut " + std::to_string(i + 1) + ": ";
    if (outcome.was_refused) {
      // All or nothing; what a stroke did before a pose that is none stays.
      if (!cut.is_progressive &&
          (body.mesh().numVertices() != vertices || body.mesh().faceCapacity() != faces))
        return where + "refused, but the mesh has changed";
      if (!checkMesh(body.mesh()).empty()) return where + checkMesh(body.mesh()).front();
      continue;
    }
    if (!outcome.violations.empty()) return where + outcome.violations.front();
    if (!(std::abs(outcome.volume_error) < kLargestVolumeError))
      return where + "volume error " + std::to_string(outcome.volume_error);
  }
  return {};
}

}  // namespace polyscalpel
