// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace pamr {

/// The bytes of a file; nothing where it cannot be opened, or not be read to its end. Local.
std::optional<std::string> read_file(const std::filesystem::path& file);

}  // namespace pamr
