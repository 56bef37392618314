// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/quadratic_element.hpp"

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// Derivatives of the barycentric coordinates along the edges from corner 0.
constexpr std::array<Vec3, 4> corner_step{{{-1, -1, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

OfCellNodes<Vec3> in_space(const OfCellNodes<Vec3>& derivative, const std::array<Vec3, 3>& dual) {
  OfCellNodes<Vec3> result;
  for (std::size_t k = 0; k < 10; ++k)
    result[k] = derivative[k].x * dual[0] + derivative[k].y * dual[1] + derivative[k].z * dual[2];
  return result;
}

std::array<CellPoint, 14> make_cell_points() {
  constexpr double a = 0.31088591926330060980, weight_a = 0.11268792571801585080;
  constexpr double b = 0.092735250310891226402, weight_b = 0.073493043116361949544;
  constexpr double c = 0.045503704125649649492, weight_c = 0.042546020777081466438;
  std::array<CellPoint, 14> points{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<double, 4> near_face{a, a, a, a}, near_corner{b, b, b, b};
    near_face[i] = 1 - 3 * a;
    near_corner[i] = 1 - 3 * b;
    points[n++] = cell_point(near_face, weight_a);
    points[n++] = cell_point(near_corner, weight_b);
  }
  for (const auto& [i, j] : mesh::tet::edge_to_corner) {
    std::array<double, 4> near_edge{0.5 - c, 0.5 - c, 0.5 - c, 0.5 - c};
    near_edge[at(i)] = near_edge[at(j)] = c;
    points[n++] = cell_point(near_edge, weight_c);
  }
  return points;
}

std::array<CellPoint, 10> make_nodes_as_points() {
  std::array<CellPoint, 10> points{};
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<double, 4> corner{};
    corner[k] = 1;
    points[k] = cell_point(corner);
  }
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [i, j] = mesh::tet::edge_to_corner[e];
    std::array<double, 4> middle{};
    middle[at(i)] = middle[at(j)] = 0.5;
    points[4 + e] = cell_point(middle);
  }
  return points;
}

std::array<FacePoint, 12> make_face_points() {
  std::array<FacePoint, 12> points{};
  std::size_t n = 0;
  const auto add_three = [&](double a, double weight) {
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<double, 3> l{a, a, a};
      l[i] = 1 - 2 * a;
      points[n++] = face_point(l, weight);
    }
  };
  add_three(0.249286745170910, 0.116786275726379);
  add_three(0.063089014491502, 0.050844906370207);
  constexpr double a = 0.053145049844817, b = 0.310352451033784, c = 1 - a - b, weight = 0.082851075618374;
  for (const auto& l :
       std::array<std::array<double, 3>, 6>{{{a, b, c}, {b, c, a}, {c, a, b}, {a, c, b}, {c, b, a}, {b, a, c}}})
    points[n++] = face_point(l, weight);
  return points;
}

}  // namespace

FacePoint face_point(const std::array<double, 3>& l, double weight) {
  FacePoint point{l, {}, {}, {}, weight};
  constexpr std::array<std::array<std::size_t, 2>, 3> edges{{{0, 1}, {1, 2}, {2, 0}}};
  constexpr std::array<std::array<double, 3>, 2> step{{{-1, 1, 0}, {-1, 0, 1}}};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [i, j] = edges[k];
    point.value[k] = l[k] * (2 * l[k] - 1);
    point.value[3 + k] = 4 * l[i] * l[j];
    point.along_1[k] = (4 * l[k] - 1) * step[0][k];
    point.along_2[k] = (4 * l[k] - 1) * step[1][k];
    point.along_1[3 + k] = 4 * (step[0][i] * l[j] + l[i] * step[0][j]);
    point.along_2[3 + k] = 4 * (step[1][i] * l[j] + l[i] * step[1][j]);
  }
  return point;
}

CellPoint cell_point(const std::array<double, 4>& l, double weight) {
  CellPoint point{{}, {}, weight, l};
  for (std::size_t k = 0; k < 4; ++k) {
    point.value[k] = l[k] * (2 * l[k] - 1);
    point.derivative[k] = (4 * l[k] - 1) * corner_step[k];
  }
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [i, j] = mesh::tet::edge_to_corner[e];
    point.value[4 + e] = 4 * l[at(i)] * l[at(j)];
    point.derivative[4 + e] = 4 * (l[at(j)] * corner_step[at(i)] + l[at(i)] * corner_step[at(j)]);
  }
  return point;
}

const std::array<CellPoint, 14>& cell_points() {
  static const auto points = make_cell_points();
  return points;
}

const std::array<CellPoint, 10>& cell_nodes_as_points() {
  static const auto points = make_nodes_as_points();
  return points;
}

const std::array<FacePoint, 12>& face_points() {
  static const auto points = make_face_points();
  return points;
}

PlacedPoint place(const OfCellNodes<Vec3>& node, const CellPoint& point) {
  PlacedPoint placed;
  std::array<Vec3, 3> along{};
  for (std::size_t k = 0; k < 10; ++k) {
    placed.position += point.value[k] * node[k];
    for (std::size_t axis = 0; axis < 3; ++axis) along[axis] += point.derivative[k][axis] * node[k];
  }
  const auto normal = cross(along[1], along[2]);
  placed.jacobian = dot(along[0], normal);
  const double inverse = 1 / placed.jacobian;
  placed.dual = {inverse * normal, inverse * cross(along[2], along[0]), inverse * cross(along[0], along[1])};
  placed.gradient = in_space(point.derivative, placed.dual);
  return placed;
}

CubicPoint cubic_point(const std::array<double, 4>& l) {
  CubicPoint point;
  for (std::size_t e = 0; e < 6; ++e) {
    const auto a = at(mesh::tet::edge_to_corner[e][0]), b = at(mesh::tet::edge_to_corner[e][1]);
    point.value[e] = l[a] * l[b] * (l[a] - l[b]);
    point.derivative[e] = (2 * l[a] - l[b]) * l[b] * corner_step[a] + (l[a] - 2 * l[b]) * l[a] * corner_step[b];
  }
  for (std::size_t f = 0; f < 4; ++f) {
    const auto& corner = mesh::tet::face_to_corner[f];
    const auto a = at(corner[0]), b = at(corner[1]), c = at(corner[2]);
    point.value[6 + f] = l[a] * l[b] * l[c];
    point.derivative[6 + f] =
        l[b] * l[c] * corner_step[a] + l[a] * l[c] * corner_step[b] + l[a] * l[b] * corner_step[c];
  }
  return point;
}

const std::array<CubicPoint, 14>& cubic_points() {
  static const auto points = [] {
    std::array<CubicPoint, 14> result;
    for (std::size_t k = 0; k < result.size(); ++k) result[k] = cubic_point(cell_points()[k].barycentric);
    return result;
  }();
  return points;
}

OfCellNodes<Vec3> gradients(const PlacedPoint& placed, const CubicPoint& point) {
  return in_space(point.derivative, placed.dual);
}

PlacedFacePoint place(const OfFaceNodes<Vec3>& node, const FacePoint& point) {
  PlacedFacePoint placed;
  Vec3 along_1, along_2;
  for (std::size_t k = 0; k < 6; ++k) {
    placed.position += point.value[k] * node[k];
    along_1 += point.along_1[k] * node[k];
    along_2 += point.along_2[k] * node[k];
  }
  const auto normal = cross(along_1, along_2);
  const double size = norm(normal);
  placed.normal = (1 / size) * normal;
  placed.area = 0.5 * size * point.weight;
  placed.middle = placed.position;
  return placed;
}

}  // namespace pamr::poisson_boltzmann
