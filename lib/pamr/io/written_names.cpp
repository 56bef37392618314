// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/written_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <set>

namespace pamr::io {

namespace {

/// The beginning of a text, `most` bytes long or a little less: no character in UTF-8 is cut.
std::string cut_to(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  const auto is_inside = [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U; };
  while (most > 0 && is_inside(text[most])) --most;
  return std::string(text.substr(0, most));
}

std::string short_form(const std::string& name) {
  constexpr std::size_t longest = 60;
  return name.size() > longest ? cut_to(name, longest) + "..." : name;
}

}  // namespace

std::vector<std::string> written_names(const NameRule& rule, const std::vector<std::string>& names,
                                       const Remark& remark, const std::vector<std::string>& endings) {
  std::set<std::string> taken(rule.taken.begin(), rule.taken.end());
  const auto ending_of = [&](std::size_t i) { return endings.empty() ? std::string() : endings[i]; };
  const auto with = [&](std::size_t i, const std::string& number) {
    const auto ending = number + ending_of(i);
    auto name = cut_to(names[i], rule.longest - std::min(ending.size(), rule.longest)) + ending;
    std::replace_if(
        name.begin(), name.end(), [&](char c) { return !rule.is_allowed(c); }, rule.instead);
    if (!rule.has_outer_blanks) {
      const auto is_word = [](char c) { return c != ' '; };
      std::fill(name.begin(), std::find_if(name.begin(), name.end(), is_word), rule.instead);
      std::fill(std::find_if(name.rbegin(), name.rend(), is_word).base(), name.end(), rule.instead);
    }
    return name;
  };
  std::vector<std::string> written(names.size());
  std::vector<std::size_t> changed;
  for (std::size_t i = 0; i < names.size(); ++i) {
    written[i] = with(i, "");
    if (written[i] != names[i] + ending_of(i) || !taken.insert(written[i]).second) changed.push_back(i);
  }
  for (const auto i : changed)
    for (std::int64_t number = 2; !taken.insert(written[i]).second; ++number)
      written[i] = with(i, fmt::format("_{}", number));
  if (changed.empty() || !remark) return written;
  const auto first = changed.front();
  const auto text = fmt::format("{}: {} '{}' is written as '{}'", rule.format, rule.what,
                                short_form(names[first] + ending_of(first)), short_form(written[first]));
  remark(changed.size() == 1 ? text : fmt::format("{}, and {} other names are changed, too", text, changed.size() - 1));
  return written;
}

}  // namespace pamr::io
