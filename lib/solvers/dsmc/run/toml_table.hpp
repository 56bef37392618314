// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <toml++/toml.h>

#include <limits>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/geometry/vec3.hpp"

namespace pamr::dsmc {

/// One table of a TOML file, read key by key; `done` refuses the keys that nobody asked for. All functions throw
/// `Error` with file and line, what was expected and what was found.
class TomlTable {
 public:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  /// `name` is the table's full name, empty for the file itself.
  TomlTable(const toml::table& table, std::string where, std::string name);

  bool has(std::string_view key) const {
    asked_.insert(std::string(key));
    return table_->contains(key);
  }
  /// A number in [low, high]; `open` leaves out `low` itself.
  double number(std::string_view key, double low, double high, bool open = false);
  double number_or(std::string_view key, double otherwise, double low, double high, bool open = false);
  std::int64_t integer_or(std::string_view key, std::int64_t otherwise, std::int64_t low, std::int64_t high);
  bool flag_or(std::string_view key, bool otherwise);
  std::string text(std::string_view key, std::string_view expected);
  std::string text_or(std::string_view key, const std::string& otherwise, std::string_view expected);
  std::vector<double> numbers(std::string_view key, std::size_t n);
  geometry::Vec3 vector(std::string_view key);
  std::vector<std::string> texts(std::string_view key);

  /// A table within this one; nothing when there is none.
  std::optional<TomlTable> table(std::string_view key);
  /// All tables within this one, by name, in alphabetical order.
  std::vector<std::pair<std::string, TomlTable>> tables();
  /// A list of tables, `[[key]]`.
  std::vector<TomlTable> list(std::string_view key);
  void ignore(std::string_view key) { used_.insert(std::string(key)); }

  /// Throws when the table has a key that was not read.
  void done() const;

  /// File and line, of the key where there is one.
  std::string at(std::string_view key = {}) const;
  [[noreturn]] void refuse(std::string_view key, const std::string& expected) const;

 private:
  const toml::node* find(std::string_view key);
  std::string in() const;

  const toml::table* table_;
  std::string where_, name_;
  std::set<std::string> used_;
  mutable std::set<std::string> asked_;  ///< keys that could have been there: for messages
};

}  // namespace pamr::dsmc
