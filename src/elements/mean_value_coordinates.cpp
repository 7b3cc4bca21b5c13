// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/mean_value_coordinates.hpp"

#include <algorithm>
#include <new>
#include <type_traits>
#include <vector>

#include "mean_value_kernel.hpp"
#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

template <class Scalar>
struct MeanValueCoordinates<Scalar>::Kernel {
  /// double goes in pairs of points on every machine; long double alone.
  using Real = std::conditional_t<std::is_same_v<Scalar, double>, Pack<2>, SinglePack<Scalar>>;
  using Surface = MeanValueSurface<Scalar>;
  using FixedVector = Vector3<Scalar>;
  static constexpr int kWidestReal = 8;

  struct Free {
    void operator()(void* room) const { ::operator delete(room, kAlignment); }
  };
  static constexpr std::align_val_t kAlignment{64};

  std::vector<FixedVector> vertices;
  std::vector<typename Surface::Edge> edges;
  std::vector<typename Surface::Triangle> triangles;
  std::vector<int> first_parent, parents, edge_table;
  int num_real = 0;
  MeanValueEvaluation<Scalar> evaluation = &MeanValueKernel<Real, Scalar>::evaluate;
  std::unique_ptr<void, Free> room;
  std::size_t room_bytes = 0;

  explicit Kernel(bool portable) {
    if constexpr (std::is_same_v<Scalar, double>) {
      if (portable) return;
      if (const auto wide = avx2MeanValueEvaluation()) evaluation = wide;
      if (const auto wide = avx512MeanValueEvaluation()) evaluation = wide;
    }
  }
  void setSurface(const CellSurface& surface, const Eigen::Vector3d& origin);
  int findOrAddEdge(int from, int to, int triangle);
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
  for (const auto& of_one : surface.parents) {
    first_parent.push_back(static_cast<int>(parents.size()));
    parents.insert(parents.end(), of_one.begin(), of_one.end());
  }
  first_parent.push_back(static_cast<int>(parents.size()));

  edges.clear();
  triangles.clear();
  edge_table.assign(num_points * num_points, -1);
  for (const std::array<int, 3>& corners : surface.triangles) {
    typename Surface::Triangle triangle;
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

  const std::size_t bytes =
      kWidestReal * sizeof(Scalar) *
      MeanValueKernel<Real, Scalar>::roomSize(num_points, static_cast<int>(edges.size()),
                                              static_cast<int>(triangles.size()));
  if (bytes <= room_bytes) return;
  room.reset(::operator new(bytes, kAlignment));
  room_bytes = bytes;
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
  typename Surface::Edge& edge = edges[index];
  int& side = from == low ? edge.left : edge.right;
  POLYSCALPEL_ASSERT(side < 0);
  side = triangle;
  return index;
}

template <class Scalar>
MeanValueCoordinates<Scalar>::MeanValueCoordinates(bool portable)
    : kernel_(std::make_unique<Kernel>(portable)) {}
template <class Scalar>
MeanValueCoordinates<Scalar>::~MeanValueCoordinates() = default;
template <class Scalar>
MeanValueCoordinates<Scalar>::MeanValueCoordinates(MeanValueCoordinates&&) noexcept = default;
template <class Scalar>
MeanValueCoordinates<Scalar>& MeanValueCoordinates<Scalar>::operator=(MeanValueCoordinates&&) noexcept =
    default;

template <class Scalar>
void MeanValueCoordinates<Scalar>::setSurface(const CellSurface& surface) {
  setSurface(surface, starCentre(surface));
}

template <class Scalar>
void MeanValueCoordinates<Scalar>::setSurface(const CellSurface& surface,
                                              const Eigen::Vector3d& star_centre) {
  origin_ = star_centre;
  num_vertices_ = surface.num_vertices;
  num_points_ = 0;
  kernel_->setSurface(surface, origin_);
}

template <class Scalar>
void MeanValueCoordinates<Scalar>::evaluate(const Eigen::Ref<const Matrix3X>& points) {
  Kernel& kernel = *kernel_;
  num_points_ = points.cols();
  values_.resize(num_vertices_ * num_points_);
  gradients_.resize(3 * num_vertices_ * num_points_);
  const MeanValueSurface<Scalar> surface = {kernel.vertices.data(),
                                            kernel.edges.data(),
                                            kernel.triangles.data(),
                                            kernel.first_parent.data(),
                                            kernel.parents.data(),
                                            static_cast<int>(kernel.vertices.size()),
                                            kernel.num_real,
                                            static_cast<int>(kernel.edges.size()),
                                            static_cast<int>(kernel.triangles.size())};
  POLYSCALPEL_ASSERT(points.outerStride() == 3);
  kernel.evaluation(surface, points.data(), static_cast<int>(num_points_), kernel.room.get(), values_.data(),
                    gradients_.data());
}

template class MeanValueCoordinates<double>;
template class MeanValueCoordinates<long double>;

}  // namespace polyscalpel
