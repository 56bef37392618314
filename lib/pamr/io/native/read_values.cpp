// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/read_values.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <span>
#include <utility>
#include <variant>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::io {

std::vector<geometry::Vec3> read_points(SlabReader& reader, const Dataset& dataset, Rows rows) {
  std::vector<geometry::Vec3> points;
  assign_array(points, at(rows.count()), {});
  reader.each_slab(dataset, rows, true, [&](GlobalId first, std::span<const std::uint64_t> words) {
    for (std::size_t i = 0; i < words.size(); i += 3) {
      const auto row = first + static_cast<GlobalId>(i / 3);
      const geometry::Vec3 p{std::bit_cast<double>(words[i]), std::bit_cast<double>(words[i + 1]),
                             std::bit_cast<double>(words[i + 2])};
      if (!is_finite(p)) reader.fail(dataset.path, row, "finite coordinates", "NaN or infinity");
      if (!geometry::is_in_range(p))
        reader.fail(dataset.path, row, fmt::format("coordinates below {}", geometry::max_coordinate_text),
                    fmt::format("{:g}, {:g}, {:g}", p.x, p.y, p.z));
      points[at(row - rows.begin)] = p;
    }
  });
  return points;
}

mesh::Field read_field(SlabReader& reader, const Layout& layout, const FieldEntry& entry, Rows rows, bool verify) {
  const auto n_rows = entry.first_row + (entry.on_cells ? layout.info.n_global_cells : layout.info.n_global_nodes);
  const Rows in_dataset{entry.first_row + rows.begin, entry.first_row + rows.end};
  mesh::Field field{entry.name, entry.unit, entry.n_components, entry.type, {}};
  if (mesh::is_integer(entry.type)) field.value = std::vector<std::int64_t>();
  std::visit(
      [&](auto& values) {
        assign_array(values, at(rows.count()) * at(entry.n_components), {});
        auto* to = values.data();
        reader.each_slab({entry.path, entry.type, {n_rows, entry.n_components, entry.is_flat}}, in_dataset,
                         verify && entry.first_row == 0, [&](GlobalId, std::span<const std::uint64_t> words) {
                           std::memcpy(to, words.data(), words.size_bytes());
                           to += words.size();
                         });
      },
      field.value);
  return field;
}

geometry::Triangulation read_triangulation(SlabReader& reader, const TriangulationEntry& entry) {
  const auto& comm = reader.comm();
  const auto rows = [&](GlobalId n) { return Rows{0, comm.is_first() ? n : 0}; };
  geometry::Triangulation result;
  result.name = entry.name;
  result.points = comm.broadcast(read_points(
      reader, {entry.path + "/points", entry.points_type, {entry.n_points, 3, false}}, rows(entry.n_points)));
  const Dataset triangles{entry.path + "/triangles", entry.triangles_type, {entry.n_triangles, 3, false}};
  reader.each_slab(triangles, rows(entry.n_triangles), true, [&](GlobalId first, std::span<const std::uint64_t> words) {
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (words[i] >= static_cast<std::uint64_t>(entry.n_points))
        reader.fail(triangles.path, first + static_cast<GlobalId>(i / 3),
                    fmt::format("a point from 0 to {}", entry.n_points - 1),
                    fmt::format("{}", static_cast<std::int64_t>(words[i])));
      if (i % 3 == 0) result.triangles.emplace_back();
      result.triangles.back()[i % 3] = static_cast<int>(words[i]);
    }
  });
  result.triangles = comm.broadcast(std::move(result.triangles));
  return result;
}

}  // namespace pamr::io
