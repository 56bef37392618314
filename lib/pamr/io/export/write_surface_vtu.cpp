// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/export/write_surface_vtu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <span>

#include "pamr/base/contract.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/shared_output.hpp"
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

void require_sizes(const SurfaceTriangles& t, const SurfaceVtuOptions& options) {
  const auto n = t.cell.size();
  PAMR_EXPECTS(t.corner.size() == n);
  PAMR_EXPECTS(t.corner_fields.empty() || !options.shares_points);
  for (const auto& field : t.corner_fields) PAMR_EXPECTS(field.n_components == 1 && field.value.size() == 3 * n);
  for (const auto& field : t.fields) PAMR_EXPECTS(field.value.size() == n * at(field.n_components));
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
  for (const auto& f : t.fields) result.fields.push_back({f.name, f.n_components, f.is_integer, {}});
  return result;
}

/// The triangles at the canonical blocks of their cells, in the order of the file. Collective: two sparse exchanges.
SurfaceTriangles in_order(const par::Comm& comm, const SurfaceTriangles& given) {
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

struct Points {
  std::vector<Vec3> own;             ///< those first used by this rank's triangles, by number
  std::int64_t n = 0;                ///< on all ranks
  std::vector<std::int64_t> number;  ///< of each corner of this rank's triangles
};

Points points_of_their_own(const par::Comm& comm, const SurfaceTriangles& t) {
  Points points;
  for (const auto& corner : t.corner) points.own.insert(points.own.end(), corner.begin(), corner.end());
  points.n = comm.sum(std::ssize(points.own));
  points.number.resize(points.own.size());
  std::iota(points.number.begin(), points.number.end(), comm.exclusive_sum(std::ssize(points.own)));
  return points;
}

/// Equal corners are one point. The ranks hold the triangles in the order of the file, so a point is first used on the
/// lowest rank that has it, which numbers it. Collective.
Points shared_points(const par::Comm& comm, const SurfaceTriangles& t) {
  Points points;
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
  constexpr Rank nobody_below = -1;
  std::vector<std::size_t> numbered_by_slot(here.size());
  std::vector<Rank> lowest_other(here.size(), nobody_below);
  for (std::size_t i = 0; i < pattern.rank.size() && pattern.rank[i] < comm.rank(); ++i)
    for (auto slot = pattern.offset[i]; slot < pattern.offset[i + 1]; ++slot) {
      auto& lowest = lowest_other[at(pattern.item[slot])];
      if (lowest != nobody_below) continue;  // ranks ascend
      lowest = pattern.rank[i];
      numbered_by_slot[at(pattern.item[slot])] = slot;
    }
  std::vector<std::int64_t> number(here.size(), -1);
  const auto n_own = std::count(lowest_other.begin(), lowest_other.end(), nobody_below);
  auto next = comm.exclusive_sum(n_own);
  points.n = comm.sum(n_own);
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (lowest_other[i] != nobody_below) continue;
    number[i] = next++;
    points.own.push_back(here[i]);
  }
  std::vector<std::int64_t> mine;
  for (const auto item : pattern.item) mine.push_back(number[at(item)]);
  const auto theirs = par::Exchange(comm, pattern).swap(std::span<const std::int64_t>(mine));
  for (std::size_t i = 0; i < here.size(); ++i)
    if (lowest_other[i] != nobody_below) number[i] = theirs[numbered_by_slot[i]];
  for (const auto i : corner_to_here) points.number.push_back(number[i]);
  return points;
}

/// Prints this rank's part of each array, and what stands around them once.
class Printer {
 public:
  Printer(const par::Comm& comm, const std::filesystem::path& file) : out_(comm, file) {}

  void once(const std::string& text) { out_.append_once(text); }

  /// An array of `n_rows` rows here; `print(out, i)` appends row `i`, without the end of the line.
  template <class Print>
  void array(const char* type, const std::string& name, int n_components, std::size_t n_rows, Print&& print) {
    once(fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n", type, name,
                     n_components));
    std::string text;
    for (std::size_t i = 0; i < n_rows; ++i) {
      print(std::back_inserter(text), i);
      text += '\n';
    }
    out_.append(std::string_view(text));
    once("</DataArray>\n");
  }

  /// A field with `width` values in a line.
  void field(const SurfaceField& field, std::size_t width) {
    array(field.is_integer ? "Int64" : "Float64", field.name, field.n_components, field.value.size() / width,
          [&](auto out, std::size_t i) {
            for (std::size_t k = 0; k < width; ++k) {
              if (k > 0) fmt::format_to(out, " ");
              const double value = field.value[width * i + k];
              if (field.is_integer)
                fmt::format_to(out, "{}", std::llround(value));
              else
                fmt::format_to(out, "{:.9g}", value);
            }
          });
  }

  void commit() { out_.commit(); }

 private:
  SharedOutput out_;
};

/// The opening tag of a section of fields.
std::string section(const char* name, const std::vector<SurfaceField>& fields, const SurfaceVtuOptions& options) {
  if (!options.names_scalars || fields.empty()) return fmt::format("<{}>\n", name);
  return fmt::format("<{} Scalars=\"{}\">\n", name, fields.front().name);
}

void print_points(Printer& printer, const Points& points, int digits) {
  printer.once("<Points>\n");
  printer.array("Float64", "Points", 3, points.own.size(), [&](auto out, std::size_t i) {
    const auto& p = points.own[i];
    fmt::format_to(out, "{:.{}g} {:.{}g} {:.{}g}", p.x, digits, p.y, digits, p.z, digits);
  });
  printer.once("</Points>\n");
}

void print_triangles(Printer& printer, const Points& points, std::int64_t first, bool shares_points) {
  const auto n_here = points.number.size() / 3;
  printer.once("<Cells>\n");
  // A blank ends the lines of shared points: these files keep the bytes that they have always had.
  const auto* end = shares_points ? " " : "";
  printer.array("Int64", "connectivity", 1, n_here, [&](auto out, std::size_t i) {
    const auto* n = &points.number[3 * i];
    fmt::format_to(out, "{} {} {}{}", n[0], n[1], n[2], end);
  });
  printer.array("Int64", "offsets", 1, n_here, [&](auto out, std::size_t i) {
    fmt::format_to(out, "{}", 3 * (first + static_cast<std::int64_t>(i) + 1));
  });
  constexpr int vtk_triangle = 5;
  printer.array("UInt8", "types", 1, n_here, [&](auto out, std::size_t) { fmt::format_to(out, "{}", vtk_triangle); });
  printer.once("</Cells>\n");
}

}  // namespace

void write_surface_vtu(const par::Comm& comm, const std::filesystem::path& file, const SurfaceTriangles& triangles,
                       const SurfaceVtuOptions& options) {
  require_sizes(triangles, options);
  const auto t = in_order(comm, triangles);
  const auto points = options.shares_points ? shared_points(comm, t) : points_of_their_own(comm, t);
  const auto n_here = std::ssize(t.cell);

  Printer printer(comm, file);
  printer.once(
      fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\"{}>\n<UnstructuredGrid>\n"
                  "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
                  options.attributes, points.n, comm.sum(n_here)));
  print_points(printer, points, options.coordinate_digits);
  print_triangles(printer, points, comm.exclusive_sum(n_here), options.shares_points);
  if (!t.corner_fields.empty()) {
    printer.once(section("PointData", t.corner_fields, options));
    for (const auto& field : t.corner_fields) printer.field(field, 3);
    printer.once("</PointData>\n");
  }
  printer.once(section("CellData", t.fields, options));
  for (const auto& field : t.fields) printer.field(field, at(field.n_components));
  printer.once("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
  printer.commit();
}

}  // namespace pamr::io
