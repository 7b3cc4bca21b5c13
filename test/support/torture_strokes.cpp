// SPDX-License-Identifier: BSD-3-Clause
#include "support/torture_strokes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "polyscalpel/cutting/blade_sweep.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

double uniform(TortureRandom& random, double lowest, double highest) {
  return std::uniform_real_distribution<double>(lowest, highest)(random);
}

int pick(TortureRandom& random, int count) {
  return std::uniform_int_distribution<int>(0, count - 1)(random);
}

/// Where a stroke runs: along axes.col(0), the blade along axes.col(2), from -reach to +reach around centre.
struct Track {
  Matrix3d axes;
  Vector3d centre;
  double reach;  ///< a blade of half this length passes through everything [m]

  Isometry3d pose(double along, double across = 0, double turn = 0) const {
    Isometry3d T = Isometry3d::Identity();
    T.linear() = axes * AngleAxisd(turn, Vector3d::UnitX()).toRotationMatrix();
    T.translation() = centre + along * axes.col(0) + across * axes.col(1);
    return T;
  }
};

Track someTrack(const TortureBody& body, TortureRandom& random) {
  Track track{someFrame(random), body.box().center(), 0.75 * body.box().diagonal().norm()};
  for (int i = 0; i < 3; ++i) track.centre[i] += uniform(random, -0.35, 0.35) * body.box().sizes()[i];
  track.reach += (track.centre - body.box().center()).norm();
  return track;
}

/// A blade along the tool's z axis.
Matrix3Xd straightBlade(double from, double to) {
  Matrix3Xd edge(3, 2);
  edge << 0, 0, 0, 0, from, to;
  return edge;
}

/// A blade of some segments that bulges in the direction of travel, so that a straight stroke is still flat.
Matrix3Xd bowedBlade(double half_length, double bow, int segments) {
  Matrix3Xd edge(3, segments + 1);
  for (int i = 0; i <= segments; ++i) {
    const double z = 2.0 * i / segments - 1;
    edge.col(i) = Vector3d(bow * (1 - z * z), 0, half_length * z);
  }
  return edge;
}

TortureCut strokeCut(Matrix3Xd edge, std::vector<Isometry3d> poses, const TortureBody& body,
                     TortureRandom& random) {
  TortureCut cut;
  cut.operation = SweepCut{std::move(edge), std::move(poses)};
  cut.is_progressive = pick(random, 2) == 0;
  if (pick(random, 4) == 0) cut.deformation = someDeformation(body, random);
  return cut;
}

int someSteps(TortureRandom& random) {
  const int counts[] = {1, 2, 5, 12, 40, 90};
  return counts[pick(random, 6)];
}

TortureCut flatStroke(const TortureBody& body, TortureRandom& random, int steps,
                      const std::function<double(double)>& along) {
  const Track track = someTrack(body, random);
  std::vector<Isometry3d> poses;
  for (int i = 0; i <= steps; ++i)
    poses.push_back(track.pose(1.3 * track.reach * along(static_cast<double>(i) / steps)));
  const Matrix3Xd edge = pick(random, 2) ? straightBlade(-track.reach, track.reach)
                                         : bowedBlade(track.reach, 0.2 * track.reach, 1 + pick(random, 6));
  return strokeCut(edge, poses, body, random);
}

Separator flatSeparator(const TortureCut& cut) {
  const auto& sweep = std::get<SweepCut>(cut.operation);
  const Vector3d point = sweep.T_world_tool.front().translation();
  const Vector3d normal = sweep.T_world_tool.front().linear().col(1);
  return {[point, normal](const Vector3d& x) { return normal.dot(x - point); }, 0};
}

TortureCut throughStraight(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  TortureCut cut = flatStroke(body, random, someSteps(random), [](double s) { return 2 * s - 1; });
  cut.separator = flatSeparator(cut);
  return cut;
}

/// Half in, half the way back, and on through.
TortureCut throughAfterTurningBack(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const double depth = uniform(random, -0.5, 0.5), back = uniform(random, -1, depth);
  TortureCut cut = flatStroke(body, random, 3 * (2 + pick(random, 20)), [&](double s) {
    if (s < 1.0 / 3) return -1 + 3 * s * (depth + 1);
    if (s < 2.0 / 3) return depth + (3 * s - 1) * (back - depth);
    return back + (3 * s - 2) * (1 - back);
  });
  cut.separator = flatSeparator(cut);
  return cut;
}

TortureCut curvedThrough(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const Track track = someTrack(body, random);
  const int steps = 30 + pick(random, 50);
  const double swing = uniform(random, 0, 0.12) * track.reach, waves = uniform(random, 1, 4),
               phase = uniform(random, 0, 6);
  const auto path = [=](int count) {
    std::vector<Isometry3d> poses;
    for (int i = 0; i <= count; ++i) {
      const double along = 1.3 * track.reach * (2.0 * i / count - 1);
      poses.push_back(track.pose(along, swing * std::sin(waves * along / track.reach + phase)));
    }
    return poses;
  };
  std::vector<std::pair<double, double>> corners;
  for (const Isometry3d& pose : path(steps)) {
    const Vector3d local = track.axes.transpose() * (pose.translation() - track.centre);
    corners.emplace_back(local.x(), local.y());
  }
  TortureCut cut = strokeCut(straightBlade(-track.reach, track.reach), path(steps), body, random);
  cut.path = path;
  const double steepest = 0.12 * 4;
  // An edge may be crossed twice by a bend, and then it is not cut: half the sag of the bend over an edge.
  cut.separator = {[=](const Vector3d& x) {
                     const double along = track.axes.col(0).dot(x - track.centre);
                     const double across = track.axes.col(1).dot(x - track.centre);
                     std::size_t i = 0;
                     while (i + 2 < corners.size() && corners[i + 1].first < along) ++i;
                     const auto [x0, y0] = corners[i];
                     const auto [x1, y1] = corners[i + 1];
                     const double y = y0 + (y1 - y0) * (along - x0) / (x1 - x0);
                     return (across - y) / std::sqrt(1 + steepest * steepest);
                   },
                   0.2};
  return cut;
}

/// Turns around its way, by up to two turns, in few steps.
TortureCut twisted(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const Track track = someTrack(body, random);
  const int steps = 4 + pick(random, 12);
  const double rate = uniform(random, -2 * M_PI, 2 * M_PI) / (2.6 * track.reach);
  std::vector<Isometry3d> poses;
  for (int i = 0; i <= steps; ++i) {
    const double along = 1.3 * track.reach * (2.0 * i / steps - 1);
    poses.push_back(track.pose(along, 0, rate * along));
  }
  TortureCut cut = strokeCut(straightBlade(-1.5 * track.reach, 1.5 * track.reach), poses, body, random);
  cut.separator = {[=](const Vector3d& x) {
                     const Vector3d local = track.axes.transpose() * (x - track.centre);
                     const double turn = rate * local.x();
                     const double across = std::cos(turn) * local.y() + std::sin(turn) * local.z();
                     const double radius = local.tail<2>().norm();
                     return across / std::sqrt(1 + std::pow(rate * radius, 2));
                   },
                   0.4};
  return cut;
}

TortureCut stopsInside(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const double depth = uniform(random, -0.6, 0.6);
  return flatStroke(body, random, someSteps(random), [&](double s) { return -1 + s * (depth + 1); });
}

TortureCut inAndOutAgain(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const double depth = uniform(random, -0.6, 0.6);
  return flatStroke(body, random, 2 * someSteps(random),
                    [&](double s) { return -1 + 2 * std::min(s, 1 - s) * (depth + 1); });
}

/// In, and out by another way: a wedge.
TortureCut vTurn(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const Track track = someTrack(body, random);
  const int steps = 6 + pick(random, 40);
  const double depth = uniform(random, -0.5, 0.5), spread = uniform(random, 0.02, 0.5) * track.reach;
  std::vector<Isometry3d> poses;
  for (int i = 0; i <= 2 * steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    const double in = s < 1 ? s : 2 - s;
    poses.push_back(track.pose(track.reach * (-1.3 + in * (depth + 1.3)), s < 1 ? 0 : (s - 1) * spread));
  }
  TortureCut cut = strokeCut(straightBlade(-track.reach, track.reach), poses, body, random);
  // What lies between the two sheets on one side, all else on the other.
  const Vector3d way_out(-(depth + 1.3) * track.reach, spread, 0);
  const Vector3d normal_out = Vector3d(way_out.y(), -way_out.x(), 0).normalized();
  cut.separator = {[=](const Vector3d& x) {
                     Vector3d local = track.axes.transpose() * (x - track.centre);
                     local.x() -= depth * track.reach;
                     return std::min(local.y(), -normal_out.dot(local));
                   },
                   0};
  return cut;
}

TortureCut crossesItself(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const Track track = someTrack(body, random);
  const int steps = 20 + pick(random, 60);
  const double radius = uniform(random, 0.1, 0.4) * track.reach;
  std::vector<Isometry3d> poses;
  for (int i = 0; i <= steps; ++i) {  // a cycloid with a loop in its middle
    const double angle = 3.5 * M_PI * (2.0 * i / steps - 1);
    const double along = 0.15 * track.reach * angle - radius * std::sin(angle);
    poses.push_back(track.pose(along, radius * std::cos(angle)));
  }
  return strokeCut(straightBlade(-track.reach, track.reach), poses, body, random);
}

/// The last stroke once more, at other steps; a plane where the last cut was none.
TortureCut repeatsTheLast(const TortureBody& body, const TortureCut* last, TortureRandom& random) {
  if (!last || !std::holds_alternative<SweepCut>(last->operation)) {
    if (last) {
      TortureCut cut = *last;
      cut.is_repeat = !cut.deformation;
      return cut;
    }
    return throughStraight(body, nullptr, random);
  }
  TortureCut cut = *last;
  const auto& former = std::get<SweepCut>(last->operation).T_world_tool;
  std::vector<Isometry3d> poses;
  const int parts = 1 + pick(random, 4);
  if (last->path) {
    poses = last->path(30 + pick(random, 50));
  } else {
    for (std::size_t i = 0; i + 1 < former.size(); ++i) {
      for (int j = 0; j < parts; ++j)
        poses.push_back(interpolate(former[i], former[i + 1], static_cast<double>(j) / parts));
    }
    poses.push_back(former.back());
  }
  if (pick(random, 3) == 0) std::reverse(poses.begin(), poses.end());
  std::get<SweepCut>(cut.operation).T_world_tool = poses;
  cut.is_progressive = pick(random, 2) == 0;
  cut.is_repeat = !cut.deformation;
  return cut;
}

/// The end of a short blade goes to a corner of the body and back, or past it.
TortureCut touchesACorner(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const PolyhedralMesh& mesh = body.mesh();
  const Vector3d corner = mesh.restPosition(VertexId(pick(random, mesh.numVertices())));
  Track track = someTrack(body, random);
  track.centre = corner;
  const double length = uniform(random, 0.5, 4) * body.size(), way = uniform(random, 0.5, 4) * body.size();
  const bool is_past = pick(random, 2);
  const int steps = 1 + pick(random, 8);
  std::vector<Isometry3d> poses;
  for (int i = -steps; i <= steps; ++i)
    poses.push_back(track.pose(is_past ? way * i / steps : -std::abs(way * i / steps)));
  return strokeCut(straightBlade(0, length), poses, body, random);
}

/// In the plane of a boundary face, along its first edge.
TortureCut inTheSurface(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const PolyhedralMesh& mesh = body.mesh();
  FaceId id;
  do id = FaceId(pick(random, mesh.faceCapacity()));
  while (!mesh.face(id).isAlive() || !mesh.face(id).isBoundary());
  const auto& loop = mesh.face(id).loop;
  const Vector3d a = mesh.restPosition(loop[0]), b = mesh.restPosition(loop[1]);
  const Vector3d blade = (b - a).normalized();
  // Of the whole face: three vertices that follow each other may lie in one line.
  const Vector3d area = planeOf(mesh.face(id), mesh.restPositions()).second;
  const Vector3d normal = (area - blade.dot(area) * blade).normalized();
  Track track;
  track.axes.col(2) = blade;
  track.axes.col(1) = normal;
  track.axes.col(0) = normal.cross(blade);
  track.centre = a;
  track.reach = body.box().diagonal().norm();
  const int steps = someSteps(random);
  std::vector<Isometry3d> poses;
  for (int i = 0; i <= steps; ++i) poses.push_back(track.pose(track.reach * (2.0 * i / steps - 1)));
  TortureCut cut = strokeCut(straightBlade(-track.reach, track.reach), poses, body, random);
  cut.deformation.reset();
  return cut;
}

/// The blade lies on an edge of the mesh at one moment.
TortureCut entersAlongAnEdge(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const PolyhedralMesh& mesh = body.mesh();
  FaceId id;
  do id = FaceId(pick(random, mesh.faceCapacity()));
  while (!mesh.face(id).isAlive() || !mesh.face(id).isBoundary());
  const Vector3d a = mesh.restPosition(mesh.face(id).loop[0]), b = mesh.restPosition(mesh.face(id).loop[1]);
  Track track = someTrack(body, random);
  track.centre = a;
  track.axes.col(2) = (b - a).normalized();
  track.axes.col(1) = track.axes.col(2).cross(track.axes.col(0)).normalized();
  track.axes.col(0) = track.axes.col(1).cross(track.axes.col(2));
  track.reach = body.box().diagonal().norm();
  const int steps = 1 + pick(random, 8);
  std::vector<Isometry3d> poses;
  for (int i = -steps; i <= steps; ++i) poses.push_back(track.pose(track.reach * i / steps));
  const bool is_long = pick(random, 2);
  const Matrix3Xd edge =
      is_long ? straightBlade(-track.reach, track.reach) : straightBlade(0, (b - a).norm());
  TortureCut cut = strokeCut(edge, poses, body, random);
  cut.deformation.reset();
  if (is_long) {
    cut.separator = flatSeparator(cut);
  }
  return cut;
}

/// A blade smaller than a face goes through it and touches no edge.
TortureCut tipThroughAFace(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const PolyhedralMesh& mesh = body.mesh();
  FaceId id;
  do id = FaceId(pick(random, mesh.faceCapacity()));
  while (!mesh.face(id).isAlive());
  Vector3d middle = Vector3d::Zero();
  for (const VertexId v : mesh.face(id).loop) middle += mesh.restPosition(v);
  middle /= mesh.face(id).loop.size();
  Track track = someTrack(body, random);
  track.centre = middle;
  const double half = uniform(random, 0.01, 0.15) * body.size(),
               way = uniform(random, 0.05, 0.6) * body.size();
  std::vector<Isometry3d> poses;
  for (int i = -3; i <= 3; ++i) poses.push_back(track.pose(way * i / 3));
  return strokeCut(straightBlade(-half, half), poses, body, random);
}

/// Poses that repeat, and others hardly apart; all the same it goes through.
TortureCut hesitates(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const Track track = someTrack(body, random);
  std::vector<Isometry3d> poses;
  const int stops = 1 + pick(random, 20);
  for (int i = 0; i <= stops; ++i) {
    const double along = 1.3 * track.reach * (2.0 * i / stops - 1);
    for (int j = pick(random, 3); j >= 0; --j) poses.push_back(track.pose(along));
    if (pick(random, 2)) poses.push_back(track.pose(along + 1e-12 * track.reach));
  }
  TortureCut cut = strokeCut(straightBlade(-track.reach, track.reach), poses, body, random);
  cut.separator = flatSeparator(cut);
  return cut;
}

/// Stands still in the body.
TortureCut standsStill(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const Track track = someTrack(body, random);
  return strokeCut(straightBlade(-track.reach, track.reach), {track.pose(0), track.pose(0), track.pose(0)},
                   body, random);
}

/// Through everything in one step of up to a thousand times the body's size.
TortureCut veryFast(const TortureBody& body, const TortureCut*, TortureRandom& random) {
  const Track track = someTrack(body, random);
  const double way = track.reach * std::pow(10.0, uniform(random, 0.5, 3));
  TortureCut cut =
      strokeCut(straightBlade(-track.reach, track.reach), {track.pose(-way), track.pose(way)}, body, random);
  cut.separator = flatSeparator(cut);
  return cut;
}

}  // namespace

Vector3d someDirection(TortureRandom& random) {
  for (;;) {
    const Vector3d v(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
    if (v.norm() <= 1 && v.norm() > 0.1) return v.normalized();
  }
}

Matrix3d someFrame(TortureRandom& random) {
  Matrix3d axes;
  axes.col(0) = someDirection(random);
  do axes.col(2) = axes.col(0).cross(someDirection(random));
  while (axes.col(2).norm() < 0.1);
  axes.col(2).normalize();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

SmoothDeformation someDeformation(const TortureBody& body, TortureRandom& random) {
  SmoothDeformation map;
  const double wave = uniform(random, 1, 4) / body.box().sizes().maxCoeff();
  for (int i = 0; i < 3; ++i) {
    map.wave.row(i) = wave * someDirection(random).transpose();
    map.phase[i] = uniform(random, 0, 6);
  }
  map.amplitude_m = uniform(random, 0.05, 0.4) / wave;
  return map;
}

std::vector<TortureKind> tortureStrokes() {
  return {{"stroke straight through", throughStraight},
          {"stroke that turns back, then goes through", throughAfterTurningBack},
          {"stroke curved through", curvedThrough},
          {"stroke twisted at coarse steps", twisted},
          {"stroke that stops inside", stopsInside},
          {"stroke in and out again", inAndOutAgain},
          {"stroke in and out by another way", vTurn},
          {"stroke that crosses itself", crossesItself},
          {"the last cut again, at other steps", repeatsTheLast},
          {"stroke that touches a corner", touchesACorner},
          {"stroke in the surface", inTheSurface},
          {"stroke along an edge", entersAlongAnEdge},
          {"tip through a face, no edge", tipThroughAFace},
          {"stroke that hesitates", hesitates},
          {"blade that stands still", standsStill},
          {"stroke of one very fast step", veryFast}};
}

}  // namespace polyscalpel
