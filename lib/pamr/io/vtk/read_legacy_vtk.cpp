// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: VTK file formats, "Legacy file formats"; names and the widths of integers as VTK 9 writes them.
#include "pamr/io/vtk/read_legacy_vtk.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/io/elements/first_line.hpp"
#include "pamr/io/elements/text_cursor.hpp"
#include "pamr/io/vtk/legacy_attributes.hpp"
#include "pamr/io/vtk/legacy_numbers.hpp"
#include "pamr/io/vtk/legacy_words.hpp"
#include "pamr/io/vtk/vtk_grid.hpp"

namespace pamr::io::vtk {

namespace {

/// Reads a file from front to back.
class LegacyReader {
 public:
  explicit LegacyReader(TextCursor& in) : in_(in), numbers_(in) {}

  Grid read() {
    read_head();
    for (skip_blank_lines(in_); !in_.at_end(); skip_blank_lines(in_)) take(lower(word("a keyword")));
    if (grid_.n_points == 0) in_.fail("POINTS", "the end of the file");
    if (grid_.types.size() != grid_.ends.size())
      in_.fail(fmt::format("CELL_TYPES of {} cells", grid_.ends.size()), fmt::format("{}", grid_.types.size()));
    return std::move(grid_);
  }

 private:
  void read_head() {
    in_.skip_byte_order_mark();
    skip_blank_lines(in_);
    const auto begin = in_;
    if (!in_.line().starts_with("# vtk DataFile"))
      begin.fail("a legacy file of VTK, which begins with \"# vtk DataFile Version\"", what_begins(begin.rest()));
    (void)in_.line();
    const auto kind = lower(word("ASCII or BINARY"));
    if (kind != "ascii" && kind != "binary") in_.fail("ASCII or BINARY", "another word");
    numbers_.set_binary(kind == "binary");
    skip_blank_lines(in_);
    if (lower(word("DATASET")) != "dataset") in_.fail("DATASET", "another word");
    const auto dataset = word("the kind of grid");
    if (lower(dataset) != "unstructured_grid")
      in_.fail("DATASET UNSTRUCTURED_GRID", std::string(dataset.substr(0, 40)));
    (void)in_.line();
  }

  std::string_view word(std::string_view what) { return next_word(in_, what); }

  void take(const std::string& keyword) {
    if (keyword == "points") {
      grid_.n_points = next_count(in_, "points");
      const auto& type = numbers_.type_named(word("a type of numbers"));
      (void)in_.line();
      auto values = numbers_.numbers(type, 3 * grid_.n_points);
      if (values.index() == 1) in_.fail("points of reals", "integers");
      grid_.points = std::move(values);
    } else if (keyword == "cells") {
      read_cells();
    } else if (keyword == "cell_types") {
      const auto n = next_count(in_, "cells");
      (void)in_.line();
      grid_.types = numbers_.integers(numbers_.type_named("int"), n);
    } else if (keyword == "point_data" || keyword == "cell_data") {
      const bool is_on_points = keyword == "point_data";
      const auto n_rows = in_.integer_in_line("the number of values");
      const auto n = is_on_points ? grid_.n_points : std::ssize(grid_.ends);
      if (n_rows != n) in_.fail(fmt::format("{} values", n), fmt::format("{}", n_rows));
      (void)in_.line();
      attributes_.begin(is_on_points, n_rows);
    } else if (keyword == "metadata") {
      grid_.n_named_components += skip_metadata(in_) ? 1 : 0;
    } else {
      attributes_.take(keyword);
    }
  }

  void read_cells() {
    const auto n = next_count(in_, "cells"), size = in_.integer_in_line("the size of the cells");
    in_.checked_count(size, 1, "nodes of cells");
    (void)in_.line();
    skip_blank_lines(in_);
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
    skip_blank_lines(in_);
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

  TextCursor& in_;
  Grid grid_;
  LegacyNumbers numbers_;
  LegacyAttributes attributes_{in_, numbers_, grid_};
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
