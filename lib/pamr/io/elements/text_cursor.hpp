// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>

#include "pamr/io/elements/line_index.hpp"

namespace pamr::io {

/// A whole file as bytes, mapped read-only: pages come and go as they are read. Local.
class MappedFile {
 public:
  /// Throws `Error` when it cannot be opened or is no regular file.
  explicit MappedFile(const std::filesystem::path& file);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  MappedFile(MappedFile&&) = delete;
  MappedFile& operator=(MappedFile&&) = delete;

  std::string_view bytes() const { return bytes_; }

 private:
  std::string_view bytes_;
};

/// Reads a file from front to back: lines and numbers of text, plain values of binary parts (little-endian), and skips
/// what belongs to other ranks at the speed of memory. Every error names the file and the line, or the byte in a binary
/// part. Local.
class TextCursor {
 public:
  TextCursor(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

  bool at_end() const { return at_ >= bytes_.size(); }
  std::size_t remaining() const { return bytes_.size() - at_; }
  std::size_t position() const { return at_; }
  std::string_view rest() const { return bytes_.substr(std::min(at_, bytes_.size())); }
  void set_binary(bool binary) { binary_ = binary; }
  /// Lets `skip_lines` go far without running through what it passes. The index must be that of the same bytes.
  void use_index(const LineIndex* index) { index_ = index; }

  /// Passes the mark with which some editors begin a text in UTF-8.
  void skip_byte_order_mark();
  /// The rest of the current line without its end, which is passed.
  std::string_view line();
  /// Passes everything up to the end of the next line that reads `text`; throws when there is none.
  void skip_to_line(std::string_view text);
  /// Passes `n` whole lines; throws when there are fewer.
  void skip_lines(std::int64_t n, std::string_view what);
  /// Passes `n` times `size` bytes of a binary part.
  void skip_rows(std::int64_t n, std::size_t size, std::string_view what);

  /// The next number of a text, over blanks and line ends. Reals may have exponents as Fortran writes them: 1.0D+00, and
  /// 0.1-300 where three digits leave no room for a letter.
  std::int64_t integer(std::string_view what);
  double real(std::string_view what);
  /// The same, with NaN and infinity.
  double real_or_none(std::string_view what);

  /// The next number of the same line; throws where the line ends.
  std::int64_t integer_in_line(std::string_view what);
  double real_in_line(std::string_view what);
  /// Whether nothing but blanks, or a comment that begins with `comment`, is left of the line.
  bool is_line_over(char comment);
  /// Passes empty lines and comments.
  void skip_empty_lines(char comment);
  /// The word that begins here, over blanks and line ends: letters, digits and `_`; empty where a number or the end is.
  std::string_view keyword();
  /// Passes bytes of the present line.
  void pass(std::size_t n_bytes) { at_ = std::min(at_ + n_bytes, bytes_.size()); }
  /// Goes back to a `position` that was.
  void go_back(std::size_t position) { at_ = position; }
  /// Goes on at a byte of the file, not before the present one.
  void go_to(std::uint64_t byte, std::string_view what);

  template <class T>
  T value(std::string_view what) {
    static_assert(std::is_trivially_copyable_v<T> && std::endian::native == std::endian::little);
    need(sizeof(T), what);
    T read;
    std::memcpy(&read, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return read;
  }

  /// A count that leaves at least `min_bytes` for each item in the rest of the file: no array grows beyond the file.
  std::int64_t checked_count(std::int64_t count, std::size_t min_bytes, std::string_view what) const;

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const;

 private:
  void need(std::size_t n, std::string_view what) const;
  std::string_view word(std::string_view what);
  void skip_blanks();
  void require_word_in_line(std::string_view what);

  std::string_view bytes_;
  std::string file_;
  std::size_t at_ = 0;
  bool binary_ = false;
  const LineIndex* index_ = nullptr;
};

}  // namespace pamr::io
