// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/checked_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

#include "pamr/base/error.hpp"

namespace pamr::poisson_boltzmann {

namespace {

std::string bounds(NumberRange range) {
  if (std::isinf(range.high)) return fmt::format("a number of at least {:g}", range.low);
  return fmt::format("a number between {:g} and {:g}", range.low, range.high);
}

}  // namespace

std::string shown(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return fmt::format("\"{}\"", *text);
  if (const auto integer = node.value_exact<std::int64_t>()) return fmt::format("{}", *integer);
  if (const auto real = node.value_exact<double>()) return fmt::format("{:g}", *real);
  if (const auto truth = node.value_exact<bool>()) return *truth ? "true" : "false";
  return node.is_table() ? "a table" : node.is_array() ? "an array" : "a date or time";
}

CheckedTable::CheckedTable(const toml::table& table, std::string name, std::string where)
    : table_(&table), name_(std::move(name)), where_(std::move(where)) {}

void CheckedTable::refuse(const std::string& key, const std::string& expected, const std::string& found) const {
  const auto* node = table_->get(key);
  const auto& source = node == nullptr ? table_->source() : node->source();
  throw Error(fmt::format("{}:{}: expected {}, found {}", where_, source.begin.line, expected, found));
}

const toml::node* CheckedTable::find(const std::string& key) {
  known_.insert(key);
  return table_->get(key);
}

CheckedTable CheckedTable::nested(const toml::node& node, const std::string& name) const {
  const auto full = name_.empty() ? name : name_ + "." + name;
  if (const auto* table = node.as_table()) return {*table, full, where_};
  throw Error(
      fmt::format("{}:{}: expected a table [{}], found {}", where_, node.source().begin.line, full, shown(node)));
}

std::optional<CheckedTable> CheckedTable::table(const std::string& key) {
  const auto* node = find(key);
  if (node == nullptr) return std::nullopt;
  return nested(*node, key);
}

std::vector<CheckedTable> CheckedTable::tables(const std::string& key) {
  std::vector<CheckedTable> result;
  const auto* node = find(key);
  if (node == nullptr) return result;
  const auto* array = node->as_array();
  if (array == nullptr) refuse(key, "tables [[" + key + "]]", shown(*node));
  for (const auto& entry : *array) result.push_back(nested(entry, key));
  return result;
}

std::vector<std::pair<std::string, CheckedTable>> CheckedTable::all_tables() {
  std::vector<std::pair<std::string, CheckedTable>> result;
  for (const auto& [key, node] : *table_) {
    known_.insert(std::string(key.str()));
    result.emplace_back(std::string(key.str()), nested(node, std::string(key.str())));
  }
  return result;
}

std::optional<std::string> CheckedTable::text(const std::string& key) {
  const auto* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value_exact<std::string>();
  if (!value) refuse(key, key + " = \"text\"", shown(*node));
  return *value;
}

std::string CheckedTable::word(const std::string& key, const std::string& words, const std::string& fallback) {
  const auto value = text(key);
  if (!value) return fallback;
  std::istringstream list(words);
  std::string expected;
  for (std::string word; list >> word;) {
    if (word == *value) return word;
    expected += (expected.empty() ? "\"" : ", \"") + word + "\"";
  }
  refuse(key, fmt::format("{} = one of {}", key, expected), "\"" + *value + "\"");
}

std::optional<double> CheckedTable::number(const std::string& key, NumberRange range) {
  const auto* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value || !(*value >= range.low && *value <= range.high) || !std::isfinite(*value))
    refuse(key, fmt::format("{} = {}", key, bounds(range)), shown(*node));
  return *value;
}

double CheckedTable::required_number(const std::string& key, NumberRange range) {
  const auto value = number(key, range);
  if (!value) refuse(key, fmt::format("{} = {} in [{}]", key, bounds(range), name_), "none");
  return *value;
}

std::optional<bool> CheckedTable::truth(const std::string& key) {
  const auto* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = node->value_exact<bool>();
  if (!value) refuse(key, key + " = true or false", shown(*node));
  return *value;
}

geometry::Vec3 CheckedTable::required_point(const std::string& key) {
  const auto* node = find(key);
  const auto* array = node == nullptr ? nullptr : node->as_array();
  const auto expected = fmt::format("{} = three numbers in [{}]", key, name_);
  if (array == nullptr || array->size() != 3) refuse(key, expected, node == nullptr ? "none" : shown(*node));
  double value[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const auto* entry = array->get(i);
    const auto number = entry->is_number() ? entry->value<double>() : std::nullopt;
    if (!number || !std::isfinite(*number)) refuse(key, expected, shown(*entry));
    value[i] = *number;
  }
  return {value[0], value[1], value[2]};
}

void CheckedTable::finish() const {
  for (const auto& [key, node] : *table_) {
    const std::string name(key.str());
    if (known_.contains(name)) continue;
    std::string expected;
    for (const auto& known : known_) expected += (expected.empty() ? "" : ", ") + known;
    throw Error(fmt::format("{}:{}: expected one of {} in {}, found \"{}\"", where_, key.source().begin.line, expected,
                            name_.empty() ? "the file" : "[" + name_ + "]", name));
  }
}

}  // namespace pamr::poisson_boltzmann
