// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

namespace pamr::io {

/// Notes that a file or folder has got its name with all that belongs into it: what fails later says so. Those within
/// a folder that is unfinished itself are none. The first that fit 1,000 bytes are remembered, each once. Local.
void add_complete_output(const std::filesystem::path& output) noexcept;

/// Behind the text of an error: "; complete: 'fine.hdf', 'report.json'"; empty where nothing is. It lives as long as the
/// process, and may be asked for by a signal handler. Local.
std::string_view complete_outputs() noexcept;

}  // namespace pamr::io
