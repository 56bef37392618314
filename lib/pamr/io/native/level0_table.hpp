// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "pamr/mesh/field.hpp"
#include "pamr/mesh/level0_map.hpp"

/// The table of the map of level 0 in files: a row of each dataset for each bent cell (docs/file-format-level0.md).
namespace pamr::io {

/// A row of all datasets as 64-bit words: integers sign-extended, reals by their bits.
inline constexpr std::size_t n_level0_words = 71;
using Level0Words = std::array<std::uint64_t, n_level0_words>;

struct Level0Column {
  const char* name;  ///< of the dataset
  mesh::StorageType type;
  std::size_t first;  ///< of its words in a row
  std::size_t width;

  std::string path() const;
};

enum class Level0Dataset : std::uint8_t { corners, points, bulges, face_patches, edge_patches, beside, flags };

inline constexpr std::array<Level0Column, 7> level0_columns{{
    {"corners", mesh::StorageType::int64, 0, 4},        // numbers in level 0
    {"points", mesh::StorageType::float64, 4, 12},      // of the corners
    {"bulges", mesh::StorageType::float64, 16, 18},     // of the edges
    {"face_patches", mesh::StorageType::int32, 34, 4},  // -1: not in a curved wall
    {"edge_patches", mesh::StorageType::int32, 38, 12},
    {"beside", mesh::StorageType::float64, 50, 18},
    {"flags", mesh::StorageType::uint8, 68, 3},  // sharp edges, creases, bent corners
}};
static_assert(level0_columns.back().first + level0_columns.back().width == n_level0_words);

constexpr const Level0Column& column_of(Level0Dataset dataset) {
  return level0_columns[static_cast<std::size_t>(dataset)];
}

Level0Words words_of(const mesh::Level0Cell& cell);
/// Pre: the words are in range.
mesh::Level0Cell level0_cell_of(GlobalId row, const Level0Words& words);

}  // namespace pamr::io
