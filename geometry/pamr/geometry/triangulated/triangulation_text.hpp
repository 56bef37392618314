// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pamr::geometry {

/// The words of a text file one after another, with their lines. Errors begin with "FILE:LINE: ".
class SurfaceText {
 public:
  /// `comment`: the character that starts a comment up to the end of the line, 0 for none.
  SurfaceText(std::string_view text, std::string where, char comment = 0, std::size_t first_line = 1)
      : text_(text), where_(std::move(where)), comment_(comment), line_(first_line) {}

  /// The next word in any line; an error with `what` at the end of the file.
  std::string_view word(std::string_view what);
  /// The next word in this line, empty at its end.
  std::string_view word_in_line();
  /// The words that are left of this line, a blank between them.
  std::string rest_of_line();
  /// A finite number.
  double number(std::string_view what) { return number_of(word(what), what); }
  double number_of(std::string_view word, std::string_view what) const;
  /// A whole number from `low` to `high`.
  std::int64_t whole(std::string_view what, std::int64_t low, std::int64_t high) {
    return whole_of(word(what), what, low, high);
  }
  std::int64_t whole_of(std::string_view word, std::string_view what, std::int64_t low, std::int64_t high) const;
  /// The next word must be this one, in either case.
  void expect(std::string_view wanted);
  /// Goes to the start of the next line; the rest of this one is not read.
  void skip_line();
  /// Takes a line that ends in a backslash for one with the next line, as OBJ does.
  void join_lines() { joins_lines_ = true; }
  /// True when only blanks and comments are left.
  bool at_end();
  std::size_t bytes_left() const { return text_.size() - at_; }
  std::size_t position() const { return at_; }
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skip_blanks(bool over_lines);
  /// The bytes of a backslash and the end of line behind it, 0 where there are none or lines are not joined.
  std::size_t joint_at(std::size_t place) const;

  std::string_view text_;
  std::string where_;
  char comment_;
  bool joins_lines_ = false;
  std::size_t line_, at_ = 0;
};

/// Says in one sentence what of a file has no place in a surface. `things`: as "8 normals"; empty ones do not count. No sentence
/// where there are none.
std::vector<std::string> remark_on_rest(const std::vector<std::string>& things);
/// The names of several parts of a file as one of these things: empty for less than two. `what`: "solids".
std::string names_of_parts(std::string_view what, const std::vector<std::string>& names);

/// True for texts that are equal but for the case of the letters a to z.
bool is_same_word(std::string_view a, std::string_view b);

}  // namespace pamr::geometry
