// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pamr/io/elements/text_cursor.hpp"
#include "pamr/io/vtk/legacy_numbers.hpp"
#include "pamr/io/vtk/vtk_grid.hpp"

namespace pamr::io::vtk {

/// Reads the data of VTK's legacy files, on points, on cells and of the whole grid, into the arrays of a grid. Local.
/// Source: VTK file formats, "Legacy file formats", *Dataset attribute format*.
class LegacyAttributes {
 public:
  LegacyAttributes(TextCursor& in, LegacyNumbers& numbers, Grid& grid) : in_(in), numbers_(numbers), grid_(grid) {}

  /// What follows belongs to points, or to cells: so many.
  void begin(bool on_points, std::int64_t n_rows);
  /// Takes one attribute, behind its keyword in lower case. Throws `Error` for a keyword that is none, and outside of
  /// `begin` for all but field data.
  void take(const std::string& keyword);

 private:
  void read_field_data();
  void read_table();
  void skip_texts(std::int64_t n);
  const LegacyType& type_of_colors() const;
  void keep_colors(const std::string& name, std::int64_t width);
  void keep(const std::string& name, const LegacyType& type, std::int64_t width, std::int64_t n);

  TextCursor& in_;
  LegacyNumbers& numbers_;
  Grid& grid_;
  bool is_on_points_ = false;
  std::optional<std::int64_t> n_rows_;
};

}  // namespace pamr::io::vtk
