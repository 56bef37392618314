// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutate_text.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

namespace pamr::fuzz {

namespace {

struct Piece {
  std::size_t begin = 0, size = 0;
};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_of_number(char c) { return is_digit(c) || is_letter(c) || c == '+' || c == '-' || c == '.'; }

/// The numbers of a text, or its words.
std::vector<Piece> pieces_of(std::string_view text, bool want_numbers) {
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < text.size();) {
    if (!is_of_number(text[i])) {
      ++i;
      continue;
    }
    const auto begin = i;
    while (i < text.size() && is_of_number(text[i])) ++i;
    const auto first_letter = text.find_first_not_of("+-.", begin);
    const bool is_number = first_letter < i && is_digit(text[first_letter]);
    if (is_number == want_numbers) pieces.push_back({begin, i - begin});
  }
  return pieces;
}

std::vector<Piece> lines_of(std::string_view text) {
  std::vector<Piece> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const auto end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    lines.push_back({begin, end - begin});
    begin = end;
  }
  return lines;
}

/// A number that readers trip over, or a near one.
std::string other_number(const std::string& number, test::Dice& dice) {
  constexpr std::array<const char*, 24> strange{"0",
                                                "-0",
                                                "1",
                                                "-1",
                                                "2",
                                                "255",
                                                "256",
                                                "65536",
                                                "2147483647",
                                                "2147483648",
                                                "4294967296",
                                                "9223372036854775807",
                                                "9223372036854775808",
                                                "18446744073709551616",
                                                "1e19",
                                                "1e308",
                                                "1e999",
                                                "-1e300",
                                                "1e-320",
                                                "nan",
                                                "inf",
                                                "-inf",
                                                "0x10",
                                                "1.5"};
  auto result = number;
  auto& digit = result[result.find_first_of("0123456789")];
  switch (dice.below(5)) {
    case 0:  // one more or less in a digit
      digit = digit == '9' || (digit > '0' && dice.below(2) == 0) ? static_cast<char>(digit - 1)
                                                                  : static_cast<char>(digit + 1);
      return result;
    case 1:  // the other sign
      return number[0] == '-' ? number.substr(1) : "-" + number;
    case 2:  // ten times as much, or an exponent
      return dice.below(2) == 0 ? number + "0" : number + (dice.below(2) == 0 ? "e9" : "e-9");
    default:
      return strange[dice.below(strange.size())];
  }
}

void change_number(std::string& text, test::Dice& dice) {
  const auto numbers = pieces_of(text, true);
  if (numbers.empty()) return;
  const auto at = numbers[dice.below(numbers.size())], from = numbers[dice.below(numbers.size())];
  const auto old = text.substr(at.begin, at.size);
  text.replace(at.begin, at.size, dice.below(3) == 0 ? text.substr(from.begin, from.size) : other_number(old, dice));
}

void change_word(std::string& text, test::Dice& dice) {
  const auto words = pieces_of(text, false);
  if (words.empty()) return;
  const auto at = words[dice.below(words.size())], from = words[dice.below(words.size())];
  text.replace(at.begin, at.size, dice.below(4) == 0 ? std::string() : text.substr(from.begin, from.size));
}

void change_lines(std::string& text, test::Dice& dice) {
  const auto lines = lines_of(text);
  if (lines.empty()) return;
  const auto a = lines[dice.below(lines.size())], b = lines[dice.below(lines.size())];
  const auto line = text.substr(a.begin, a.size), other = text.substr(b.begin, b.size);
  switch (dice.below(4)) {
    case 0:
      text.erase(a.begin, a.size);
      break;
    case 1:
      text.insert(a.begin, line);
      break;
    case 2:
      text.insert(b.begin, line);
      break;
    default:
      if (a.begin == b.begin) break;
      text.replace(std::max(a.begin, b.begin), a.begin > b.begin ? a.size : b.size, a.begin > b.begin ? other : line);
      text.replace(std::min(a.begin, b.begin), a.begin > b.begin ? b.size : a.size, a.begin > b.begin ? line : other);
      break;
  }
}

void change_mark(std::string& text, test::Dice& dice) {
  constexpr std::string_view marks = "[]{}()\"'=,;:#$<>/\\&*! \t\r\n.";
  const auto place = dice.below(text.size() + 1);
  const auto found = text.find_first_of(marks, place);
  const char mark = marks[dice.below(marks.size())];
  switch (dice.below(3)) {
    case 0:
      text.insert(place, 1 + (dice.below(8) == 0 ? dice.below(2000) : 0), mark);
      break;
    case 1:
      if (found != std::string::npos) text[found] = mark;
      break;
    default:
      if (found != std::string::npos) text.erase(found, 1);
      break;
  }
}

}  // namespace

void damage_text(std::string& text, test::Dice& dice) {
  for (auto n = 1 + dice.below(3); n > 0; --n) switch (dice.below(8)) {
      case 0:
        change_word(text, dice);
        break;
      case 1:
      case 2:
        change_lines(text, dice);
        break;
      case 3:
        change_mark(text, dice);
        break;
      default:
        change_number(text, dice);
        break;
    }
}

}  // namespace pamr::fuzz
