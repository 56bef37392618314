// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/native/catalog.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// The contents of a file: what `inspect` lists in a process of its own, forked from rank 0, with limits on processor
/// time and memory; when that process dies, the file is refused like any other bad file (`subprocess.hpp` says why).
/// Collective; the same catalog or `Error` on every rank.
Catalog catalog_of(const par::Comm& comm, const std::filesystem::path& file);

}  // namespace pamr::io
