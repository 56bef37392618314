// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pamr::io {

/// The format that a file seems to have by its first bytes, and how to make a file of it that can be read, as text to
/// follow "found" in an error: `a mesh of Fluent: ...`. For unknown formats the first line. Source: the manuals of
/// the formats that are named. Local.
std::string what_begins(std::string_view bytes);

/// The same of a file; empty for one that cannot be read and for one of which nothing is known. Local.
std::string what_begins(const std::filesystem::path& file);

}  // namespace pamr::io
