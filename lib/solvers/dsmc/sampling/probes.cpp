// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "pamr/base/index.hpp"
#include "solvers/dsmc/sampling/estimate.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

/// Mean of `value` over faces by area, with the error of a mean of independent values.
template <class Value, class Error>
Estimate mean_over(const std::vector<const FaceRow*>& faces, Value value, Error error) {
  double area = 0, sum = 0, squares = 0;
  for (const auto* face : faces) {
    area += face->area;
    sum += face->area * value(*face);
    squares += std::pow(face->area * error(*face), 2);
  }
  return {sum / area, std::sqrt(squares) / area};
}

/// A little more than the tetrahedron takes along x.
std::pair<double, double> extent_in_x(const TetPoints& corner) {
  double low = corner[0].x, high = low;
  for (const auto& p : corner) {
    low = std::min(low, p.x);
    high = std::max(high, p.x);
  }
  const double room = 1e-9 * (high - low);
  return {low - room, high + room};
}

/// The value that rank 0 receives for a point.
struct Found {
  std::int64_t point = 0;
  GlobalId cell = 0;
  std::int64_t field = 0, component = 0;
  double value = 0;
};

/// The faces of all ranks on rank 0, in the order of cells and slots. Collective.
std::vector<FaceRow> gather_faces(const par::Comm& comm, const std::vector<FaceRow>& faces) {
  std::vector<par::Outgoing<FaceRow>> messages;
  if (!faces.empty()) messages.push_back({0, faces});
  auto all = comm.sparse_exchange(messages).item;
  std::sort(all.begin(), all.end(),
            [](const auto& a, const auto& b) { return a.cell != b.cell ? a.cell < b.cell : a.slot < b.slot; });
  return all;
}

}  // namespace

std::string station_rows(const par::Comm& comm, const std::vector<Station>& stations,
                         const std::vector<FaceRow>& faces) {
  if (stations.empty()) return {};
  const auto all = gather_faces(comm, faces);
  std::string text;
  for (const auto& station : stations) {
    std::vector<const FaceRow*> inside;
    const FaceRow* nearest = nullptr;
    double min_distance = std::numeric_limits<double>::infinity();
    for (const auto& face : all) {
      const Vec3 middle = (1.0 / 3) * (face.corner[0] + face.corner[1] + face.corner[2]);
      const double away = std::hypot(middle.x - station.x, std::hypot(middle.y, middle.z) - station.r);
      if (away <= station.half_width) inside.push_back(&face);
      if (away < min_distance) {
        min_distance = away;
        nearest = &face;
      }
    }
    if (inside.empty() && nearest != nullptr) inside.push_back(nearest);
    if (inside.empty()) continue;
    const auto row = [&](const char* quantity, const Estimate& e) {
      text += fmt::format("{},{},{:.9g},{:.9g},0,{},{:.9g},{:.9g}\n", station.name, inside.size(), station.x, station.r,
                          quantity, e.value, e.error);
    };
    row("p",
        mean_over(
            inside, [](const FaceRow& f) { return f.pressure; }, [](const FaceRow& f) { return f.pressure_error; }));
    row("q", mean_over(
                 inside, [](const FaceRow& f) { return f.heat; }, [](const FaceRow& f) { return f.heat_error; }));
  }
  return text;
}

std::vector<ProbePoint> points_of(const std::vector<ProbeLine>& lines, const std::vector<ProbePlane>& planes) {
  std::vector<ProbePoint> points;
  const auto part = [](std::int64_t i, std::int64_t n) {
    return n == 1 ? 0 : static_cast<double>(i) / static_cast<double>(n - 1);
  };
  for (const auto& line : lines)
    for (std::int64_t i = 0; i < line.n_points; ++i) {
      const double s = part(i, line.n_points);
      points.push_back({line.name, s * norm(line.to - line.from), line.from + s * (line.to - line.from)});
    }
  for (const auto& plane : planes)
    for (std::int64_t j = 0; j < plane.n_across; ++j)
      for (std::int64_t i = 0; i < plane.n_along; ++i) {
        const double s = part(i, plane.n_along), t = part(j, plane.n_across);
        points.push_back({plane.name, s * norm(plane.along), plane.corner + s * plane.along + t * plane.across});
      }
  return points;
}

std::string point_rows(const par::Comm& comm, const std::vector<ProbePoint>& points, const FlowFields& flow) {
  if (points.empty()) return {};
  const auto& domain = flow.domain;
  const auto& fields = flow.fields;
  // Points by x, so that a cell looks at those near it only.
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return points[a].at.x < points[b].at.x; });
  std::vector<bool> is_found(points.size(), false);

  std::vector<par::Outgoing<Found>> message{{0, {}}};
  for (LocalId cell = 0; cell < domain.n_cells(); ++cell) {
    const auto [low, high] = extent_in_x(corners(flow.mesh, flow.unit, cell));
    auto near = std::lower_bound(order.begin(), order.end(), low, [&](auto i, double x) { return points[i].at.x < x; });
    for (; near != order.end() && points[*near].at.x <= high; ++near) {
      if (is_found[*near] || !is_inside(domain, cell, points[*near].at, 0)) continue;
      is_found[*near] = true;  // cells ascend: the one of the smallest number on this rank
      for (std::size_t f = 0; f < fields.size(); ++f)
        for (int k = 0; k < fields[f].n_components; ++k)
          message[0].item.push_back({static_cast<std::int64_t>(*near), domain.cell_global[at(cell)],
                                     static_cast<std::int64_t>(f), k,
                                     fields[f].real()[at(cell * fields[f].n_components + k)]});
    }
  }
  if (message[0].item.empty()) message.clear();
  auto found = comm.sparse_exchange(message).item;
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) {
    return std::tie(a.point, a.field, a.component, a.cell) < std::tie(b.point, b.field, b.component, b.cell);
  });
  std::string text;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& one = found[i];
    if (i > 0 && std::tie(found[i - 1].point, found[i - 1].field, found[i - 1].component) ==
                     std::tie(one.point, one.field, one.component))
      continue;
    const auto& field = fields[at(one.field)];
    const auto& point = points[at(one.point)];
    const std::string component = field.n_components == 1 ? "" : std::string("_") + "xyz"[one.component];
    text += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g},{}{},{:.9g},\n", point.name, point.s, point.at.x, point.at.y,
                        point.at.z, field.name, component, one.value);
  }
  return text;
}

}  // namespace pamr::dsmc
