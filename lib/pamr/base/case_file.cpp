// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/case_file.hpp"

#include <filesystem>
#include <optional>

#include "pamr/base/error.hpp"

namespace pamr {

namespace {

/// `look(table)`, or nothing where the table or its value is of another kind: the tool that reads it says so.
template <class Look>
auto if_sound(Look look) -> decltype(look()) {
  try {
    return look();
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

TomlTable parse_case(std::string_view text, const std::string& where) {
  auto file = parse_toml(text, where);
  for (const auto table : case_tables) file.ignore(table);
  return file;
}

std::vector<std::string> files_of_case(std::string_view text, const std::string& where) {
  const auto root = parse_toml(text, where);
  const auto folder = std::filesystem::path(where).parent_path();
  std::vector<std::string> files;
  const auto add = [&](const TomlTable& table, std::string_view key) {
    if (const auto name = if_sound([&] { return table.find_text(key); })) files.push_back((folder / *name).string());
  };
  for (const auto& surface : if_sound([&] { return root.list("surface"); })) add(surface, "file");
  if (const auto gas = if_sound([&] { return root.find_table("gas"); })) add(*gas, "species_file");
  return files;
}

}  // namespace pamr
