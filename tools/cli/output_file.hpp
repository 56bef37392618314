// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "pamr/par/comm.hpp"

namespace pamr::cli {

/// Throws `Error` unless `path` is an existing regular file or folder that can be read. Local.
void require_readable(const std::string& path);
/// Throws `Error` for /dev/stdin, /dev/fd/3 and the like, whatever they stand for: a mesh is opened by name several
/// times, by a child process and by all ranks, which have streams of their own. Local.
void require_named(const std::string& path);
/// True for what exists and is neither a regular file nor a folder. Local.
bool is_device(const std::string& path);
/// Throws `Error` unless `write_whole` can be expected to succeed. Local.
void require_replaceable(const std::string& path);
/// Throws `Error` unless `path` can be created or, with `force`, replaced. Local.
void require_writable(const std::string& path, bool force);

/// Writes `text` to `path` under a temporary name and renames it: either all of it or nothing arrives, and an existing
/// file is replaced in one step. A path that is a device or pipe is written directly. Throws `Error`. Local.
void write_whole(const std::string& path, const std::string& text);
/// The same by rank 0, whose text counts. Collective; throws the same `Error` on every rank.
void write_whole(const par::Comm& comm, const std::string& path, const std::string& text);

}  // namespace pamr::cli
