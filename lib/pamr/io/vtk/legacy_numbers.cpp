// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/vtk/legacy_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "pamr/io/elements/numbers.hpp"

namespace pamr::io::vtk {

namespace {

constexpr std::array<LegacyType, 25> legacy_types{{{"bit", "Int8", 1},  // eight in a byte of a binary file
                                                   {"double", "Float64", 8},
                                                   {"float", "Float32", 4},
                                                   {"vtktypeint64", "Int64", 8},
                                                   {"vtkidtype", "Int32", 4},  // whatever it is in memory
                                                   {"long", "Int64", 8},
                                                   {"long_long", "Int64", 8},
                                                   {"unsigned_long", "UInt64", 8},
                                                   {"unsigned_long_long", "UInt64", 8},
                                                   {"vtktypeuint64", "UInt64", 8},
                                                   {"vtktypeint32", "Int32", 4},
                                                   {"vtktypeuint32", "UInt32", 4},
                                                   {"vtktypeint16", "Int16", 2},
                                                   {"vtktypeuint16", "UInt16", 2},
                                                   {"vtktypeint8", "Int8", 1},
                                                   {"vtktypeuint8", "UInt8", 1},
                                                   {"vtktypefloat32", "Float32", 4},
                                                   {"vtktypefloat64", "Float64", 8},
                                                   {"signed_char", "Int8", 1},
                                                   {"int", "Int32", 4},
                                                   {"unsigned_int", "UInt32", 4},
                                                   {"short", "Int16", 2},
                                                   {"unsigned_short", "UInt16", 2},
                                                   {"char", "Int8", 1},
                                                   {"unsigned_char", "UInt8", 1}}};

}  // namespace

std::string lower(std::string_view text) {
  std::string result(text);
  for (auto& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::string decoded(std::string_view text) {
  std::string result;
  const auto digit = [](char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0 ? c - '0' : (c | 32) - 'a' + 10;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_code = text[i] == '%' && i + 2 < text.size() &&
                         std::isxdigit(static_cast<unsigned char>(text[i + 1])) != 0 &&
                         std::isxdigit(static_cast<unsigned char>(text[i + 2])) != 0;
    result += is_code ? static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2])) : text[i];
    if (is_code) i += 2;
  }
  return result;
}

template <class T>
T LegacyNumbers::swapped() {
  return byteswapped(in_.value<T>("a number"));
}

const LegacyType& LegacyNumbers::type_named(std::string_view name) const {
  const auto word = lower(name);
  const auto* found =
      std::find_if(legacy_types.begin(), legacy_types.end(), [&](const auto& type) { return type.name == word; });
  if (found == legacy_types.end()) in_.fail("a type of numbers", "\"" + word.substr(0, 40) + "\"");
  return *found;
}

Values LegacyNumbers::numbers(const LegacyType& type, std::int64_t n) {
  if (type.type.starts_with("Float")) return reals(type, n);
  return integers(type, n);
}

std::vector<double> LegacyNumbers::reals(const LegacyType& type, std::int64_t n) {
  std::vector<double> values(room(type, n));
  for (auto& value : values)
    value = !binary_          ? in_.real_or_none("a number")
            : type.bytes == 4 ? static_cast<double>(swapped<float>())
                              : swapped<double>();
  return values;
}

std::vector<std::int64_t> LegacyNumbers::integers(const LegacyType& type, std::int64_t n) {
  if (binary_ && type.name == "bit") return bits(n);
  std::vector<std::int64_t> values(room(type, n));
  const bool is_signed = type.type.front() == 'I';
  for (auto& value : values) {
    if (!binary_)
      value = in_.integer("an integer");
    else if (type.bytes == 8)
      value = swapped<std::int64_t>();
    else if (type.bytes == 4)
      value = is_signed ? swapped<std::int32_t>() : std::int64_t{swapped<std::uint32_t>()};
    else if (type.bytes == 2)
      value = is_signed ? swapped<std::int16_t>() : swapped<std::uint16_t>();
    else
      value = is_signed ? swapped<std::int8_t>() : swapped<std::uint8_t>();
    if (!is_signed && value < 0) in_.fail("an integer from 0 to 2^63 - 1", "another");
  }
  return values;
}

std::vector<std::int64_t> LegacyNumbers::bits(std::int64_t n) {
  std::vector<std::int64_t> values(static_cast<std::size_t>(in_.checked_count((n + 7) / 8, 1, "bytes of bits")) * 8);
  for (std::size_t i = 0; i < values.size(); i += 8) {
    const auto byte = in_.value<std::uint8_t>("bits");
    for (std::size_t k = 0; k < 8; ++k) values[i + k] = byte >> (7U - k) & 1U;
  }
  values.resize(static_cast<std::size_t>(n));
  return values;
}

std::size_t LegacyNumbers::room(const LegacyType& type, std::int64_t n) const {
  return static_cast<std::size_t>(in_.checked_count(n, binary_ ? type.bytes : 1, "values"));
}

}  // namespace pamr::io::vtk
