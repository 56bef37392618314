// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: VTK file formats, "Legacy file formats"; names and the widths of integers as VTK 9 writes them.
#include "pamr/io/vtk/read_legacy_vtk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pamr/io/elements/first_line.hpp"
#include "pamr/io/elements/text_cursor.hpp"
#include "pamr/io/vtk/legacy_numbers.hpp"
#include "pamr/io/vtk/vtk_grid.hpp"

namespace pamr::io::vtk {

namespace {

/// Reads a file from front to back.
class LegacyReader {
 public:
  explicit LegacyReader(TextCursor& in) : in_(in), numbers_(in) {}

  Grid read() {
    read_head();
    for (skip_blank_lines(); !in_.at_end(); skip_blank_lines()) take(lower(word("a keyword")));
    if (grid_.n_points == 0) in_.fail("POINTS", "the end of the file");
    if (grid_.types.size() != grid_.ends.size())
      in_.fail(fmt::format("CELL_TYPES of {} cells", grid_.ends.size()), fmt::format("{}", grid_.types.size()));
    return std::move(grid_);
  }

 private:
  void read_head() {
    in_.skip_byte_order_mark();
    skip_blank_lines();
    const auto begin = in_;
    if (!in_.line().starts_with("# vtk DataFile"))
      begin.fail("a legacy file of VTK, which begins with \"# vtk DataFile Version\"", what_begins(begin.rest()));
    (void)in_.line();
    const auto kind = lower(word("ASCII or BINARY"));
    if (kind != "ascii" && kind != "binary") in_.fail("ASCII or BINARY", "another word");
    numbers_.set_binary(kind == "binary");
    skip_blank_lines();
    if (lower(word("DATASET")) != "dataset") in_.fail("DATASET", "another word");
    const auto dataset = word("the kind of grid");
    if (lower(dataset) != "unstructured_grid")
      in_.fail("DATASET UNSTRUCTURED_GRID", std::string(dataset.substr(0, 40)));
    (void)in_.line();
  }

  void skip_blank_lines() {
    while (!in_.at_end() && std::isspace(static_cast<unsigned char>(in_.rest().front())) != 0) in_.pass(1);
  }
  /// The next word of this line, without blanks.
  std::string_view word(std::string_view what) {
    if (in_.is_line_over('\n')) in_.fail(std::string(what), "the end of the line");
    const auto rest = in_.rest();
    const auto text = rest.substr(0, rest.find_first_of(" \t\r\n"));
    in_.pass(text.size());
    return text;
  }
  std::int64_t count(std::string_view what) {
    return in_.checked_count(in_.integer_in_line(fmt::format("the number of {}", what)), 0 + 1, what);
  }

  void take(const std::string& keyword) {
    if (keyword == "points") {
      grid_.n_points = count("points");
      const auto& type = numbers_.type_named(word("a type of numbers"));
      (void)in_.line();
      auto values = numbers_.numbers(type, 3 * grid_.n_points);
      if (values.index() == 1) in_.fail("points of reals", "integers");
      grid_.points = std::move(values);
    } else if (keyword == "cells") {
      read_cells();
    } else if (keyword == "cell_types") {
      const auto n = count("cells");
      (void)in_.line();
      grid_.types = numbers_.integers(numbers_.type_named("int"), n);
    } else if (keyword == "point_data" || keyword == "cell_data") {
      is_on_points_ = keyword == "point_data";
      n_rows_ = in_.integer_in_line("the number of values");
      const auto n = is_on_points_ ? grid_.n_points : std::ssize(grid_.ends);
      if (n_rows_ != n) in_.fail(fmt::format("{} values", n), fmt::format("{}", *n_rows_));
      (void)in_.line();
    } else if (keyword == "metadata") {
      skip_metadata();
    } else {
      take_attribute(keyword);
    }
  }

  /// Lines up to an empty one.
  void skip_metadata() {
    (void)in_.line();
    while (!in_.at_end() && !in_.line().empty()) continue;
  }

  void read_cells() {
    const auto n = count("cells"), size = in_.integer_in_line("the size of the cells");
    in_.checked_count(size, 1, "nodes of cells");
    (void)in_.line();
    skip_blank_lines();
    if (!lower(in_.rest().substr(0, 7)).starts_with("offsets")) {  // each cell with its number of nodes before it
      const auto rows = numbers_.integers(numbers_.type_named("int"), size);
      for (std::size_t i = 0; i < rows.size(); i += static_cast<std::size_t>(rows[i]) + 1) {
        if (rows[i] < 0 || rows[i] > std::ssize(rows) - static_cast<std::int64_t>(i) - 1)
          in_.fail("a number of nodes of a cell that is left", fmt::format("{}", rows[i]));
        const auto begin = rows.begin() + static_cast<std::ptrdiff_t>(i) + 1;
        grid_.nodes.insert(grid_.nodes.end(), begin, begin + rows[i]);
        grid_.ends.push_back(std::ssize(grid_.nodes));
      }
      if (std::ssize(grid_.ends) != n) in_.fail(fmt::format("{} cells", n), fmt::format("{}", grid_.ends.size()));
      return;
    }
    grid_.ends = array_behind("offsets", n);
    skip_blank_lines();
    grid_.nodes = array_behind("connectivity", size);
    if (grid_.ends.empty() || grid_.ends.front() != 0) in_.fail("offsets that begin with 0", "others");
    grid_.ends.erase(grid_.ends.begin());
    for (std::size_t c = 0; c < grid_.ends.size(); ++c)
      if (grid_.ends[c] < (c == 0 ? 0 : grid_.ends[c - 1]) || grid_.ends[c] > size)
        in_.fail("offsets that grow up to the number of nodes", fmt::format("{}", grid_.ends[c]));
  }

  std::vector<std::int64_t> array_behind(std::string_view keyword, std::int64_t n) {
    if (lower(word(keyword)) != keyword) in_.fail(std::string(keyword), "another word");
    const auto& type = numbers_.type_named(word("a type of numbers"));
    (void)in_.line();
    return numbers_.integers(type, n);
  }

  void take_attribute(const std::string& keyword) {
    if (keyword == "field") {
      read_field_data();
      return;
    }
    if (!n_rows_) in_.fail("POINT_DATA or CELL_DATA before " + keyword.substr(0, 40), "none");
    const auto name = decoded(word("a name"));
    if (keyword == "lookup_table" || keyword == "color_scalars") {
      const auto n = in_.integer_in_line("a number of colors");
      in_.checked_count(n, 1, "colors");
      (void)in_.line();
      if (keyword == "color_scalars")
        keep_colors(name, n);
      else
        (void)numbers_.numbers(type_of_colors(), 4 * n);
      return;
    }
    std::int64_t width = keyword == "vectors" || keyword == "normals" ? 3
                         : keyword == "tensors"                       ? 9
                         : keyword == "tensors6"                      ? 6
                                                                      : 1;
    constexpr std::array<std::string_view, 8> known{
        "scalars", "vectors", "normals", "tensors", "tensors6", "texture_coordinates", "global_ids", "pedigree_ids"};
    if (std::find(known.begin(), known.end(), keyword) == known.end())
      in_.fail("a keyword of the format", "\"" + keyword.substr(0, 40) + "\"");
    if (keyword == "texture_coordinates") width = in_.integer_in_line("the number of coordinates");
    const auto& type = numbers_.type_named(word("a type of numbers"));
    if (keyword == "scalars") {
      if (!in_.is_line_over('\n')) width = in_.integer_in_line("the number of components");
      (void)in_.line();
      if (lower(in_.rest().substr(0, 12)) == "lookup_table") (void)in_.line();
    } else {
      (void)in_.line();
    }
    keep(name, type, width, *n_rows_);
  }

  void read_field_data() {
    (void)word("the name of field data");
    const auto n_arrays = in_.checked_count(in_.integer_in_line("the number of arrays"), 1, "arrays");
    (void)in_.line();
    for (std::int64_t i = 0; i < n_arrays; ++i) {
      skip_blank_lines();
      auto name = decoded(word("the name of an array"));
      while (lower(name) == "metadata") {
        skip_metadata();
        skip_blank_lines();
        name = decoded(word("the name of an array"));
      }
      const auto width = in_.integer_in_line("the number of components");
      const auto n = in_.integer_in_line("the number of values");
      const auto type = lower(word("a type of numbers"));
      (void)in_.line();
      if (type == "string") {
        skip_texts(in_.checked_count(n, 1, "texts"));
        if (n_rows_)
          grid_.arrays.push_back({is_on_points_, name, type, width, {}});  // no field, which is said
        else
          grid_.left_out.push_back(name);
        continue;
      }
      keep(name, numbers_.type_named(type), width, n);
    }
  }

  /// In binary files a text has its length before it, in one to eight bytes by the first two bits.
  void skip_texts(std::int64_t n) {
    for (std::int64_t i = 0; i < n; ++i) {
      if (!numbers_.is_binary()) {
        (void)in_.line();
        continue;
      }
      const auto first = in_.value<unsigned char>("the length of a text");
      const int more = first >= 0xc0U ? 0 : first >= 0x80U ? 1 : first >= 0x40U ? 3 : 7;
      std::uint64_t length = first & 0x3fU;
      for (int k = 0; k < more; ++k) length = length << 8U | in_.value<unsigned char>("the length of a text");
      if (length > in_.remaining()) in_.fail("a text within the file", fmt::format("one of {} bytes", length));
      in_.pass(length);
    }
  }

  const LegacyType& type_of_colors() const {
    return numbers_.type_named(numbers_.is_binary() ? "unsigned_char" : "float");
  }

  /// VTK calls bytes colors: 0 to 255, in text 0 to 1.
  void keep_colors(const std::string& name, std::int64_t width) {
    const auto read = numbers_.numbers(type_of_colors(), width * *n_rows_);
    std::vector<std::int64_t> bytes;
    if (const auto* parts = std::get_if<std::vector<double>>(&read))
      for (const double part : *parts) bytes.push_back(std::lround(255 * std::clamp(part, 0.0, 1.0)));
    else
      bytes = std::get<std::vector<std::int64_t>>(read);
    const auto type = std::string(numbers_.type_named("unsigned_char").type);
    grid_.arrays.push_back({is_on_points_, name, type, width, [bytes] { return Values(bytes); }});
  }

  /// Reads an array, and keeps it where it has a row for each point or cell, or says the name of a patch.
  void keep(const std::string& name, const LegacyType& type, std::int64_t width, std::int64_t n) {
    if (width < 1 || width > 65536) in_.fail("1 to 65536 components", fmt::format("{}", width));
    in_.checked_count(n < 0 ? n : n / 8, 1, "values");  // eight bits a byte
    if (!n_rows_ && width * n == 1 && name.starts_with(before_patch) && name != before_patch) {
      name_patch(grid_, name, numbers_.integers(type, 1).front());
      return;
    }
    auto values = std::make_shared<Values>(numbers_.numbers(type, width * n));
    if (n_rows_ && n == *n_rows_)
      grid_.arrays.push_back({is_on_points_, name, std::string(type.type), width, [values] { return *values; }});
    else
      grid_.left_out.push_back(name);
  }

  TextCursor& in_;
  Grid grid_;
  LegacyNumbers numbers_;
  bool is_on_points_ = false;
  std::optional<std::int64_t> n_rows_;  ///< of the data that follow
};

}  // namespace

}  // namespace pamr::io::vtk

namespace pamr::io {

ElementMesh read_legacy_vtk(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options) {
  return mesh_of_whole(comm, file, options, [&] {
    const MappedFile mapped(file);
    TextCursor in(mapped.bytes(), file.string());
    return vtk::to_whole_mesh(vtk::LegacyReader(in).read());
  });
}

}  // namespace pamr::io
