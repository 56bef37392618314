// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/gate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "pamr/base/error.hpp"
#include "pamr/base/nearest_word.hpp"

namespace pamr::check {

namespace {

void collect(const nlohmann::json& value, const std::string& path, std::vector<std::pair<std::string, double>>& found) {
  if (value.is_structured()) {
    for (const auto& [key, inner] : value.items())
      if (key != "histogram") collect(inner, path.empty() ? key : path + "." + key, found);
  } else if (value.is_number()) {
    found.emplace_back(path, value.get<double>());
  } else if (value.is_boolean()) {
    found.emplace_back(path, value.get<bool>() ? 1.0 : 0.0);
  } else if (value.is_null()) {
    found.emplace_back(path, std::numeric_limits<double>::quiet_NaN());
  }
}

/// True when the whole text is a finite number.
bool read_number(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

[[noreturn]] void refuse(const std::string& text) {
  throw Error("--gate: expected NAME:min:V or NAME:max:V with a number V, found \"" + text + "\"");
}

}  // namespace

Gate parse_gate(const std::string& text) {
  const auto second = text.rfind(':');
  if (second == std::string::npos || second == 0) refuse(text);
  const auto first = text.rfind(':', second - 1);
  if (first == std::string::npos || first == 0) refuse(text);
  const auto kind = text.substr(first + 1, second - first - 1);
  Gate gate{text, text.substr(0, first), kind == "min" ? Gate::Kind::min : Gate::Kind::max, 0};
  if ((kind != "min" && kind != "max") || !read_number(std::string_view(text).substr(second + 1), gate.bound))
    refuse(text);
  return gate;
}

std::vector<std::pair<std::string, double>> numbers_of(const nlohmann::json& report) {
  std::vector<std::pair<std::string, double>> found;
  collect(report, "", found);
  return found;
}

std::string why_failed(const Gate& gate, const std::vector<std::pair<std::string, double>>& numbers) {
  const auto find = [&](const std::string& name) {
    return std::find_if(numbers.begin(), numbers.end(), [&](const auto& number) { return number.first == name; });
  };
  const bool is_min = gate.kind == Gate::Kind::min;
  auto at = find(gate.name);
  if (at == numbers.end()) at = find(gate.name + (is_min ? ".min" : ".max"));
  if (at == numbers.end()) {
    std::vector<std::string> names;
    for (const auto& [name, value] : numbers) names.push_back(name);
    auto near = nearest_word(gate.name, names);
    if (!near) {  // the metric of mean_ratio.min may be what is misspelt
      std::vector<std::string> metrics;
      for (const auto& name : names) metrics.push_back(name.substr(0, name.find('.')));
      near = nearest_word(gate.name, metrics);
    }
    std::string hint = "the report has:";
    for (const auto& known : names) hint += " " + known;
    if (near) hint = "did you mean '" + *near + "'?";
    throw Error("--gate " + gate.text + ": unknown number '" + gate.name + "'; " + hint);
  }
  const auto& [name, value] = *at;
  if (is_min ? value >= gate.bound : value <= gate.bound) return {};
  return fmt::format("gate failed: {} is {:.6g}, expected at {} {:.6g}", name, value, is_min ? "least" : "most",
                     gate.bound);
}

}  // namespace pamr::check
