// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/case_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"

namespace pamr::meshing {
namespace {

/// Where the tables that have a header begin, with whether they describe surfaces.
using Headers = std::vector<std::pair<std::size_t, bool>>;

void find_headers(const toml::node& node, bool is_surface, Headers& headers) {
  if (const auto* array = node.as_array())
    for (const auto& element : *array) find_headers(element, is_surface, headers);
  const auto* table = node.as_table();
  if (table == nullptr || table->is_inline()) return;
  headers.emplace_back(table->source().begin.line, is_surface);
  for (const auto& [key, inner] : *table) find_headers(inner, is_surface, headers);
}

}  // namespace

void refuse(const std::string& where, const toml::source_region& source, const std::string& expected,
            const std::string& found) {
  throw Error(
      fmt::format("{}:{}:{}: expected {}, found {}", where, source.begin.line, source.begin.column, expected, found));
}

std::string quoted(std::string_view text) { return "\"" + std::string(text) + "\""; }

std::string shown(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return quoted(*text);
  if (const auto integer = node.value_exact<std::int64_t>()) return fmt::format("{}", *integer);
  if (const auto real = node.value_exact<double>()) return fmt::format("{:g}", *real);
  if (const auto truth = node.value_exact<bool>()) return *truth ? "true" : "false";
  return node.is_table() ? "a table" : node.is_array() ? "an array" : "a date or time";
}

std::string surfaces_of(const toml::table& root, std::string_view text) {
  Headers headers;
  for (const auto& [key, node] : root) find_headers(node, key.str() == "surface", headers);
  std::sort(headers.begin(), headers.end());
  std::string result;
  std::size_t line = 1, next = 0;
  bool is_kept = false;
  for (std::size_t at = 0; at < text.size(); ++line) {
    const auto end = std::min(text.find('\n', at), text.size());
    for (; next < headers.size() && headers[next].first <= line; ++next) is_kept = headers[next].second;
    if (is_kept) result += text.substr(at, end - at);
    result += '\n';
    at = end + 1;
  }
  return result;
}

}  // namespace pamr::meshing
