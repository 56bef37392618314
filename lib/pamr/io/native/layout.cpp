// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/layout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <limits>
#include <set>
#include <string_view>
#include <system_error>

#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/io/native/checksum.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/text.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/mesh/untagged_patch.hpp"

namespace pamr::io {

namespace {

/// Takes a number and the blank behind it from the beginning of a text.
bool take_number(std::string_view& text, std::int64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end == text.data() + text.size() || *end != ' ') return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()) + 1);
  return true;
}

/// Adds the groups of a text that `text_of_groups` made; false for another one.
bool read_groups(std::string_view text, std::vector<mesh::Group>& groups) {
  while (!text.empty()) {
    std::int64_t number = 0, length = 0;
    if (!take_number(text, number) || !take_number(text, length)) return false;
    if (number < -1 || length < 1 || length > std::ssize(text)) return false;
    const auto name = text.substr(0, static_cast<std::size_t>(length));
    if (!is_clean_text(name, "")) return false;
    groups.push_back({number, std::string(name)});
    text.remove_prefix(name.size());
    if (text.starts_with(' ')) text.remove_prefix(1);
  }
  return true;
}

std::string to_text(const std::vector<std::int64_t>& shape, const char* between = " x ") {
  std::string text;
  for (const auto extent : shape) text += fmt::format("{}{}", text.empty() ? "" : between, extent);
  return text;
}

class Checker {
 public:
  Checker(const Catalog& catalog, std::filesystem::path file, bool verify_checksums)
      : catalog_(&catalog), file_(std::move(file)), verify_(verify_checksums) {}

  Layout run() {
    header();
    counts();
    layout_.points_type = array(path::points, {layout_.info.n_global_nodes, 3}, false);
    layout_.connectivity_type = array(path::connectivity, {4 * layout_.info.n_global_cells}, true);
    layout_.offsets_type = array(path::offsets, {layout_.info.n_global_cells + 1}, true);
    layout_.types_type = array(path::types, {layout_.info.n_global_cells}, true);
    for (const auto& entry : catalog_->arrays) field(entry);
    if (catalog_->has_pamr_group)
      extension();
    else
      layout_.info.patches = {mesh::untagged_patch({})};
    inner_patches();
    level0();
    others();
    if (const auto n = steps(); n > 1 && !layout_.fields.empty())
      remark(fmt::format("the fields are those of the last of {} time steps, the others are left out", n));
    return std::move(layout_);
  }

 private:
  [[noreturn]] void fail(const std::string& path, const std::string& expected, const std::string& found) const {
    throw Error("file '" + file_.string() + "', " + path + ": expected " + expected + ", found " + found);
  }

  void remark(const std::string& text) {
    layout_.remarks.push_back(fmt::format("file '{}': {}", file_.string(), text));
  }

  /// Objects of other programs, which no mesh keeps.
  void others() {
    const auto& all = catalog_->others;
    if (all.empty()) return;
    remark(fmt::format("{} left out that the format does not know: {}",
                       counted(std::ssize(all), "object is", "objects are"),
                       listed(all, {}, [](const auto& name) { return shown_text(name); })));
  }

  void header() const {
    const auto* version = catalog_->find_number("/VTKHDF@Version");
    if (version == nullptr) fail("/VTKHDF@Version", "1.x or 2.x", "no such attribute");
    if (version->values.size() != 2 || version->values[0] < 1 || version->values[0] > 2)
      fail("/VTKHDF@Version", "1.x or 2.x", to_text(version->values, "."));
    const auto* type = catalog_->find_text("/VTKHDF@Type");
    if (type == nullptr) fail("/VTKHDF@Type", "\"UnstructuredGrid\"", "no such attribute");
    if (type->texts.size() != 1 || type->texts[0] != "UnstructuredGrid")
      fail("/VTKHDF@Type", "\"UnstructuredGrid\"", type->texts.size() == 1 ? "another type" : "several texts");
  }

  GlobalId count(const char* path) const {
    const auto& values = catalog_->find_array(path)->values;
    if (values.size() != 1) fail(path, "1 piece", fmt::format("{} pieces", values.size()));
    return values[0];
  }

  void counts() {
    const auto n_points = count(path::n_points), n_cells = count(path::n_cells), n_ids = count(path::n_connectivity);
    constexpr GlobalId limit = GlobalId{1} << 53U;
    if (n_points < 4 || n_points > limit) fail(path::n_points, "4 points or more", fmt::format("{}", n_points));
    if (n_cells < 1 || n_cells > limit) fail(path::n_cells, "1 cell or more", fmt::format("{}", n_cells));
    if (n_ids != 4 * n_cells)
      fail(path::n_connectivity, fmt::format("{} (4 for each cell)", 4 * n_cells), fmt::format("{}", n_ids));
    layout_.info.n_global_nodes = n_points;
    layout_.info.n_global_cells = n_cells;
  }

  mesh::StorageType array(const char* path, const std::vector<std::int64_t>& shape, bool integer) const {
    const auto& entry = *catalog_->find_array(path);
    if (entry.shape != shape) fail(path, "shape " + to_text(shape), to_text(entry.shape));
    if (mesh::is_integer(entry.type) != integer)
      fail(path, integer ? "integers" : "float64 or float32", hdf5::to_text(entry.type));
    return entry.type;
  }

  /// Time steps of a file of a mesh that stays as it is: the fields have the rows of all of them, one after another.
  std::int64_t steps() const {
    const auto* n = catalog_->find_number("/VTKHDF/Steps@NSteps");
    if (n == nullptr) return 1;
    constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
    if (n->values.size() != 1 || n->values[0] < 1 || n->values[0] > most)
      fail("/VTKHDF/Steps@NSteps", fmt::format("a number from 1 to {}", most), to_text(n->values));
    return n->values[0];
  }

  void field(const ArrayEntry& entry) {
    for (const bool on_cells : {false, true}) {
      const auto group = std::string(on_cells ? path::cell_data : path::point_data) + "/";
      if (!entry.path.starts_with(group)) continue;
      FieldEntry result{entry.path, entry.path.substr(group.size()), "", on_cells, entry.type, 1, true};
      if (!is_clean_text(result.name, ""))
        fail(group + "...", "field names in UTF-8 without control characters", "another");
      const auto rows = on_cells ? layout_.info.n_global_cells : layout_.info.n_global_nodes;
      const auto n_steps = steps();
      if (entry.shape[0] != n_steps * rows)
        fail(entry.path,
             n_steps == 1 ? fmt::format("{} rows", rows) : fmt::format("{} rows for each of {} steps", rows, n_steps),
             to_text(entry.shape));
      result.first_row = (n_steps - 1) * rows;
      result.is_flat = entry.shape.size() == 1;
      if (!result.is_flat) {
        if (entry.shape[1] < 1 || entry.shape[1] > max_components)
          fail(entry.path, fmt::format("1 to {} components", max_components), fmt::format("{}", entry.shape[1]));
        result.n_components = static_cast<int>(entry.shape[1]);
      }
      if (entry.path == path::level && result.is_flat && entry.type == mesh::StorageType::uint8) {
        if (!catalog_->has_pamr_group)
          remark("the field 'level' is left out: one of that name and type says how often cells were refined");
        return;
      }
      result.unit = one_text(entry.path + "@unit", "");
      layout_.fields.push_back(std::move(result));
    }
  }

  /// A single text; empty when the file has none.
  std::string one_text(const std::string& path, std::string_view allowed_controls) const {
    const auto* entry = catalog_->find_text(path);
    if (entry == nullptr || entry->texts.empty()) return {};
    if (entry->texts.size() != 1) fail(path, "one text", fmt::format("{}", entry->texts.size()));
    if (!is_clean_text(entry->texts[0], allowed_controls)) fail(path, "text in UTF-8", "another encoding");
    verify(*entry);
    return entry->texts[0];
  }

  std::vector<std::string> text_list(const std::string& path) const {
    const auto* entry = catalog_->find_text(path);
    if (entry == nullptr) return {};
    for (const auto& text : entry->texts)
      if (!is_clean_text(text, "")) fail(path, "texts in UTF-8", "another encoding");
    verify(*entry);
    return entry->texts;
  }

  void verify(const TextEntry& entry) const {
    if (!verify_) return;
    const auto* stored = catalog_->find_number(std::string(path::checksums) + "@" + checksum_path(entry.path));
    if (stored == nullptr) return;
    if (stored->values.size() != 1 || std::bit_cast<std::uint64_t>(stored->values[0]) != checksum_of(entry.texts))
      fail(entry.path, "contents that agree with its checksum", "that they do not: " + damaged_or_changed(entry.path));
  }

  void extension() {
    const auto* format = catalog_->find_number("/PAMR@format");
    const auto known = fmt::format("a number from {} to {}", oldest_format, newest_format);
    if (format == nullptr) fail("/PAMR@format", known, "no such attribute");
    if (format->values.size() != 1 || format->values[0] < oldest_format || format->values[0] > newest_format)
      fail("/PAMR@format", known, to_text(format->values));
    layout_.format = static_cast<int>(format->values[0]);
    auto& info = layout_.info;
    info.length_unit = one_text("/PAMR@length_unit", "");
    layout_.surfaces_toml = one_text(path::surfaces, "\t\r\n");
    info.provenance = one_text(path::provenance, "\t\r\n");
    if (const auto* first = catalog_->find_number("/PAMR@first_id"); first != nullptr) {
      if (first->values.size() != 1 || first->values[0] < 0 || first->values[0] > mesh::max_first_id)
        fail("/PAMR@first_id", fmt::format("a number from 0 to {}", mesh::max_first_id), to_text(first->values));
      info.first_id = first->values[0];
    }
    patches();
    regions();
    boundary();
    for (const auto& entry : catalog_->arrays) triangulation(entry);
    if (catalog_->find_array(path::cell_to_cell) != nullptr) {
      layout_.has_neighbors = true;
      layout_.neighbors_type = array(path::cell_to_cell, {info.n_global_cells, 4}, true);
    } else if (info.patches.size() > 1 && layout_.n_triangles == 0) {
      fail(path::cell_to_cell,
           fmt::format("this dataset or {}, because there are {} patches", path::boundary, info.patches.size()),
           "none");
    } else if (info.patches.empty()) {
      info.patches = {mesh::untagged_patch({})};
    }
    if (catalog_->find_array(path::lineage) != nullptr) {
      layout_.has_lineage = true;
      layout_.lineage_type = array(path::lineage, {info.n_global_cells}, true);
    }
  }

  /// Takes a pair of datasets where its `points` turn up; the catalog has both.
  void triangulation(const ArrayEntry& points) {
    const auto group = std::string(path::surface_data) + "/";
    constexpr std::string_view last = "/points";
    if (!points.path.starts_with(group) || !points.path.ends_with(last)) return;
    TriangulationEntry entry;
    entry.path = points.path.substr(0, points.path.size() - last.size());
    entry.name = entry.path.substr(group.size());
    if (!is_clean_text(entry.name, "")) fail(group + "...", "names in UTF-8 without control characters", "another");
    const auto rows_of = [&](const std::string& path, GlobalId least) {
      const auto& shape = catalog_->find_array(path)->shape;
      constexpr GlobalId most = std::numeric_limits<int>::max();
      if (shape.size() != 2 || shape[0] < least || shape[0] > most || shape[1] != 3)
        fail(path, fmt::format("shape n x 3, n from {} to {}", least, most), to_text(shape));
      return shape[0];
    };
    const auto triangles = entry.path + "/triangles";
    entry.n_points = rows_of(points.path, 3);
    entry.n_triangles = rows_of(triangles, 1);
    entry.points_type = array(points.path.c_str(), {entry.n_points, 3}, false);
    entry.triangles_type = array(triangles.c_str(), {entry.n_triangles, 3}, true);
    layout_.triangulations.push_back(std::move(entry));
  }

  void patches() {
    const auto names = text_list(path::patch_names);
    auto kinds = text_list(path::patch_kinds), surfaces = text_list(path::patch_surfaces);
    if (kinds.empty()) kinds.resize(names.size());
    if (surfaces.empty()) surfaces.resize(names.size());
    if (kinds.size() != names.size())
      fail(path::patch_kinds, fmt::format("{} texts, one for each patch", names.size()),
           fmt::format("{}", kinds.size()));
    if (surfaces.size() != names.size())
      fail(path::patch_surfaces, fmt::format("{} texts, one for each patch", names.size()),
           fmt::format("{}", surfaces.size()));
    std::set<std::string> seen;
    for (std::size_t p = 0; p < names.size(); ++p) {
      if (names[p].empty()) fail(path::patch_names, "a name", fmt::format("an empty one in row {}", p));
      if (!seen.insert(names[p]).second)
        fail(path::patch_names, "different names", fmt::format("'{}' twice, again in row {}", names[p], p));
      layout_.info.patches.push_back({names[p], kinds[p]});
    }
    layout_.surface_of_patch = std::move(surfaces);
    patch_numbers(path::patch_numbers, &mesh::Patch::number);
    patch_numbers(path::patch_conditions, &mesh::Patch::condition);
    groups(path::patch_groups, layout_.info.patches);
  }

  template <class Part>
  void groups(const char* path, std::vector<Part>& parts) {
    const auto texts = text_list(path);
    if (texts.empty()) return;
    if (texts.size() != parts.size())
      fail(path, fmt::format("{} texts, as there are names", parts.size()), fmt::format("{}", texts.size()));
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (!read_groups(texts[i], parts[i].groups))
        fail(path, "number, length and name of each group", fmt::format("another text in row {}", i));
  }

  void patch_numbers(const char* path, std::int64_t mesh::Patch::*number) {
    const auto* numbers = catalog_->find_array(path);
    auto& patches = layout_.info.patches;
    if (numbers == nullptr) return;
    if (numbers->values.size() != patches.size())
      fail(path, fmt::format("{} numbers, one for each patch", patches.size()),
           fmt::format("{}", numbers->values.size()));
    for (std::size_t p = 0; p < patches.size(); ++p) patches[p].*number = numbers->values[p];
  }

  /// The catalog has both datasets or none.
  void boundary() {
    const auto* triangles = catalog_->find_array(path::boundary_triangles);
    if (triangles == nullptr) return;
    const auto n = triangles->shape[0];
    if (n < 1) fail(path::boundary_triangles, "1 triangle or more", "none");
    if (layout_.info.patches.empty()) fail(path::patch_names, "names, because there are boundary triangles", "none");
    layout_.triangles_type = array(path::boundary_triangles, {n, 3}, true);
    layout_.triangle_patch_type = array(path::boundary_patch, {n}, true);
    layout_.n_triangles = n;
  }

  /// The catalog has both datasets or none.
  void regions() {
    const auto* entry = catalog_->find_array(path::region_numbers);
    if (entry == nullptr) return;
    const auto& numbers = entry->values;
    const auto names = text_list(path::region_names);
    if (names.size() != numbers.size())
      fail(path::region_names, fmt::format("{} texts, one for each number", numbers.size()),
           fmt::format("{}", names.size()));
    for (std::size_t r = 0; r < names.size(); ++r) {
      if (names[r].empty()) fail(path::region_names, "a name", fmt::format("an empty one in row {}", r));
      if (r > 0 && numbers[r] <= numbers[r - 1])
        fail(path::region_numbers, "ascending numbers", fmt::format("{} after {}", numbers[r], numbers[r - 1]));
      layout_.info.regions.push_back({numbers[r], names[r]});
    }
    groups(path::region_groups, layout_.info.regions);
  }

  void inner_patches() {
    for (const auto& field : layout_.fields)
      if (field.on_cells && field.name == mesh::inner_patch_field &&
          (field.n_components != 1 || !mesh::is_integer(field.type)))
        fail(field.path, "one integer a row", fmt::format("{} of {}", field.n_components, hdf5::to_text(field.type)));
  }

  /// The map of level 0 is its table and two fields; a part of them alone says nothing and is left out. The catalog has
  /// all datasets of the table or none.
  void level0() {
    auto& fields = layout_.fields;
    const auto is_field = [](const FieldEntry& field) {
      return field.name == (field.on_cells ? mesh::level0_cell_field : mesh::level0_key_field);
    };
    const auto n_fields = std::count_if(fields.begin(), fields.end(), is_field);
    const bool has_table = catalog_->find_array(column_of(Level0Dataset::corners).path()) != nullptr;
    if (n_fields == 0 && !has_table) return;
    if (n_fields < 2 || !has_table) {
      const auto missing = has_table ? fmt::format("the fields '{}' of nodes and '{}' of cells", mesh::level0_key_field,
                                                   mesh::level0_cell_field)
                                     : path::level0;
      remark(fmt::format("a part of the map of level 0 is left out, because {} {} missing", missing,
                         has_table ? "are" : "is"));
      std::erase_if(fields, is_field);
      return;
    }
    for (const auto& field : fields) {
      if (!is_field(field)) continue;
      const auto n_components = field.on_cells ? 1 : mesh::n_key_words;
      if (field.n_components != n_components || !mesh::is_integer(field.type))
        fail(field.path, fmt::format("{} integers a row", n_components),
             fmt::format("{} of {}", field.n_components, hdf5::to_text(field.type)));
    }
    auto& table = layout_.level0;
    table.n_rows = catalog_->find_array(column_of(Level0Dataset::corners).path())->shape[0];
    if (table.n_rows < 1 || table.n_rows > layout_.info.n_global_cells)
      fail(column_of(Level0Dataset::corners).path(), fmt::format("1 to {} rows", layout_.info.n_global_cells),
           fmt::format("{}", table.n_rows));
    for (std::size_t i = 0; i < level0_columns.size(); ++i) {
      const auto& column = level0_columns[i];
      table.type[i] = array(column.path().c_str(), {table.n_rows, static_cast<std::int64_t>(column.width)},
                            mesh::is_integer(column.type));
    }
  }

  const Catalog* catalog_;
  std::filesystem::path file_;
  bool verify_;
  Layout layout_;
};

}  // namespace

Layout check_catalog(const Catalog& catalog, const std::filesystem::path& file, bool verify_checksums) {
  return Checker(catalog, file, verify_checksums).run();
}

std::string checksum_path(const std::string& dataset) { return dataset.substr(1); }

std::string damaged_or_changed(const std::string& dataset) {
  return fmt::format("the file is damaged, or a script that changed the dataset has left the attribute '{}' of {}",
                     checksum_path(dataset), path::checksums);
}

}  // namespace pamr::io
