// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/name_pattern.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>

#include "pamr/base/error.hpp"

namespace pamr {

bool is_name_pattern(std::string_view name) { return name.find_first_of("*?[") != std::string_view::npos; }

bool stands_for(const std::string& pattern, const std::string& name) {
  return pattern == name || (is_name_pattern(pattern) && fnmatch(pattern.c_str(), name.c_str(), 0) == 0);
}

std::optional<std::size_t> find_pattern(const std::vector<std::string>& patterns, const std::string& name,
                                        const std::string& where, const std::vector<std::string>& groups) {
  const auto itself = std::find(patterns.begin(), patterns.end(), name);
  if (itself != patterns.end()) return static_cast<std::size_t>(itself - patterns.begin());
  const auto only_one = [&](auto&& stands) {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < patterns.size(); ++i) {
      if (!stands(patterns[i])) continue;
      if (found)
        throw Error(fmt::format("{}: expected one name that stands for \"{}\", found \"{}\" and \"{}\"", where, name,
                                patterns[*found], patterns[i]));
      found = i;
    }
    return found;
  };
  const auto of_group = only_one(
      [&](const std::string& pattern) { return std::find(groups.begin(), groups.end(), pattern) != groups.end(); });
  if (of_group) return of_group;
  const auto of_pattern = only_one([&](const std::string& pattern) {
    return pattern != "*" && (stands_for(pattern, name) ||
                              std::any_of(groups.begin(), groups.end(),
                                          [&](const std::string& group) { return stands_for(pattern, group); }));
  });
  if (of_pattern) return of_pattern;
  const auto rest = std::find(patterns.begin(), patterns.end(), "*");
  return rest == patterns.end() ? std::nullopt : std::optional(static_cast<std::size_t>(rest - patterns.begin()));
}

}  // namespace pamr
