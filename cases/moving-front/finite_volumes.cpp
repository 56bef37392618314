// SPDX-License-Identifier: GPL-3.0-or-later
#include "finite_volumes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace front {

namespace {

using Matrix = std::array<double, 6>;  // xx, yy, zz, xy, yz, zx

/// The solution of a symmetric system; zero where it is singular.
Vec3 solve(const Matrix& m, Vec3 b) {
  const auto [xx, yy, zz, xy, yz, zx] = m;
  const double a = yy * zz - yz * yz, d = yz * zx - xy * zz, e = xy * yz - yy * zx;
  const double determinant = xx * a + xy * d + zx * e;
  if (!(std::abs(determinant) > 1e-12 * xx * yy * zz)) return {};
  const double f = xx * zz - zx * zx, g = xy * zx - xx * yz, h = xx * yy - xy * xy;
  return (1 / determinant) *
         Vec3{a * b.x + d * b.y + e * b.z, d * b.x + f * b.y + g * b.z, e * b.x + g * b.y + h * b.z};
}

}  // namespace

FiniteVolumes::FiniteVolumes(const pamr::par::Comm& comm, const pamr::mesh::DistMesh& mesh, Vec3 velocity)
    : comm_(comm), mesh_(mesh) {
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    volume_.push_back(pamr::geometry::volume(p));
    centroid_.push_back(pamr::geometry::centroid(p));
    std::array<double, 4> flow{};
    std::array<Vec3, 4> middle;
    double outflow = 0;
    for (int f = 0; f < 4; ++f) {
      flow[at(f)] = dot(velocity, pamr::mesh::area_vector(p, f));
      middle[at(f)] = pamr::mesh::face_centroid(p, f);
      outflow += std::max(flow[at(f)], 0.0);
    }
    flow_.push_back(flow);
    middle_.push_back(middle);
    outflow_.push_back(outflow);
  }
  ghost_centroid_ = ghosts(centroid_);
}

double FiniteVolumes::time_step(double courant) const {
  double least = std::numeric_limits<double>::infinity();
  for (LocalId c = 0; c < n_cells(); ++c) least = std::min(least, volume_[at(c)] / outflow_[at(c)]);
  return courant * comm_.min(least);
}

Vec3 FiniteVolumes::limited_slope(LocalId cell, const std::vector<double>& value,
                                  const std::vector<double>& ghost) const {
  const double here = value[at(cell)];
  const auto center = centroid_[at(cell)];
  Matrix m{};
  Vec3 b;
  double low = here, high = here;
  for (std::size_t f = 0; f < 4; ++f) {
    const auto next = mesh_.cell_to_cell[at(cell)][f];
    const bool is_ghost = mesh_.is_ghost(next);
    const double there = next < 0 ? 0 : is_ghost ? ghost[at(next - n_cells())] : value[at(next)];
    const auto place = next < 0   ? middle_[at(cell)][f]
                       : is_ghost ? ghost_centroid_[at(next - n_cells())]
                                  : centroid_[at(next)];
    const auto d = place - center;
    const double weight = 1 / squared_norm(d);
    m[0] += weight * d.x * d.x;
    m[1] += weight * d.y * d.y;
    m[2] += weight * d.z * d.z;
    m[3] += weight * d.x * d.y;
    m[4] += weight * d.y * d.z;
    m[5] += weight * d.z * d.x;
    b = b + (weight * (there - here)) * d;
    low = std::min(low, there);
    high = std::max(high, there);
  }
  const auto slope = solve(m, b);
  double part = 1;
  for (const auto& middle : middle_[at(cell)]) {
    const double change = dot(slope, middle - center);
    if (change > high - here) part = std::min(part, (high - here) / change);
    if (change < low - here) part = std::min(part, (low - here) / change);
  }
  return part * slope;
}

std::vector<Vec3> FiniteVolumes::slopes(const std::vector<double>& value) const {
  const auto ghost = ghosts(value);
  std::vector<Vec3> result;
  result.reserve(value.size());
  for (LocalId c = 0; c < n_cells(); ++c) result.push_back(limited_slope(c, value, ghost));
  return result;
}

std::vector<double> FiniteVolumes::jumps(const std::vector<double>& value) const {
  const auto ghost = ghosts(value);
  std::vector<double> result;
  result.reserve(value.size());
  for (LocalId c = 0; c < n_cells(); ++c) {
    double largest = 0;
    for (const auto next : mesh_.cell_to_cell[at(c)])
      if (next >= 0)
        largest = std::max(
            largest, std::abs((mesh_.is_ghost(next) ? ghost[at(next - n_cells())] : value[at(next)]) - value[at(c)]));
    result.push_back(largest);
  }
  return result;
}

double FiniteVolumes::step(double dt, std::vector<double>& value) const {
  const auto slope = slopes(value);
  std::vector<Cell> cell;
  cell.reserve(value.size());
  for (LocalId c = 0; c < n_cells(); ++c) cell.push_back({value[at(c)], slope[at(c)]});
  const auto ghost = ghosts(cell);
  const auto value_at = [](const Cell& of, Vec3 centroid, Vec3 point) {
    return of.value + dot(of.slope, point - centroid);
  };
  double left = 0;
  for (LocalId c = 0; c < n_cells(); ++c) {
    double out = 0;
    for (std::size_t f = 0; f < 4; ++f) {
      const double flow = flow_[at(c)][f];
      const auto next = mesh_.cell_to_cell[at(c)][f];
      const auto middle = middle_[at(c)][f];
      double upwind = 0;
      if (flow > 0)
        upwind = value_at(cell[at(c)], centroid_[at(c)], middle);
      else if (mesh_.is_ghost(next))
        upwind = value_at(ghost[at(next - n_cells())], ghost_centroid_[at(next - n_cells())], middle);
      else if (next >= 0)
        upwind = value_at(cell[at(next)], centroid_[at(next)], middle);
      out += flow * upwind;
      if (next < 0) left += dt * flow * upwind;
    }
    value[at(c)] = cell[at(c)].value - dt / volume_[at(c)] * out;
  }
  return left;
}

double FiniteVolumes::advance(double dt, std::vector<double>& value) const {
  const auto before = value;
  const double left = step(dt, value) + step(dt, value);
  for (std::size_t c = 0; c < value.size(); ++c) value[c] = 0.5 * (before[c] + value[c]);
  return 0.5 * left;
}

}  // namespace front
