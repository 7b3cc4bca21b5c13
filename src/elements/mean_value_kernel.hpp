// SPDX-License-Identifier: BSD-3-Clause
//
// The arithmetic of mean value coordinates, for points side by side in the lanes of a Real. Compiled once for
// every machine and once for wider registers (mean_value_kernel_avx2.cpp, _avx512.cpp), so all that is here
// has internal linkage or depends on Real: nothing compiled for wide registers may end up elsewhere in the
// program.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "pack.hpp"

namespace polyscalpel {

template <class T>
struct Vector3 {
  T x, y, z;
};
template <class T>
static inline Vector3<T> operator+(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
static inline Vector3<T> operator-(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T, class U>
static inline auto operator*(const Vector3<T>& a, const U& s) -> Vector3<decltype(a.x * s)> {
  return {a.x * s, a.y * s, a.z * s};
}
template <class T, class U>
static inline auto dot(const Vector3<T>& a, const Vector3<U>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T, class U>
static inline auto cross(const Vector3<T>& a, const Vector3<U>& b) -> Vector3<decltype(a.x * b.x)> {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The angle atan2(s, t) in [0, pi] between two vectors with sine part s >= 0, cosine part t and s^2 + t^2 =
/// p^2.
template <class Scalar>
static inline SinglePack<Scalar> angle(SinglePack<Scalar> s, SinglePack<Scalar> t, SinglePack<Scalar>) {
  return std::atan2(s[0], t[0]);
}

/// Without branches, so that the lanes go side by side. The angle's distance from the nearest multiple of pi
/// / 2 has a half with the tangent z = min(s, |t|) / (p + max(s, |t|)) <= tan(pi / 8), where an odd
/// polynomial is exact to 4e-18.
template <int kWidth>
static inline Pack<kWidth> angle(Pack<kWidth> s, Pack<kWidth> t, Pack<kWidth> p) {
  using Real = Pack<kWidth>;
  constexpr double kPi = 3.14159265358979323846;
  // Interpolates atan(z) / z in the twelve Chebyshev nodes of z^2 in [0, tan(pi / 8)^2].
  constexpr double kCoefficients[] = {
      1.00000000000000000000e+00,  -3.33333333333331205406e-01, 1.99999999999408928364e-01,
      -1.42857142792502445072e-01, 1.11111107449196583330e-01,  -9.09089680906402658467e-02,
      7.69204533090222519753e-02,  -6.66295181362919070045e-02, 5.84687829733087222062e-02,
      -5.03510245660155203451e-02, 3.79652574538659332015e-02,  -1.78053972054194459274e-02};
  const typename Real::Mask is_obtuse = t < 0;
  const Real magnitude = select(is_obtuse, 0 - t, t);
  const typename Real::Mask is_flat = s < magnitude;
  const Real z = select(is_flat, s, magnitude) / (p + select(is_flat, magnitude, s));
  const Real y = z * z;
  // Estrin's order: shorter chains than Horner's.
  const auto pair = [&](int i) { return kCoefficients[i] + kCoefficients[i + 1] * y; };
  const Real y2 = y * y;
  const Real y4 = y2 * y2;
  const Real low = pair(0) + pair(2) * y2;
  const Real middle = pair(4) + pair(6) * y2;
  const Real high = pair(8) + pair(10) * y2;
  const Real distance = 2 * z * (low + y4 * (middle + y4 * high));
  const Real acute = select(is_flat, distance, kPi / 2 - distance);
  return select(is_obtuse, kPi - acute, acute);
}

/// A triangle whose plane is seen under a smaller angle [rad], and whose solid-angle vector m is smaller than
/// kSmallSolidAngle, is seen edge-on from beside it. Its weights tend to zero there, as quotients of two
/// vanishing numbers; they are left out where rounding has eaten half of their digits.
template <class Scalar>
static const Scalar kEdgeOnAngle = std::sqrt(std::numeric_limits<Scalar>::epsilon());
constexpr double kSmallSolidAngle = 1e-4;

/// Below this (s / p)^2 an acute angle is so small that the derivative of angle / s takes the first term of
/// its series.
constexpr double kSmallSineSquared = 1e-8;

/// A closed triangle surface, relative to a point inside. Vertices: first the real ones, then the virtual
/// ones.
template <class Scalar>
struct MeanValueSurface {
  struct Edge {
    int start, end;
    int left, right;            // the triangles that run along it forwards and backwards
    Vector3<Scalar> direction;  // from start to end
  };
  struct Triangle {
    std::array<int, 3> corners;
    std::array<int, 3> edges;     // opposite to each corner
    std::array<Scalar, 3> signs;  // -1 where the triangle runs along the edge backwards
    Vector3<Scalar> normal;       // length: twice the area
    Scalar squared_normal;
  };

  const Vector3<Scalar>* vertices;
  const Edge* edges;
  const Triangle* triangles;
  // Parents of virtual vertex i: parents[first_parent[i]] to before first_parent[i + 1].
  const int* first_parent;
  const int* parents;
  int num_vertices, num_real, num_edges, num_triangles;
};

/// Evaluates at points (3 x count): values n x count, gradients 3n x count, n = surface.num_real. room: of
/// MeanValueKernel::roomSize() Reals.
template <class Scalar>
using MeanValueEvaluation = void (*)(const MeanValueSurface<Scalar>& surface, const Scalar* points, int count,
                                     void* room, Scalar* values, Scalar* gradients);

/// The evaluation with 4 or 8 doubles side by side, or nullptr where compiler or processor cannot. Bit for
/// bit the same numbers.
MeanValueEvaluation<double> avx2MeanValueEvaluation();
MeanValueEvaluation<double> avx512MeanValueEvaluation();

template <class Real, class Scalar>
class MeanValueKernel {
 public:
  using Surface = MeanValueSurface<Scalar>;
  using RealVector = Vector3<Real>;

  static int roomSize(int num_vertices, int num_edges, int num_triangles) {
    return 9 * num_vertices + 3 * num_edges + 12 * num_triangles;
  }
  static void evaluate(const Surface& surface, const Scalar* points, int count, void* room, Scalar* values,
                       Scalar* gradients) {
    MeanValueKernel kernel(surface, static_cast<Real*>(room));
    for (int first = 0; first < count; first += Real::kSize) {
      kernel.evaluateBatch(points, first, count - first < Real::kSize ? count - first : Real::kSize, values,
                           gradients);
    }
  }

 private:
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

  MeanValueKernel(const Surface& surface, Real* room) : surface_(surface) {
    const auto take = [&](int count) {
      Real* const taken = room;
      room += count;
      return taken;
    };
    const int n = surface.num_vertices;
    offset = reinterpret_cast<RealVector*>(take(3 * n));
    gradient = reinterpret_cast<RealVector*>(take(3 * n));
    length = take(n);
    inverse_square = take(n);
    weight = take(n);
    normal = reinterpret_cast<RealVector*>(take(3 * surface.num_edges));
    moments = reinterpret_cast<Moment*>(take(12 * surface.num_triangles));
  }

  void evaluateBatch(const Scalar* points, int first, int count, Scalar* values, Scalar* gradients);
  void evaluateVertices(const RealVector& x);
  void evaluateEdges();
  void addTriangles();
  void handToParents();

  const Surface& surface_;
  // At the current points, one entry a vertex, edge or triangle.
  RealVector* offset;    // q = p - x
  RealVector* gradient;  // of w
  Real* length;
  Real* inverse_square;  // 1 / |q|^2
  Real* weight;          // w
  RealVector* normal;    // c = q_start x q_end
  Moment* moments;
};

template <class Real, class Scalar>
void MeanValueKernel<Real, Scalar>::evaluateVertices(const RealVector& x) {
  for (int i = 0; i < surface_.num_vertices; ++i) {
    const Vector3<Scalar>& p = surface_.vertices[i];
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
template <class Real, class Scalar>
void MeanValueKernel<Real, Scalar>::evaluateEdges() {
  for (int k = 0; k < surface_.num_triangles; ++k) moments[k] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  for (int i = 0; i < surface_.num_edges; ++i) {
    const typename Surface::Edge& edge = surface_.edges[i];
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
template <class Real, class Scalar>
void MeanValueKernel<Real, Scalar>::addTriangles() {
  for (int k = 0; k < surface_.num_triangles; ++k) {
    const typename Surface::Triangle& triangle = surface_.triangles[k];
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

template <class Real, class Scalar>
void MeanValueKernel<Real, Scalar>::handToParents() {
  const int num_real = surface_.num_real;
  for (int i = 0; num_real + i < surface_.num_vertices; ++i) {
    const int first = surface_.first_parent[i], last = surface_.first_parent[i + 1];
    const Scalar share = Scalar(1) / (last - first);
    const Real w = weight[num_real + i] * share;
    const RealVector g = gradient[num_real + i] * share;
    for (int k = first; k < last; ++k) {
      const int parent = surface_.parents[k];
      weight[parent] = weight[parent] + w;
      gradient[parent] = gradient[parent] + g;
    }
  }
}

template <class Real, class Scalar>
void MeanValueKernel<Real, Scalar>::evaluateBatch(const Scalar* points, int first, int count, Scalar* values,
                                                  Scalar* gradients) {
  // Lanes beyond the last point repeat it, so that a point takes the same way whatever comes after it.
  RealVector x{0, 0, 0};
  for (int lane = 0; lane < Real::kSize; ++lane) {
    const Scalar* const point = points + 3 * (first + (lane < count ? lane : count - 1));
    x.x.set(lane, point[0]);
    x.y.set(lane, point[1]);
    x.z.set(lane, point[2]);
  }
  evaluateVertices(x);
  evaluateEdges();
  addTriangles();
  handToParents();

  const int n = surface_.num_real;
  Real sum = 0;
  RealVector sum_gradient{0, 0, 0};
  for (int i = 0; i < n; ++i) {
    sum = sum + weight[i];
    sum_gradient = sum_gradient + gradient[i];
  }
  const Real inverse = 1 / sum;
  for (int i = 0; i < n; ++i) {
    const RealVector& g = gradient[i];
    const Real value = weight[i] * inverse;
    const Real gx = (g.x - value * sum_gradient.x) * inverse;
    const Real gy = (g.y - value * sum_gradient.y) * inverse;
    const Real gz = (g.z - value * sum_gradient.z) * inverse;
    for (int lane = 0; lane < count; ++lane) {
      const int k = (first + lane) * n + i;
      values[k] = value[lane];
      gradients[3 * k] = gx[lane];
      gradients[3 * k + 1] = gy[lane];
      gradients[3 * k + 2] = gz[lane];
    }
  }
}

}  // namespace polyscalpel
