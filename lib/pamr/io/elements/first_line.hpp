// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pamr::io {

/// What a file that is not of the expected format seems to be, by its first bytes, and what to do with it, as it stands
/// behind "found" in an error: `a mesh of Fluent: ...`. Where nothing is known, the first line. Source: the manuals of
/// the formats that are named. Local.
std::string what_begins(std::string_view bytes);

/// The same of a file; empty for one that cannot be read and for one of which nothing is known. Local.
std::string what_begins(const std::filesystem::path& file);

}  // namespace pamr::io
