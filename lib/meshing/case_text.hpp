// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <toml++/toml.h>

#include <string>
#include <string_view>

/// What reading case files needs besides the reader of TOML.
namespace pamr::meshing {

/// Throws `Error` that says where (file, line, column), what was expected and what was found.
[[noreturn]] void refuse(const std::string& where, const toml::source_region& source, const std::string& expected,
                         const std::string& found);

std::string quoted(std::string_view text);

/// What a node holds, for a message.
std::string shown(const toml::node& node);

/// The case file with nothing but its tables [[surface]] left, every one in its line.
std::string surfaces_of(const toml::table& root, std::string_view text);

}  // namespace pamr::meshing
