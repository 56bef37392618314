// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace pamr::cli {

/// Throws `Error` unless `path` is an existing regular file or folder that can be read. Local.
void require_readable(const std::string& path);
/// Throws `Error` when `path` and one of `others` are the same file. Local.
void require_distinct(const std::string& path, const std::vector<std::string>& others);
/// Throws `Error` unless `write_whole` can be expected to succeed. Local.
void require_replaceable(const std::string& path);
/// Throws `Error` unless `path` can be created or, with `force`, replaced, and is none of `others`. Local.
void require_writable(const std::string& path, const std::vector<std::string>& others, bool force);

/// Writes `text` to `path` under a temporary name and renames it: either all of it or nothing arrives, and an existing
/// file is replaced in one step. A path that is a device or pipe is written directly. Throws `Error`. Local.
void write_whole(const std::string& path, const std::string& text);

}  // namespace pamr::cli
