// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/case_file.hpp"

namespace pamr {

TomlTable parse_case(std::string_view text, const std::string& where) {
  auto file = parse_toml(text, where);
  for (const auto table : case_tables) file.ignore(table);
  return file;
}

}  // namespace pamr
