// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/io/elements/text_cursor.hpp"
#include "pamr/io/vtk/vtk_xml.hpp"

/// Names and numbers of VTK's legacy files. Source: VTK file formats, "Legacy file formats"; the widths of integers as
/// VTK 9 writes them.
namespace pamr::io::vtk {

/// A type of numbers: its name in the legacy format, and in XML files.
struct LegacyType {
  std::string_view name, type;
  std::size_t bytes;
};

/// In lower case: keywords may have either.
std::string lower(std::string_view text);
/// Names have %XX for blanks and other characters.
std::string decoded(std::string_view name);

/// Numbers as text, or as bytes with the greatest first. No array grows beyond the rest of the file.
class LegacyNumbers {
 public:
  explicit LegacyNumbers(TextCursor& in) : in_(in) {}
  void set_binary(bool binary) { binary_ = binary; }
  bool is_binary() const { return binary_; }

  const LegacyType& type_named(std::string_view name) const;
  Values numbers(const LegacyType& type, std::int64_t n);
  std::vector<std::int64_t> integers(const LegacyType& type, std::int64_t n);

 private:
  std::vector<double> reals(const LegacyType& type, std::int64_t n);
  std::vector<std::int64_t> bits(std::int64_t n);
  std::size_t room(const LegacyType& type, std::int64_t n) const;
  template <class T>
  T swapped();

  TextCursor& in_;
  bool binary_ = false;
};

}  // namespace pamr::io::vtk
