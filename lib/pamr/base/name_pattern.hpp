// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pamr {

/// True if a name may stand for several: it has one of the shell's signs `*`, `?` and `[`.
bool is_name_pattern(std::string_view name);

/// True if `pattern` is that name, or stands for it as the names of files do in the shell (POSIX fnmatch): `*` is any
/// letters, `?` one, `[abc]` one of these.
bool stands_for(const std::string& pattern, const std::string& name);

/// Index of the pattern that stands for the name: the name itself first, then `groups` that it is in, then patterns for
/// it or for one of these, `*` alone last; nothing if there is none. Throws `Error`, which begins with `where` and names
/// both, if two groups or two patterns do.
std::optional<std::size_t> find_pattern(const std::vector<std::string>& patterns, const std::string& name,
                                        const std::string& where, const std::vector<std::string>& groups = {});

}  // namespace pamr
