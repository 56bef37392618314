// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "pamr/geometry/vec3.hpp"

namespace pamr::poisson_boltzmann {

/// A range of numbers, its ends included.
struct NumberRange {
  double low, high;
};

/// A table of a TOML file that remembers which of its keys were asked for, so that `finish` can refuse the others.
/// Every function throws `Error` with file and line. Local.
class CheckedTable {
 public:
  CheckedTable(const toml::table& table, std::string name, std::string where);

  /// A table inside this one; nothing where there is none.
  std::optional<CheckedTable> table(const std::string& key);
  /// The tables of an array of tables; none where there is no such key.
  std::vector<CheckedTable> tables(const std::string& key);
  /// All tables inside this one, whose names are free.
  std::vector<std::pair<std::string, CheckedTable>> all_tables();

  std::optional<std::string> text(const std::string& key);
  /// One of the words listed, separated by blanks in `words`; `fallback` where the key is missing.
  std::string word(const std::string& key, const std::string& words, const std::string& fallback);
  std::optional<double> number(const std::string& key, NumberRange range);
  double required_number(const std::string& key, NumberRange range);
  std::optional<bool> truth(const std::string& key);
  geometry::Vec3 required_point(const std::string& key);

  bool has(const std::string& key) const { return table_->contains(key); }
  /// Ignores a key that belongs to another tool.
  void skip(const std::string& key) { known_.insert(key); }
  /// Throws when the table has a key that nobody asked for.
  void finish() const;
  /// Throws with the line of a key (of the table where there is no such key).
  [[noreturn]] void refuse(const std::string& key, const std::string& expected, const std::string& found) const;

 private:
  const toml::node* find(const std::string& key);
  CheckedTable nested(const toml::node& node, const std::string& name) const;

  const toml::table* table_;
  std::string name_;
  std::string where_;
  std::set<std::string> known_;
};

/// What a node holds, for a message.
std::string shown(const toml::node& node);

}  // namespace pamr::poisson_boltzmann
