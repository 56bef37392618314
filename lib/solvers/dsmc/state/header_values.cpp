// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/header_values.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "pamr/base/error.hpp"

namespace pamr::dsmc {

namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& name, const std::string& expected, const json& found) {
  throw Error(fmt::format("checkpoint: expected {} = {}, found {}", name, expected, short_text(found)));
}

}  // namespace

std::string short_text(const json& value) {
  constexpr std::size_t longest = 60;
  auto text = value.dump(-1, ' ', true, json::error_handler_t::replace);
  if (text.size() > longest) text = text.substr(0, longest) + "...";
  return text;
}

const json& member(const json& object, const std::string& key) {
  if (!object.is_object()) refuse("the place of " + key, "a group of values", object);
  const auto found = object.find(key);
  if (found == object.end()) throw Error(fmt::format("checkpoint: expected a value {}, found none", key));
  return *found;
}

const json& array_of(const json& value, const std::string& name, std::size_t n) {
  const bool any = n == std::numeric_limits<std::size_t>::max();
  if (!value.is_array() || (!any && value.size() != n))
    refuse(name, any ? std::string("an array") : fmt::format("an array of {}", n), value);
  return value;
}

std::int64_t count_of(const json& value, const std::string& name, std::int64_t high) {
  const bool fits = value.is_number_unsigned() ? value.get<std::uint64_t>() <= static_cast<std::uint64_t>(high)
                                               : value.is_number_integer() && value.get<std::int64_t>() >= 0 &&
                                                     value.get<std::int64_t>() <= high;
  if (!fits) refuse(name, fmt::format("an integer from 0 to {}", high), value);
  return value.get<std::int64_t>();
}

std::int64_t integer_of(const json& value, const std::string& name) {
  constexpr auto far = std::int64_t{1} << 56U;
  const bool fits = value.is_number_unsigned() ? value.get<std::uint64_t>() < static_cast<std::uint64_t>(far)
                                               : value.is_number_integer() && value.get<std::int64_t>() > -far;
  if (!fits) refuse(name, "an integer of less than 57 bits", value);
  return value.get<std::int64_t>();
}

std::uint64_t word_of(const json& value, const std::string& name) {
  if (!value.is_number_unsigned()) refuse(name, "an integer of 64 bits", value);
  return value.get<std::uint64_t>();
}

double number_of(const json& value, const std::string& name) {
  if (!value.is_number() || !std::isfinite(value.get<double>())) refuse(name, "a finite number", value);
  return value.get<double>();
}

bool truth_of(const json& value, const std::string& name) {
  if (!value.is_boolean()) refuse(name, "true or false", value);
  return value.get<bool>();
}

std::string string_of(const json& value, const std::string& name) {
  if (!value.is_string()) refuse(name, "a text", value);
  return value.get<std::string>();
}

}  // namespace pamr::dsmc
