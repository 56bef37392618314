// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>

/// Values of a checkpoint's header, each of the type and in the range that it must have. All functions throw `Error`
/// with the name of the value otherwise. Local.
namespace pamr::dsmc {

/// More steps than any computation does, and more things than any file holds.
inline constexpr std::int64_t max_count = std::int64_t{1} << 60U;

/// A value as text, cut off where it is long.
std::string short_text(const nlohmann::json& value);
/// A member of an object.
const nlohmann::json& member(const nlohmann::json& object, const std::string& key);
/// An array of so many items, or of any number.
const nlohmann::json& array_of(const nlohmann::json& value, const std::string& name,
                               std::size_t n = std::numeric_limits<std::size_t>::max());
/// An integer in a range, ends included.
std::int64_t count_of(const nlohmann::json& value, const std::string& name, std::int64_t high = max_count);
/// An integer of either sign, of less than 57 bits, so that some can be added.
std::int64_t integer_of(const nlohmann::json& value, const std::string& name);
/// Any 64 bits.
std::uint64_t word_of(const nlohmann::json& value, const std::string& name);
/// A finite number.
double number_of(const nlohmann::json& value, const std::string& name);
bool truth_of(const nlohmann::json& value, const std::string& name);
std::string string_of(const nlohmann::json& value, const std::string& name);

}  // namespace pamr::dsmc
