// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "pamr/mesh/lineage.hpp"

/// The word of a cell's lineage in a file, by the number of the file's format (docs/file-format-lineage.md).
namespace pamr::io {

/// The lineage that a word stands for; none when it stands for nothing. That of format 1 knows no ancestors.
std::optional<mesh::Lineage> lineage_of_word(int format, std::uint64_t word);

/// True when a format has a word for this lineage: format 1 has none for families other than 1:2 and 1:4.
bool has_word(int format, mesh::Lineage lineage);

/// The word of a lineage. Format 1 drops what the cell knows of its ancestors. Pre: `has_word`.
std::uint64_t word_of_lineage(int format, mesh::Lineage lineage);

}  // namespace pamr::io
