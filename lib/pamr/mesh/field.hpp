// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace pamr::mesh {

/// Type of a field's values in a file. In memory all real types are doubles and all integer types 64 bits wide.
enum class StorageType : std::uint8_t { float64, float32, int64, int32, uint64, uint32, uint8, int8, int16, uint16 };

constexpr bool is_integer(StorageType type) { return type != StorageType::float64 && type != StorageType::float32; }

/// Values on nodes (P1) or on cells (constant): `n_components` per element, element by element.
struct Field {
  std::string name;
  std::string unit;
  int n_components = 1;
  StorageType storage = StorageType::float64;
  std::variant<std::vector<double>, std::vector<std::int64_t>> value;

  bool holds_integers() const { return value.index() == 1; }
  std::vector<double>& real() { return std::get<0>(value); }
  const std::vector<double>& real() const { return std::get<0>(value); }
  std::vector<std::int64_t>& integer() { return std::get<1>(value); }
  const std::vector<std::int64_t>& integer() const { return std::get<1>(value); }
};

/// Names of fields that the refiner itself writes and looks for.
/// Nodal field of the distance of each boundary node from the surfaces that it could not be put onto without turning a
/// cell over, 0 elsewhere; absent when there is no such node.
inline constexpr const char* off_surface_field = "off_surface";
/// Integer cell field of the cell of the input that each cell comes from.
inline constexpr const char* parent_field = "parent";
/// Cell field for viewers: how often a cell was split.
inline constexpr const char* level_field = "level";

using NodeField = Field;
using CellField = Field;

}  // namespace pamr::mesh
