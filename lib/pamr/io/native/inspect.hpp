// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "pamr/io/native/catalog.hpp"

namespace pamr::io {

/// Lists the contents of a file with HDF5. Throws `Error` for a file or an object of an unexpected kind. A damaged file
/// may crash or stall HDF5 1.10 itself. Local; `catalog_of` (preflight.hpp) is for all ranks.
Catalog inspect(const std::filesystem::path& file);

}  // namespace pamr::io
