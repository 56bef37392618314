// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/write_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <set>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/sorted_order.hpp"
#include "pamr/io/native/layout.hpp"
#include "pamr/io/native/level0_table.hpp"
#include "pamr/io/native/lineage_word.hpp"
#include "pamr/io/text.hpp"
#include "pamr/mesh/cell_runs.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/mesh/level0_map.hpp"

namespace pamr::io {

using mesh::StorageType;

namespace {

std::uint64_t word_of(std::int64_t value) { return static_cast<std::uint64_t>(value); }

template <class Named>
std::vector<const Named*> by_name(const std::vector<Named>& all) {
  std::vector<const Named*> sorted;
  for (const auto& one : all) sorted.push_back(&one);
  std::sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) { return a->name < b->name; });
  return sorted;
}

std::size_t n_values(const mesh::Field& field) {
  return std::visit([](const auto& values) { return values.size(); }, field.value);
}

/// `HeldRows::fill` from what writes one row: `fill_row(i, to)`.
template <class FillRow>
auto row_by_row(std::size_t width, FillRow fill_row) {
  return [width, fill_row](std::size_t first, std::size_t n, std::uint64_t* to) {
    for (auto i = first; i < first + n; ++i, to += width) fill_row(i, to);
  };
}

/// `ArrayPlan::formula` from what gives one value.
template <class ValueOf>
auto value_by_value(ValueOf value_of) {
  return [value_of](GlobalId row, std::span<std::uint64_t> values) {
    for (auto& value : values) value = value_of(row++);
  };
}

/// The lowest number of a format that has a place for all that is written, which older versions can read. Local.
int format_needed(const mesh::DistMesh& mesh, int format) {
  if (mesh.find_cell_field(mesh::inner_patch_field) != nullptr) return first_format_with_inner_patches;
  return std::min(format, writes_level0(mesh, format) ? first_format_with_level0 : first_format_with_level0 - 1);
}

}  // namespace

template <class FillRow>
HeldRows WritePlan::cell_rows(std::size_t width, FillRow fill_row) const {
  return {mesh_->info.cell_ids(), width, mesh_->cell_global, cell_run_, row_by_row(width, fill_row)};
}

template <class FillRow>
HeldRows WritePlan::node_rows(std::size_t width, FillRow fill_row) const {
  return {mesh_->info.node_ids(), width, node_id_, {}, row_by_row(width, fill_row)};
}

WritePlan::WritePlan(const par::Comm& comm, const mesh::DistMesh& mesh, int format, const std::string& provenance)
    : file_format(format_needed(mesh, format)), mesh_(&mesh), cell_run_(mesh::cell_runs(comm, mesh)) {
  std::vector<std::uint64_t> number;  // from the least on
  number.reserve(mesh.node_global.size());
  for (const auto id : mesh.node_global) number.push_back(static_cast<std::uint64_t>(id - mesh.info.first_id));
  node_order_ = sorted_order(number);
  free_array(number);
  node_id_.reserve(node_order_.size());
  for (const auto node : node_order_) node_id_.push_back(mesh.node_global[node]);
  add_mesh(format);
  const bool has_level0 = writes_level0(mesh, format);
  const auto add_fields = [&](const std::vector<mesh::Field>& fields, bool on_cells) {
    for (const auto* field : by_name(fields))
      if (has_level0 || !mesh::is_level0_field(*field)) add_field(*field, on_cells);
  };
  add_fields(mesh.node_fields, false);
  add_fields(mesh.cell_fields, true);
  if (mesh.find_cell_field(mesh::level_field) == nullptr) add_level();
  auto triangulations = mesh.info.surfaces->triangulations;
  std::sort(triangulations.begin(), triangulations.end(),
            [](const auto& a, const auto& b) { return a->name < b->name; });
  for (const auto& surface : triangulations) add_triangulation(comm, *surface);
  add_patch_numbers(path::patch_numbers, &mesh::Patch::number);
  add_patch_numbers(path::patch_conditions, &mesh::Patch::condition);
  if (!mesh.info.regions.empty()) add_regions();
  if (has_level0) add_level0(*mesh.info.level0);
  add_texts(provenance);
  for (const auto& array : arrays) data_bytes += bytes_of(array);
  for (const auto& text : texts)
    for (const auto& line : text.texts) data_bytes += line.size();
}

void WritePlan::add_mesh(int format) {
  const auto& m = *mesh_;
  const auto n_cells = m.info.n_global_cells, n_nodes = m.info.n_global_nodes;
  const auto add_formula = [&](const char* path, StorageType type, GlobalId n, auto value_of) {
    arrays.push_back({.path = path,
                      .type = type,
                      .shape = {n, 1, true},
                      .rows = {n, 1, {}, {}, {}},
                      .formula = value_by_value(value_of),
                      .has_checksum = false});
  };
  const auto add_rows = [&](const char* path, StorageType type, hdf5::Shape shape, HeldRows rows) {
    arrays.push_back({.path = path, .type = type, .shape = shape, .rows = std::move(rows)});
  };
  add_formula(path::n_points, StorageType::int64, 1, [n_nodes](GlobalId) { return word_of(n_nodes); });
  add_formula(path::n_cells, StorageType::int64, 1, [n_cells](GlobalId) { return word_of(n_cells); });
  add_formula(path::n_connectivity, StorageType::int64, 1, [n_cells](GlobalId) { return word_of(4 * n_cells); });
  add_rows(path::points, StorageType::float64, {n_nodes, 3, false},
           node_rows(3, [this](std::size_t i, std::uint64_t* to) {
             const auto p = mesh_->point(static_cast<LocalId>(node_order_[i]));
             to[0] = std::bit_cast<std::uint64_t>(p.x);
             to[1] = std::bit_cast<std::uint64_t>(p.y);
             to[2] = std::bit_cast<std::uint64_t>(p.z);
           }));
  add_rows(path::connectivity, StorageType::int64, {4 * n_cells, 1, true},
           cell_rows(4, [&m](std::size_t i, std::uint64_t* to) {
             for (const auto node : m.cell_to_node[i]) *to++ = word_of(m.node_global[at(node)] - m.info.first_id);
           }));
  add_formula(path::offsets, StorageType::int64, n_cells + 1, [](GlobalId row) { return word_of(4 * row); });
  add_formula(path::types, StorageType::uint8, n_cells, [](GlobalId) { return word_of(tetrahedron); });
  add_rows(path::cell_to_cell, StorageType::int64, {n_cells, 4, false},
           cell_rows(4, [&m](std::size_t i, std::uint64_t* to) {
             for (const auto slot : m.cell_to_cell[i])
               *to++ = word_of(m.is_own(slot)     ? m.cell_global[at(slot)]
                               : m.is_ghost(slot) ? m.ghost_global[at(slot - m.n_cells())]
                                                  : slot);
           }));
  add_rows(
      path::lineage, StorageType::uint64, {n_cells, 1, true},
      cell_rows(1, [&m, format](std::size_t i, std::uint64_t* to) { *to = word_of_lineage(format, m.lineage[i]); }));
}

void WritePlan::add_field(const mesh::Field& field, bool on_cells) {
  const auto width = static_cast<std::size_t>(field.n_components);
  const auto n_rows = on_cells ? mesh_->cell_global.size() : mesh_->node_global.size();
  PAMR_EXPECTS(field.n_components >= 1 && n_values(field) == n_rows * width);
  PAMR_EXPECTS(field.holds_integers() == mesh::is_integer(field.storage));
  auto rows = std::visit(
      [&](const auto& values) {
        const auto copy_row = [&values, width](std::size_t row, std::uint64_t* to) {
          static_assert(sizeof values[0] == sizeof *to);
          std::memcpy(to, values.data() + row * width, width * sizeof *to);
        };
        if (on_cells) return cell_rows(width, copy_row);
        return node_rows(width, [this, copy_row](std::size_t i, std::uint64_t* to) { copy_row(node_order_[i], to); });
      },
      field.value);
  const auto path = std::string(on_cells ? path::cell_data : path::point_data) + "/" + field.name;
  const hdf5::Shape shape{rows.all.n, field.n_components, width == 1};
  arrays.push_back({.path = path, .type = field.storage, .shape = shape, .rows = std::move(rows), .unit = field.unit});
}

void WritePlan::add_level() {
  const auto n = mesh_->info.n_global_cells;
  auto rows = cell_rows(1, [this](std::size_t i, std::uint64_t* to) { *to = word_of(mesh_->lineage[i].level()); });
  arrays.push_back({.path = path::level,
                    .type = StorageType::uint8,
                    .shape = {n, 1, true},
                    .rows = std::move(rows),
                    .has_checksum = false});
}

void WritePlan::add_triangulation(const par::Comm& comm, const geometry::Triangulation& surface) {
  if (groups.empty()) groups.emplace_back(path::surface_data);
  const auto group = std::string(path::surface_data) + "/" + surface.name;
  groups.push_back(group);
  const auto add = [&](const char* name, StorageType type, std::size_t n, auto fill) {
    const auto all = static_cast<GlobalId>(n);
    const auto range = par::block_range(all, comm.rank(), comm.size());
    auto& ids = row_id_.emplace_back(static_cast<std::size_t>(range.count()));
    std::iota(ids.begin(), ids.end(), range.begin);
    HeldRows rows{all, 3, ids, {}, row_by_row(3, [fill, &ids](std::size_t i, std::uint64_t* to) {
                    const auto row = fill(static_cast<std::size_t>(ids[i]));
                    std::copy(row.begin(), row.end(), to);
                  })};
    arrays.push_back({.path = group + name, .type = type, .shape = {all, 3, false}, .rows = std::move(rows)});
  };
  add("/points", StorageType::float64, surface.points.size(), [&surface](std::size_t i) {
    const auto p = surface.points[i];
    return std::array{std::bit_cast<std::uint64_t>(p.x), std::bit_cast<std::uint64_t>(p.y),
                      std::bit_cast<std::uint64_t>(p.z)};
  });
  add("/triangles", StorageType::int32, surface.triangles.size(), [&surface](std::size_t i) {
    const auto& t = surface.triangles[i];
    return std::array{word_of(t[0]), word_of(t[1]), word_of(t[2])};
  });
}

void WritePlan::add_patch_numbers(const char* path, std::int64_t mesh::Patch::*number) {
  const auto& patches = mesh_->info.patches;
  const auto n = std::ssize(patches);
  if (patches.size() > max_patch_numbers || std::all_of(patches.begin(), patches.end(), [number](const auto& patch) {
        return patch.*number == mesh::Patch{}.*number;
      }))
    return;
  arrays.push_back(
      {.path = path,
       .type = StorageType::int64,
       .shape = {n, 1, true},
       .rows = {n, 1, {}, {}, {}},
       .formula = value_by_value([&patches, number](GlobalId row) { return word_of(patches[at(row)].*number); })});
}

namespace {

/// Of each group its number, the bytes of its name and its name, blanks between: `7 4 wing 9 5 upper`.
std::string text_of_groups(const std::vector<mesh::Group>& groups) {
  std::string text;
  for (const auto& group : groups)
    text += fmt::format("{}{} {} {}", text.empty() ? "" : " ", group.number, group.name.size(), group.name);
  return text;
}

}  // namespace

template <class Part>
void WritePlan::add_groups(const char* path, const std::vector<Part>& parts) {
  if (std::all_of(parts.begin(), parts.end(), [](const auto& part) { return part.groups.empty(); })) return;
  TextPlan plan{path, {}, true};
  for (const auto& part : parts) plan.texts.push_back(text_of_groups(part.groups));
  texts.push_back(std::move(plan));
}

void WritePlan::add_regions() {
  const auto& regions = mesh_->info.regions;
  const auto n = std::ssize(regions);
  groups.emplace_back(path::regions);
  arrays.push_back({.path = path::region_numbers,
                    .type = StorageType::int64,
                    .shape = {n, 1, true},
                    .rows = {n, 1, {}, {}, {}},
                    .formula = value_by_value([&regions](GlobalId row) { return word_of(regions[at(row)].number); })});
  TextPlan names{path::region_names, {}, true};
  for (const auto& region : regions) names.texts.push_back(region.name);
  texts.push_back(std::move(names));
  add_groups(path::region_groups, regions);
}

void WritePlan::add_level0(const mesh::Level0Map& map) {
  groups.emplace_back(path::level0);
  const auto cells = map.cells();
  auto& ids = row_id_.emplace_back();
  for (const auto& cell : cells) ids.push_back(cell.row);
  const auto n = map.n_global_cells();
  for (const auto& column : level0_columns) {
    HeldRows rows{
        n, column.width, ids, {}, row_by_row(column.width, [cells, &column](std::size_t i, std::uint64_t* to) {
          const auto words = words_of(cells[i]);
          std::copy_n(words.begin() + column.first, column.width, to);
        })};
    arrays.push_back({.path = column.path(),
                      .type = column.type,
                      .shape = {n, static_cast<GlobalId>(column.width), false},
                      .rows = std::move(rows)});
  }
}

void WritePlan::add_texts(const std::string& provenance) {
  TextPlan names{path::patch_names, {}, true}, kinds{path::patch_kinds, {}, true}, ties{path::patch_surfaces, {}, true};
  for (const auto& patch : mesh_->info.patches) {
    names.texts.push_back(patch.name);
    kinds.texts.push_back(patch.kind);
    ties.texts.push_back(mesh_->info.surface_name(patch));
  }
  texts.push_back(std::move(names));
  texts.push_back(std::move(kinds));
  texts.push_back(std::move(ties));
  add_groups(path::patch_groups, mesh_->info.patches);
  texts.push_back({path::surfaces, {mesh_->info.surfaces->toml}, false});
  texts.push_back({path::provenance, {provenance.empty() ? mesh_->info.provenance : provenance}, false});
}

/// It would not be read.
bool is_level_for_viewers(const mesh::Field& field) {
  return field.name == mesh::level_field && field.n_components == 1 && field.storage == StorageType::uint8;
}

namespace {

bool is_name(const std::string& name) {
  return !name.empty() && name != "." && name.find('/') == std::string::npos && is_clean_text(name, "");
}

/// `what` ends in an apostrophe, behind which the name belongs.
void require_short(const std::string& what, const std::string& name, const std::string& text) {
  constexpr std::size_t shown = 60;
  if (text.size() > max_name_bytes)
    throw Error(fmt::format("{}{}': expected names and units of at most {} bytes, found {}", what,
                            name.size() > shown ? name.substr(0, shown) + "..." : name, max_name_bytes, text.size()));
}

void require_fields(const std::vector<mesh::Field>& fields, bool on_cells, bool has_map) {
  const std::string where = on_cells ? "cell field '" : "node field '";
  if (fields.size() > max_fields)
    throw Error(fmt::format("expected at most {} fields of {}, found {}", max_fields, on_cells ? "cells" : "nodes",
                            fields.size()));
  std::set<std::string> seen;
  for (const auto& field : fields) {
    require_short(where, field.name, field.name);
    require_short(where, field.name, field.unit);
    if (!is_name(field.name) || !is_clean_text(field.unit, ""))
      throw Error(where + field.name + "': expected a name and a unit in UTF-8, the name without '/', found another");
    if (!seen.insert(field.name).second)
      throw Error(where + field.name + "': expected different names, found it twice");
    if (field.n_components > max_components)
      throw Error(fmt::format("{}{}': expected 1 to {} components, found {}", where, field.name, max_components,
                              field.n_components));
    mesh::require_level0_field(field, on_cells, has_map);
    if (on_cells && is_level_for_viewers(field))
      throw Error(where +
                  "level': expected another name or type than uint8, in which files show the levels of the cells, "
                  "found it");
  }
}

void require_writable(const std::vector<std::shared_ptr<const geometry::Triangulation>>& surfaces) {
  std::set<std::string> seen;
  for (const auto& entry : surfaces) {
    const auto& surface = *entry;
    const auto where = "triangulated surface '" + surface.name + "': ";
    if (!is_name(surface.name)) throw Error(where + "expected a name in UTF-8 without '/', found another");
    require_short("triangulated surface '", surface.name, surface.name);
    if (!seen.insert(surface.name).second) throw Error(where + "expected different names, found it twice");
    constexpr std::size_t most = std::numeric_limits<int>::max();
    const auto n = surface.points.size();
    if (n < 3 || n > most || surface.triangles.empty() || surface.triangles.size() > most)
      throw Error(fmt::format("{}expected 3 points and 1 triangle or more, found {} and {}", where, n,
                              surface.triangles.size()));
    for (const auto p : surface.points)
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        throw Error(where + "expected finite coordinates, found NaN or infinity");
    for (const auto& triangle : surface.triangles)
      for (const int point : triangle)
        if (point < 0 || static_cast<std::size_t>(point) >= n)
          throw Error(fmt::format("{}expected points from 0 to {} in triangles, found {}", where, n - 1, point));
  }
}

void require_lineage(const mesh::DistMesh& mesh, int format) {
  if (format < oldest_format || format > newest_format)
    throw Error(fmt::format("format: expected a number from {} to {}, found {}", oldest_format, newest_format, format));
  for (std::size_t c = 0; c < mesh.lineage.size(); ++c)
    if (!has_word(format, mesh.lineage[c]))
      throw Error(
          fmt::format("lineage, cell {}: expected cells that format {} can describe (regular, 1:2 or 1:4), found {}",
                      mesh.cell_global[c], format, mesh::describe(mesh.lineage[c])));
}

}  // namespace

bool writes_level0(const mesh::DistMesh& mesh, int format) {
  return format >= first_format_with_level0 && mesh::has_level0(mesh);
}

void require_writable(const mesh::DistMesh& mesh, int format) {
  require_lineage(mesh, format);
  if (format < first_format_with_inner_patches && mesh.find_cell_field(mesh::inner_patch_field) != nullptr)
    throw Error(fmt::format("format: expected {}, which has a place for patches of faces inside, found {}",
                            first_format_with_inner_patches, format));
  require_writable(mesh.info.surfaces->triangulations);
  const bool has_map = mesh.info.level0 != nullptr;
  require_fields(mesh.node_fields, false, has_map);
  require_fields(mesh.cell_fields, true, has_map);
  std::set<std::string> seen;
  for (const auto& patch : mesh.info.patches) {
    if (patch.name.empty() || !is_clean_text(patch.name, "") || !is_clean_text(patch.kind, "") ||
        !is_clean_text(mesh.info.surface_name(patch), ""))
      throw Error("patch '" + patch.name + "': expected name, kind and surface in UTF-8, found another encoding");
    if (!seen.insert(patch.name).second)
      throw Error("patch '" + patch.name + "': expected different names, found it twice");
  }
  if (mesh.info.regions.size() > max_regions)
    throw Error(
        fmt::format("regions: expected at most {} with a name, found {}", max_regions, mesh.info.regions.size()));
  for (std::size_t r = 0; r < mesh.info.regions.size(); ++r) {
    const auto number = mesh.info.regions[r].number;
    const auto& name = mesh.info.regions[r].name;
    const auto where = fmt::format("region {}: ", number);
    if (name.empty() || !is_clean_text(name, "")) throw Error(where + "expected a name in UTF-8, found another");
    if (r > 0 && number <= mesh.info.regions[r - 1].number)
      throw Error(
          fmt::format("{}expected ascending numbers, found it after {}", where, mesh.info.regions[r - 1].number));
  }
  for (const auto* text : {&mesh.info.surfaces->toml, &mesh.info.provenance})
    if (!is_clean_text(*text, "\t\r\n")) throw Error("surfaces or provenance: expected UTF-8, found another encoding");
  require_short("length unit '", mesh.info.length_unit, mesh.info.length_unit);
  if (!is_clean_text(mesh.info.length_unit, "")) throw Error("length unit: expected UTF-8, found another encoding");
}

}  // namespace pamr::io
