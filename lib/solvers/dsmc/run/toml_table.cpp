// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/toml_table.hpp"

#include <fmt/format.h>

#include "pamr/base/error.hpp"

namespace pamr::dsmc {

namespace {

/// What a node holds, for a message.
std::string shown(const toml::node* node) {
  if (node == nullptr) return "none";
  if (const auto text = node->value_exact<std::string>()) return "\"" + *text + "\"";
  if (const auto integer = node->value_exact<std::int64_t>()) return fmt::format("{}", *integer);
  if (const auto real = node->value_exact<double>()) return fmt::format("{:g}", *real);
  if (const auto truth = node->value_exact<bool>()) return *truth ? "true" : "false";
  return node->is_table() ? "a table" : node->is_array() ? "an array" : "a date or time";
}

}  // namespace

TomlTable::TomlTable(const toml::table& table, std::string where, std::string name)
    : table_(&table), where_(std::move(where)), name_(std::move(name)) {}

const toml::node* TomlTable::find(std::string_view key) {
  used_.insert(std::string(key));
  asked_.insert(std::string(key));
  return table_->get(key);
}

std::string TomlTable::in() const { return name_.empty() ? "" : " in [" + name_ + "]"; }

std::string TomlTable::at(std::string_view key) const {
  const toml::node* node = key.empty() ? nullptr : table_->get(key);
  const auto line = (node != nullptr ? node->source() : table_->source()).begin.line;
  return line == 0 ? where_ : fmt::format("{}:{}", where_, line);
}

void TomlTable::refuse(std::string_view key, const std::string& expected) const {
  throw Error(fmt::format("{}: expected {} = {}{}, found {}", at(key), key, expected, in(), shown(table_->get(key))));
}

double TomlTable::number(std::string_view key, double low, double high, bool open) {
  const auto* node = find(key);
  const auto value = node != nullptr && node->is_number() ? node->value<double>() : std::nullopt;
  if (value && *value >= low && *value <= high && !(open && *value == low)) return *value;
  const bool above = high == infinity, below = low == -infinity;
  refuse(key, above && below ? "a number"
              : above        ? fmt::format("a number {} {:g}", open ? "above" : "of at least", low)
                             : fmt::format("a number between {:g} and {:g}", low, high));
}

double TomlTable::number_or(std::string_view key, double otherwise, double low, double high, bool open) {
  return has(key) ? number(key, low, high, open) : otherwise;
}

std::int64_t TomlTable::integer_or(std::string_view key, std::int64_t otherwise, std::int64_t low, std::int64_t high) {
  if (!has(key)) return otherwise;
  const auto value = find(key)->value_exact<std::int64_t>();
  if (!value || *value < low || *value > high) refuse(key, fmt::format("an integer between {} and {}", low, high));
  return *value;
}

bool TomlTable::flag_or(std::string_view key, bool otherwise) {
  if (!has(key)) return otherwise;
  const auto value = find(key)->value_exact<bool>();
  if (!value) refuse(key, "true or false");
  return *value;
}

std::string TomlTable::text(std::string_view key, std::string_view expected) {
  const auto* node = find(key);
  const auto value = node != nullptr ? node->value_exact<std::string>() : std::nullopt;
  if (!value) refuse(key, std::string(expected));
  return *value;
}

std::string TomlTable::text_or(std::string_view key, const std::string& otherwise, std::string_view expected) {
  return has(key) ? text(key, expected) : otherwise;
}

std::vector<double> TomlTable::numbers(std::string_view key, std::size_t n) {
  const auto* node = find(key);
  const auto* array = node != nullptr ? node->as_array() : nullptr;
  std::vector<double> values;
  if (array != nullptr && array->size() == n)
    for (const auto& item : *array)
      if (const auto value = item.is_number() ? item.value<double>() : std::nullopt)
        if (*value > -infinity && *value < infinity) values.push_back(*value);
  if (values.size() != n) refuse(key, fmt::format("an array of {} numbers", n));
  return values;
}

geometry::Vec3 TomlTable::vector(std::string_view key) {
  const auto v = numbers(key, 3);
  return {v[0], v[1], v[2]};
}

std::vector<std::string> TomlTable::texts(std::string_view key) {
  const auto* node = find(key);
  const auto* array = node != nullptr ? node->as_array() : nullptr;
  std::vector<std::string> values;
  if (array != nullptr)
    for (const auto& item : *array)
      if (const auto value = item.value_exact<std::string>()) values.push_back(*value);
  if (array == nullptr || values.size() != array->size()) refuse(key, "an array of texts");
  return values;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) {
  const auto* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) refuse(key, "a table");
  return TomlTable(*node->as_table(), where_, name_.empty() ? std::string(key) : name_ + "." + std::string(key));
}

std::vector<std::pair<std::string, TomlTable>> TomlTable::tables() {
  std::vector<std::pair<std::string, TomlTable>> all;
  for (const auto& [key, node] : *table_) all.emplace_back(std::string(key.str()), *table(key.str()));
  return all;
}

std::vector<TomlTable> TomlTable::list(std::string_view key) {
  std::vector<TomlTable> all;
  const auto* node = find(key);
  if (node == nullptr) return all;
  if (!node->is_array_of_tables()) refuse(key, "a list of tables");
  for (const auto& item : *node->as_array())
    all.emplace_back(*item.as_table(), where_, (name_.empty() ? "" : name_ + ".") + std::string(key));
  return all;
}

void TomlTable::done() const {
  std::string known;
  for (const auto& key : asked_) known += (known.empty() ? "" : ", ") + key;
  for (const auto& [key, node] : *table_)
    if (!used_.contains(std::string(key.str())))
      throw Error(fmt::format("{}:{}: expected one of {}{}, found \"{}\"", where_, key.source().begin.line, known, in(),
                              key.str()));
}

}  // namespace pamr::dsmc
