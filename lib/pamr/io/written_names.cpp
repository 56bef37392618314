// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/written_names.hpp"

#include <fmt/format.h>

#include <map>

#include "pamr/base/error.hpp"

namespace pamr::io {

namespace {

std::string shown(const std::string& name) {
  constexpr std::size_t longest = 60;
  return name.size() > longest ? cut_to(name, longest) + "..." : name;
}

}  // namespace

std::string cut_to(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  const auto is_inside = [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) == 0x80U; };
  while (most > 0 && is_inside(text[most])) --most;
  return std::string(text.substr(0, most));
}

void check_written_names(std::string_view format, std::string_view what, const std::vector<std::string>& names,
                         const std::vector<std::string>& written, const Remark& remark) {
  std::map<std::string_view, std::string_view> from;
  std::size_t n_changed = 0;
  std::string first;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [known, is_new] = from.emplace(written[i], names[i]);
    if (!is_new && known->second != names[i])
      throw Error(fmt::format("{} '{}': expected names that stay different in {}, found '{}' for '{}', too", what,
                              shown(names[i]), format, shown(written[i]), shown(std::string(known->second))));
    if (written[i] == names[i]) continue;
    if (n_changed++ == 0)
      first = fmt::format("{}: {} '{}' is written as '{}'", format, what, shown(names[i]), shown(written[i]));
  }
  if (n_changed > 0 && remark)
    remark(n_changed == 1 ? first : fmt::format("{}, and {} other names are changed, too", first, n_changed - 1));
}

}  // namespace pamr::io
