// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/vtk/legacy_attributes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pamr/base/counted.hpp"
#include "pamr/io/text.hpp"
#include "pamr/io/vtk/legacy_words.hpp"

namespace pamr::io::vtk {

void LegacyAttributes::begin(bool on_points, std::int64_t n_rows) {
  is_on_points_ = on_points;
  n_rows_ = n_rows;
}

void LegacyAttributes::take(const std::string& keyword) {
  if (keyword == "field") return read_field_data();
  if (!n_rows_) in_.fail("POINT_DATA or CELL_DATA before " + keyword.substr(0, 40), "none");
  if (keyword == "lookup_table") return read_table();
  const auto name = decoded(next_word(in_, "a name"));
  if (keyword == "color_scalars") {
    const auto n = next_count(in_, "colors");
    (void)in_.line();
    return keep_colors(name, n);
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
  const auto& type = numbers_.type_named(next_word(in_, "a type of numbers"));
  if (keyword == "scalars") {
    if (!in_.is_line_over('\n')) width = in_.integer_in_line("the number of components");
    (void)in_.line();
    if (lower(in_.rest().substr(0, 12)) == "lookup_table") (void)in_.line();  // which table: they are left out
  } else {
    (void)in_.line();
  }
  keep(name, type, width, *n_rows_);
}

/// Red, green, blue and opacity of each value.
void LegacyAttributes::read_table() {
  const auto name = decoded(next_word(in_, "a name"));
  const auto n = next_count(in_, "colors");
  (void)in_.line();
  (void)numbers_.numbers(type_of_colors(), 4 * n);
  grid_.remarks.push_back(
      fmt::format("the table '{}' of {} was left out (LOOKUP_TABLE)", shown_text(name), counted(n, "color", "colors")));
}

void LegacyAttributes::read_field_data() {
  (void)next_word(in_, "the name of field data");
  const auto n_arrays = next_count(in_, "arrays");
  (void)in_.line();
  for (std::int64_t i = 0; i < n_arrays; ++i) {
    skip_blank_lines(in_);
    auto name = decoded(next_word(in_, "the name of an array"));
    while (lower(name) == "metadata") {
      grid_.n_named_components += skip_metadata(in_) ? 1 : 0;
      skip_blank_lines(in_);
      name = decoded(next_word(in_, "the name of an array"));
    }
    const auto width = in_.integer_in_line("the number of components");
    const auto n = in_.integer_in_line("the number of values");
    const auto type = lower(next_word(in_, "a type of numbers"));
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
void LegacyAttributes::skip_texts(std::int64_t n) {
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

const LegacyType& LegacyAttributes::type_of_colors() const {
  return numbers_.type_named(numbers_.is_binary() ? "unsigned_char" : "float");
}

/// VTK calls bytes colors: 0 to 255, in text 0 to 1.
void LegacyAttributes::keep_colors(const std::string& name, std::int64_t width) {
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
void LegacyAttributes::keep(const std::string& name, const LegacyType& type, std::int64_t width, std::int64_t n) {
  if (width < 1 || width > 65536) in_.fail("1 to 65536 components", fmt::format("{}", width));
  in_.checked_count(n < 0 ? n : n / 8, 1, "values");  // eight bits a byte
  if (!n_rows_ && width * n == 1 && is_patch_name(name)) {
    name_patch(grid_, name, numbers_.integers(type, 1).front());
    return;
  }
  auto values = std::make_shared<Values>(numbers_.numbers(type, width * n));
  if (n_rows_ && n == *n_rows_)
    grid_.arrays.push_back({is_on_points_, name, std::string(type.type), width, [values] { return *values; }});
  else
    grid_.left_out.push_back(name);
}

}  // namespace pamr::io::vtk
