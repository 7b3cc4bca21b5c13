// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/mean_value_coordinates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

#include "pack.hpp"
#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {
namespace {

/// double goes in pairs of points; long double alone.
template <class Scalar>
using PackOf = std::conditional_t<std::is_same_v<Scalar, double>, Pack, SinglePack<Scalar>>;

template <class T>
struct Vector3 {
  T x, y, z;
};
template <class T>
Vector3<T> operator+(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
Vector3<T> operator-(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T, class U>
auto operator*(const Vector3<T>& a, const U& s) -> Vector3<decltype(a.x * s)> {
  return {a.x * s, a.y * s, a.z * s};
}
template <class T, class U>
auto dot(const Vector3<T>& a, const Vector3<U>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T, class U>
auto cross(const Vector3<T>& a, const Vector3<U>& b) -> Vector3<decltype(a.x * b.x)> {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The angle atan2(s, t) in [0, pi] between two vectors with sine part s >= 0, cosine part t and s^2 + t^2 =
/// p^2.
template <class Scalar>
SinglePack<Scalar> angle(SinglePack<Scalar> s, SinglePack<Scalar> t, SinglePack<Scalar>) {
  return std::atan2(s[0], t[0]);
}

/// Without branches, so that the lanes go side by side. The angle's distance from the nearest multiple of pi
/// / 2 has a half with the tangent z = min(s, |t|) / (p + max(s, |t|)) <= tan(pi / 8), where an odd
/// polynomial is exact to 4e-18.
Pack angle(Pack s, Pack t, Pack p) {
  constexpr double kPi = 3.14159265358979323846;
  // Interpolates atan(z) / z in the twelve Chebyshev nodes of z^2 in [0, tan(pi / 8)^2].
  constexpr double kCoefficients[] = {
      1.00000000000000000000e+00,  -3.33333333333331205406e-01, 1.99999999999408928364e-01,
      -1.42857142792502445072e-01, 1.11111107449196583330e-01,  -9.09089680906402658467e-02,
      7.69204533090222519753e-02,  -6.66295181362919070045e-02, 5.84687829733087222062e-02,
      -5.03510245660155203451e-02, 3.79652574538659332015e-02,  -1.78053972054194459274e-02};
  const Pack::Mask is_obtuse = t < 0;
  const Pack magnitude = select(is_obtuse, 0 - t, t);
  const Pack::Mask is_flat = s < magnitude;
  const Pack z = select(is_flat, s, magnitude) / (p + select(is_flat, magnitude, s));
  const Pack y = z * z;
  // Estrin's order: shorter chains than Horner's.
  const auto pair = [&](int i) { return kCoefficients[i] + kCoefficients[i + 1] * y; };
  const Pack y2 = y * y;
  const Pack y4 = y2 * y2;
  const Pack low = pair(0) + pair(2) * y2;
  const Pack middle = pair(4) + pair(6) * y2;
  const Pack high = pair(8) + pair(10) * y2;
  const Pack distance = 2 * z * (low + y4 * (middle + y4 * high));
  const Pack acute = select(is_flat, distance, kPi / 2 - distance);
  return select(is_obtuse, kPi - acute, acute);
}

/// A triangle whose plane is seen under a smaller angle [rad], and whose solid-angle vector m is smaller than
/// kSmallSolidAngle, is seen edge-on from beside it. Its weights tend to zero there, as quotients of two
/// vanishing numbers; they are left out where rounding has eaten half of their digits.
template <class Scalar>
const Scalar kEdgeOnAngle = std::sqrt(std::numeric_limits<Scalar>::epsilon());
constexpr double kSmallSolidAngle = 1e-4;

/// Below this (s / p)^2 an acute angle is so small that the derivative of angle / s takes the first term of
/// its series.
constexpr double kSmallSineSquared = 1e-8;

}  // namespace

template <class Scalar>
struct MeanValueCoordinates<Scalar>::Kernel {
  using Real = PackOf<Scalar>;
  using RealVector = Vector3<Real>;
  using FixedVector = Vector3<Scalar>;

  struct Edge {
    int start, end;
    int left, right;        // the triangles that run along it forwards and backwards
    FixedVector direction;  // from start to end
  };
  struct Triangle {
    std::array<int, 3> corners;
    std::array<int, 3> edges;     // opposite to each corner
    std::array<Scalar, 3> signs;  // -1 where the triangle runs along the edge backwards
    FixedVector normal;           // length: twice the area
    Scalar squared_normal;
  };
  /// m = 1/2 sum of theta_i c_i / |c_i| over the edges of a triangle, or one edge's share, and the rows of
  /// its derivative.
  struct Moment {
    RealVector value;
    RealVector x_gradient, y_gradient, z_gradient;

    friend Moment operator+(const Moment& a, const Moment& b) {
      return {a.value + b.value, a.x_gradient + b.x_gradient, a.y_gradient + b.y_gradient,
              a.z_gradient + b.z_gradient};
    }
    friend Moment operator-(const Moment& a, const Moment& b) {
      return {a.value - b.value, a.x_gradient - b.x_gradient, a.y_gradient - b.y_gradient,
              a.z_gradient - b.z_gradient};
    }
  };

  // The surface.
  std::vector<FixedVector> vertices;
  std::vector<Edge> edges;
  std::vector<Triangle> triangles;
  std::vector<int>
      first_parent;  // parents of virtual vertex i: parents[first_parent[i]] to before first_parent[i + 1]
  std::vector<int> parents;
  std::vector<int> edge_table;
  int num_real = 0;

  // At the current points, one entry a vertex or edge.
  std::vector<RealVector> offset;  // q = p - x
  std::vector<Real> length;
  std::vector<Real> inverse_square;  // 1 / |q|^2
  std::vector<Real> weight;          // w
  std::vector<RealVector> gradient;  // of w
  std::vector<RealVector> normal;    // c = q_start x q_end
  std::vector<Moment> moments;       // one a triangle

  void setSurface(const CellSurface& surface, const Eigen::Vector3d& origin);
  int findOrAddEdge(int from, int to, int triangle);
  void evaluateVertices(const RealVector& x);
  void evaluateEdges();
  void addTriangles();
  void handToParents();
};

template <class Scalar>
void MeanValueCoordinates<Scalar>::Kernel::setSurface(const CellSurface& surface,
                                                      const Eigen::Vector3d& origin) {
  const int num_points = static_cast<int>(surface.points.cols());
  num_real = surface.num_vertices;
  POLYSCALPEL_ASSERT(num_points == num_real + static_cast<int>(surface.parents.size()));
  vertices.resize(num_points);
  for (int i = 0; i < num_points; ++i) {
    const Eigen::Matrix<Scalar, 3, 1> p = surface.points.col(i).cast<Scalar>() - origin.cast<Scalar>();
    vertices[i] = {p.x(), p.y(), p.z()};
  }
  first_parent.clear();
  parents.clear();
  for (const std::vector<int>& of_one : surface.parents) {
    first_parent.push_back(static_cast<int>(parents.size()));
    parents.insert(parents.end(), of_one.begin(), of_one.end());
  }
  first_parent.push_back(static_cast<int>(parents.size()));

  edges.clear();
  triangles.clear();
  edge_table.assign(num_points * num_points, -1);
  for (const std::array<int, 3>& corners : surface.triangles) {
    Triangle triangle;
    triangle.corners = corners;
    for (int i = 0; i < 3; ++i) {
      const int from = corners[(i + 1) % 3];
      const int to = corners[(i + 2) % 3];
      triangle.edges[i] = findOrAddEdge(from, to, static_cast<int>(triangles.size()));
      triangle.signs[i] = edges[triangle.edges[i]].start == from ? 1 : -1;
    }
    triangle.normal = cross(edges[triangle.edges[2]].direction * triangle.signs[2],
                            edges[triangle.edges[0]].direction * triangle.signs[0]);
    triangle.squared_normal = dot(triangle.normal, triangle.normal);
    triangles.push_back(triangle);
  }

  offset.resize(num_points);
  length.resize(num_points);
  inverse_square.resize(num_points);
  weight.resize(num_points);
  gradient.resize(num_points);
  normal.resize(edges.size());
  moments.resize(triangles.size());
}

/// The edge between two vertices; triangle: the one that runs along it from `from` to `to`.
template <class Scalar>
int MeanValueCoordinates<Scalar>::Kernel::findOrAddEdge(int from, int to, int triangle) {
  const int num_points = static_cast<int>(vertices.size());
  const auto [low, high] = std::minmax(from, to);
  POLYSCALPEL_ASSERT(low >= 0 && low < high && high < num_points);
  int& index = edge_table[low * num_points + high];
  if (index < 0) {
    index = static_cast<int>(edges.size());
    edges.push_back({low, high, -1, -1, vertices[high] - vertices[low]});
  }
  Edge& edge = edges[index];
  int& side = from == low ? edge.left : edge.right;
  POLYSCALPEL_ASSERT(side < 0);
  side = triangle;
  return index;
}

template <class Scalar>
void MeanValueCoordinates<Scalar>::Kernel::evaluateVertices(const RealVector& x) {
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const FixedVector& p = vertices[i];
    offset[i] = {p.x - x.x, p.y - x.y, p.z - x.z};
    const Real square = dot(offset[i], offset[i]);
    length[i] = sqrt(square);
    inverse_square[i] = 1 / square;
    weight[i] = 0;
    gradient[i] = {0, 0, 0};
  }
}

// With s = |c|, t = q_j . q_k and p = |q_j| |q_k| (s^2 + t^2 = p^2): dc = e x dx, ds = (c x e) . dx / s,
// dt = -(q_j + q_k) . dx, d theta = (t ds - s dt) / p^2, and for r = theta / s
//   grad r = (t / p^2 - r) / s^2 (c x e) + (q_j + q_k) / p^2,
// where for small angles the first factor tends to -2 / (3 p^3). The edge's share of m is r c / 2, with the
// derivative
//   c (outer) grad r / 2 + [r e / 2]_x.
template <class Scalar>
void MeanValueCoordinates<Scalar>::Kernel::evaluateEdges() {
  for (Moment& moment : moments) moment = Moment{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Edge& edge = edges[i];
    const RealVector& qj = offset[edge.start];
    const RealVector& qk = offset[edge.end];
    const RealVector c = cross(qj, qk);
    const Real square = dot(c, c);
    const Real s = sqrt(square);
    const Real t = dot(qj, qk);
    const Real p = length[edge.start] * length[edge.end];
    const Real inverse_p2 = inverse_square[edge.start] * inverse_square[edge.end];
    const Real inverse_s2 = 1 / square;
    Real r = angle(s, t, p) * s * inverse_s2;
    Real factor = (t * inverse_p2 - r) * inverse_s2;
    const auto is_small = square <= Scalar(kSmallSineSquared) * p * p && 0 < t;
    if (is_small.any()) {
      const Real inverse_p = p * inverse_p2;
      r = select(is_small && square <= 0, inverse_p, r);
      factor = select(is_small, Scalar(-2) / 3 * inverse_p * inverse_p2, factor);
    }
    const Real half_r = Scalar(0.5) * r;
    const RealVector h =
        cross(c, edge.direction) * (Scalar(0.5) * factor) + (qj + qk) * (Scalar(0.5) * inverse_p2);
    const RealVector turn = edge.direction * half_r;
    Moment share;
    share.value = c * half_r;
    share.x_gradient = {c.x * h.x, c.x * h.y - turn.z, c.x * h.z + turn.y};
    share.y_gradient = {c.y * h.x + turn.z, c.y * h.y, c.y * h.z - turn.x};
    share.z_gradient = {c.z * h.x - turn.y, c.z * h.y + turn.x, c.z * h.z};
    normal[i] = c;
    moments[edge.left] = moments[edge.left] + share;
    moments[edge.right] = moments[edge.right] - share;
  }
}

// w = Q^-1 m, where Q = (q_0 q_1 q_2) and row i of Q^-1 is c_i / D, D = det Q = q_0 . N. From Q w = m and dQ
// = -dx (1 1 1) follows dw = Q^-1 (dm + (w_0 + w_1 + w_2) dx).
template <class Scalar>
void MeanValueCoordinates<Scalar>::Kernel::addTriangles() {
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const Triangle& triangle = triangles[k];
    const Moment& moment = moments[k];
    const RealVector& m = moment.value;
    const Real determinant = dot(offset[triangle.corners[0]], triangle.normal);
    Real inverse = 1 / determinant;
    const Real reach = length[triangle.corners[0]] * kEdgeOnAngle<Scalar>;
    const auto is_edge_on = determinant * determinant <= triangle.squared_normal * (reach * reach) &&
                            dot(m, m) < Scalar(kSmallSolidAngle * kSmallSolidAngle);
    if (is_edge_on.any()) inverse = select(is_edge_on, 0, inverse);

    RealVector row[3];
    Real w[3];
    for (int i = 0; i < 3; ++i) {
      row[i] = normal[triangle.edges[i]] * (triangle.signs[i] * inverse);
      w[i] = dot(m, row[i]);
    }
    const Real sum = w[0] + w[1] + w[2];
    const RealVector x_gradient = {moment.x_gradient.x + sum, moment.x_gradient.y, moment.x_gradient.z};
    const RealVector y_gradient = {moment.y_gradient.x, moment.y_gradient.y + sum, moment.y_gradient.z};
    const RealVector z_gradient = {moment.z_gradient.x, moment.z_gradient.y, moment.z_gradient.z + sum};
    for (int i = 0; i < 3; ++i) {
      const int corner = triangle.corners[i];
      weight[corner] = weight[corner] + w[i];
      gradient[corner] =
          gradient[corner] + x_gradient * row[i].x + y_gradient * row[i].y + z_gradient * row[i].z;
    }
  }
}

template <class Scalar>
void MeanValueCoordinates<Scalar>::Kernel::handToParents() {
  for (std::size_t i = 0; i + 1 < first_parent.size(); ++i) {
    const Scalar share = Scalar(1) / (first_parent[i + 1] - first_parent[i]);
    const Real w = weight[num_real + i] * share;
    const RealVector g = gradient[num_real + i] * share;
    for (int k = first_parent[i]; k < first_parent[i + 1]; ++k) {
      weight[parents[k]] = weight[parents[k]] + w;
      gradient[parents[k]] = gradient[parents[k]] + g;
    }
  }
}

template <class Scalar>
MeanValueCoordinates<Scalar>::MeanValueCoordinates() : kernel_(std::make_unique<Kernel>()) {}
template <class Scalar>
MeanValueCoordinates<Scalar>::~MeanValueCoordinates() = default;
template <class Scalar>
MeanValueCoordinates<Scalar>::MeanValueCoordinates(MeanValueCoordinates&&) noexcept = default;
template <class Scalar>
MeanValueCoordinates<Scalar>& MeanValueCoordinates<Scalar>::operator=(MeanValueCoordinates&&) noexcept =
    default;

template <class Scalar>
void MeanValueCoordinates<Scalar>::setSurface(const CellSurface& surface) {
  origin_ = vertexMean(surface);
  num_vertices_ = surface.num_vertices;
  num_points_ = 0;
  kernel_->setSurface(surface, origin_);
}

template <class Scalar>
void MeanValueCoordinates<Scalar>::evaluate(const Eigen::Ref<const Matrix3X>& points) {
  using Real = typename Kernel::Real;
  constexpr int kWidth = Real::kSize;
  Kernel& kernel = *kernel_;
  num_points_ = points.cols();
  values_.resize(num_vertices_ * num_points_);
  gradients_.resize(3 * num_vertices_ * num_points_);
  for (Eigen::Index first = 0; first < num_points_; first += kWidth) {
    // Lanes beyond the last point repeat it, so that a point takes the same way whatever comes after it.
    const Eigen::Index count = std::min<Eigen::Index>(kWidth, num_points_ - first);
    Vector3<Real> x{0, 0, 0};
    for (int lane = 0; lane < kWidth; ++lane) {
      const Eigen::Index i = first + std::min<Eigen::Index>(lane, count - 1);
      x.x.set(lane, points(0, i));
      x.y.set(lane, points(1, i));
      x.z.set(lane, points(2, i));
    }
    kernel.evaluateVertices(x);
    kernel.evaluateEdges();
    kernel.addTriangles();
    kernel.handToParents();

    Real sum = 0;
    Vector3<Real> sum_gradient{0, 0, 0};
    for (Eigen::Index i = 0; i < num_vertices_; ++i) {
      sum = sum + kernel.weight[i];
      sum_gradient = sum_gradient + kernel.gradient[i];
    }
    const Real inverse = 1 / sum;
    for (Eigen::Index i = 0; i < num_vertices_; ++i) {
      const Vector3<Real>& g = kernel.gradient[i];
      const Real value = kernel.weight[i] * inverse;
      const Real gx = (g.x - value * sum_gradient.x) * inverse;
      const Real gy = (g.y - value * sum_gradient.y) * inverse;
      const Real gz = (g.z - value * sum_gradient.z) * inverse;
      for (int lane = 0; lane < count; ++lane) {
        const Eigen::Index k = (first + lane) * num_vertices_ + i;
        values_[k] = value[lane];
        gradients_[3 * k] = gx[lane];
        gradients_[3 * k + 1] = gy[lane];
        gradients_[3 * k + 2] = gz[lane];
      }
    }
  }
}

template class MeanValueCoordinates<double>;
template class MeanValueCoordinates<long double>;

}  // namespace polyscalpel
