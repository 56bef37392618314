// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pamr/mesh/field.hpp"

/// The XML files of VTK: their arrays, as text, base64 or raw bytes, compressed by zlib or not. Local; nothing in the
/// file is trusted.
namespace pamr::io::vtk {

/// One `DataArray`.
struct XmlArray {
  std::string place;  ///< the element around it: Points, Cells, PointData, CellData, ...
  std::string name, type, format;
  std::int64_t n_components = 1;
  bool has_component_names = false;
  std::size_t offset = 0;    ///< of appended data
  std::string_view content;  ///< what stands inside otherwise
};

/// An unstructured grid of one piece.
struct XmlGrid {
  std::int64_t n_points = 0, n_cells = 0;
  std::vector<XmlArray> arrays;
  bool is_compressed = false, has_wide_header = false, is_raw = false;
  std::string_view appended;  ///< what follows the underscore

  /// The array of that name (empty: the first one) at that place, or null.
  const XmlArray* find(std::string_view place, std::string_view name) const;
};

/// Reads the structure. The text is changed, and has to outlive the result. Throws `Error`, without the name of the
/// file.
XmlGrid parse_grid(std::string& text);

using Values = std::variant<std::vector<double>, std::vector<std::int64_t>>;

bool is_number_type(std::string_view type);
/// The type of an array's values. Throws `Error` for one that is none of numbers.
mesh::StorageType storage_of(std::string_view type);

/// `n` values of an array: reals as doubles, integers of 64 bits. Throws `Error` for more, fewer and others.
Values values_of(const XmlGrid& grid, const XmlArray& array, std::int64_t n);
/// The same of an array of integers.
std::vector<std::int64_t> integers_of(const XmlGrid& grid, const XmlArray& array, std::int64_t n);

}  // namespace pamr::io::vtk
