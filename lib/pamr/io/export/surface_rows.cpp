// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/export/surface_rows.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <span>

#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::io {

namespace {

using geometry::Vec3;

std::size_t width_of(const SurfaceTriangles& t) {
  auto width = 3 * t.corner_fields.size();
  for (const auto& field : t.fields) width += at(field.n_components);
  return width;
}

/// All values on the triangles, triangle by triangle: what `set_values` takes apart again.
std::vector<double> values_by_triangle(const SurfaceTriangles& t, std::size_t i) {
  std::vector<double> row;
  const auto add = [&](const SurfaceField& field, std::size_t width) {
    for (std::size_t k = 0; k < width; ++k) row.push_back(field.value[width * i + k]);
  };
  for (const auto& field : t.corner_fields) add(field, 3);
  for (const auto& field : t.fields) add(field, at(field.n_components));
  return row;
}

void add_values(SurfaceTriangles& t, std::span<const double> row) {
  std::size_t next = 0;
  const auto take = [&](SurfaceField& field, std::size_t width) {
    field.value.insert(field.value.end(), row.begin() + std::ptrdiff_t(next),
                       row.begin() + std::ptrdiff_t(next + width));
    next += width;
  };
  for (auto& field : t.corner_fields) take(field, 3);
  for (auto& field : t.fields) take(field, at(field.n_components));
}

/// The same without triangles.
SurfaceTriangles empty_like(const SurfaceTriangles& t) {
  SurfaceTriangles result{.all_cells = t.all_cells, .cell = {}, .corner = {}, .corner_fields = {}, .fields = {}};
  for (const auto& f : t.corner_fields) result.corner_fields.push_back({f.name, f.n_components, f.is_integer, {}});
  for (const auto& f : t.fields) result.fields.push_back({f.name, f.n_components, f.is_integer, {}, f.unit});
  return result;
}

}  // namespace

SurfaceTriangles triangles_in_order(const par::Comm& comm, const SurfaceTriangles& given) {
  struct Triangle {
    GlobalId cell;
    std::array<Vec3, 3> corner;
  };
  par::Mailbox<Triangle> triangles(comm);
  par::Mailbox<double> values(comm);
  for (std::size_t i = 0; i < given.cell.size(); ++i) {
    const auto to = par::block_of(given.cell[i], given.all_cells, comm.size());
    triangles.add(to, {given.cell[i], given.corner[i]});
    for (const double value : values_by_triangle(given, i)) values.add(to, value);
  }
  const auto arrived = triangles.send().item;
  const auto rows = values.send().item;
  const auto width = width_of(given);

  std::vector<std::size_t> order(arrived.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return arrived[a].cell < arrived[b].cell; });
  auto result = empty_like(given);
  for (const auto i : order) {
    result.cell.push_back(arrived[i].cell);
    result.corner.push_back(arrived[i].corner);
    add_values(result, std::span(rows).subspan(width * i, width));
  }
  return result;
}

SurfacePoints points_of_their_own(const par::Comm& comm, const SurfaceTriangles& t) {
  SurfacePoints points;
  for (const auto& corner : t.corner) points.own.insert(points.own.end(), corner.begin(), corner.end());
  points.n = comm.sum(std::ssize(points.own));
  points.number.resize(points.own.size());
  std::iota(points.number.begin(), points.number.end(), comm.exclusive_sum(std::ssize(points.own)));
  return points;
}

SurfacePoints shared_points(const par::Comm& comm, const SurfaceTriangles& t) {
  SurfacePoints points;
  std::vector<Vec3> here;           // by first use
  std::vector<par::SharedKey> key;  // of each of them
  std::map<par::SharedKey, std::size_t> index_of;
  std::vector<std::size_t> corner_to_here;
  for (const auto& corners : t.corner)
    for (const auto& p : corners) {
      const auto word = [](double x) { return static_cast<GlobalId>(bits_of(x)); };
      const auto [found, is_new] = index_of.try_emplace({word(p.x), word(p.y), word(p.z)}, here.size());
      if (is_new) {
        here.push_back(p);
        key.push_back(found->first);
      }
      corner_to_here.push_back(found->second);
    }

  const auto pattern = par::find_shared(comm, key);
  const par::Exchange exchange(comm, pattern);
  const auto is_own = par::held_first_here(exchange, here.size());
  std::vector<std::int64_t> number(here.size(), -1);
  const auto n_own = std::count(is_own.begin(), is_own.end(), 1);
  auto next = comm.exclusive_sum(n_own);
  points.n = comm.sum(n_own);
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (is_own[i] == 0) continue;
    number[i] = next++;
    points.own.push_back(here[i]);
  }
  par::fold_shared(exchange, number, [](std::int64_t& mine, std::int64_t theirs) { mine = std::max(mine, theirs); });
  for (const auto i : corner_to_here) points.number.push_back(number[i]);
  return points;
}

}  // namespace pamr::io
