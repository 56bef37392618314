// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/mesh/field.hpp"

namespace pamr::io {

/// A dataset of numbers: where it is and what it is said to hold. `values`: its contents, if it is one
/// of the small ones that are read at once (counts, numbers of regions).
struct ArrayEntry {
  std::string path;
  mesh::StorageType type = mesh::StorageType::float64;
  std::vector<std::int64_t> shape;
  std::vector<std::int64_t> values;
  bool is_chunked = false;  ///< chunked, perhaps compressed
};

/// A text dataset (one string or a list of them), or a text attribute, whose path is `<object>@<attribute>`.
struct TextEntry {
  std::string path;
  std::vector<std::string> texts;
};

/// An attribute of integers; path as for texts. 64-bit unsigned values keep their bits.
struct NumberEntry {
  std::string path;
  std::vector<std::int64_t> values;
};

/// What a native file claims to contain: everything but the large arrays.
struct Catalog {
  std::vector<ArrayEntry> arrays;
  std::vector<TextEntry> texts;
  std::vector<NumberEntry> numbers;
  std::vector<std::string> others;  ///< paths of objects that the format does not know, not all of very many
  bool has_pamr_group = false;

  const ArrayEntry* find_array(std::string_view path) const;
  const TextEntry* find_text(std::string_view path) const;
  const NumberEntry* find_number(std::string_view path) const;
};

std::string pack(const Catalog& catalog);
/// Throws `Error` when the bytes are not those of a catalog.
Catalog unpack(std::string_view bytes);

}  // namespace pamr::io
