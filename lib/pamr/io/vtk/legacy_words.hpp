// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>

#include "pamr/io/elements/text_cursor.hpp"

/// Lines and words of VTK's legacy files. Local.
namespace pamr::io::vtk {

void skip_blank_lines(TextCursor& in);

/// The next word of this line, without blanks; throws `Error` where the line ends.
std::string_view next_word(TextCursor& in, std::string_view what);

/// The next number of this line, which announces so many items: the file has a byte for each at least.
std::int64_t next_count(TextCursor& in, std::string_view what);

/// Passes `METADATA`, behind that word: lines up to an empty one. True if they name components, which a field of a mesh
/// does not.
bool skip_metadata(TextCursor& in);

}  // namespace pamr::io::vtk
