// SPDX-License-Identifier: GPL-3.0-or-later
#include "dsmc/probes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

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

/// The value that rank 0 is told of a point.
struct Found {
  std::int64_t point = 0;
  GlobalId cell = 0;
  std::int64_t field = 0, component = 0;
  double value = 0;
};

}  // namespace

std::string station_rows(const std::vector<Station>& stations, const std::vector<FaceRow>& faces) {
  std::string text;
  for (const auto& station : stations) {
    std::vector<const FaceRow*> inside;
    const FaceRow* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& face : faces) {
      const Vec3 middle = (1.0 / 3) * (face.corner[0] + face.corner[1] + face.corner[2]);
      const double away = std::hypot(middle.x - station.x, std::hypot(middle.y, middle.z) - station.r);
      if (away <= station.half_width) inside.push_back(&face);
      if (away < least) {
        least = away;
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

std::string line_rows(const par::Comm& comm, const std::vector<ProbeLine>& lines, const Domain& domain,
                      const std::vector<CellQuantity>& fields) {
  struct Point {
    const ProbeLine* line;
    double s;
    Vec3 at;
  };
  std::vector<Point> points;
  for (const auto& line : lines)
    for (std::int64_t i = 0; i < line.n_points; ++i) {
      const double part = line.n_points == 1 ? 0 : static_cast<double>(i) / static_cast<double>(line.n_points - 1);
      points.push_back({&line, part * norm(line.to - line.from), line.from + part * (line.to - line.from)});
    }
  if (points.empty()) return {};

  std::vector<par::Outgoing<Found>> message{{0, {}}};
  for (std::size_t i = 0; i < points.size(); ++i)
    for (LocalId cell = 0; cell < domain.n_cells(); ++cell) {
      if (!is_inside(domain, cell, points[i].at, 0)) continue;
      for (std::size_t f = 0; f < fields.size(); ++f)
        for (int k = 0; k < fields[f].n_components; ++k)
          message[0].item.push_back({static_cast<std::int64_t>(i), domain.cell_global[static_cast<std::size_t>(cell)],
                                     static_cast<std::int64_t>(f), k,
                                     fields[f].value[static_cast<std::size_t>(cell * fields[f].n_components + k)]});
      break;  // cells ascend
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
    const auto& field = fields[static_cast<std::size_t>(one.field)];
    const auto& point = points[static_cast<std::size_t>(one.point)];
    const std::string component = field.n_components == 1 ? "" : std::string("_") + "xyz"[one.component];
    text += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g},{}{},{:.9g},\n", point.line->name, point.s, point.at.x,
                        point.at.y, point.at.z, field.name, component, one.value);
  }
  return text;
}

}  // namespace pamr::dsmc
