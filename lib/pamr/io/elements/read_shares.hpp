// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>

#include "pamr/io/elements/element_parts.hpp"
#include "pamr/io/elements/text_cursor.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Reads the shares of a file on all ranks: `is_text` looks at its beginning, `read` at the rest. In a text the ranks
/// count the lines together first, so that each finds its share without running through the rest. Collective; what
/// either function throws on any rank is thrown on every rank.
ElementParts read_shares(const par::Comm& comm, const std::filesystem::path& file,
                         const std::function<bool(TextCursor&)>& is_text,
                         const std::function<ElementParts(TextCursor&, Share)>& read);

}  // namespace pamr::io
