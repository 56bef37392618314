// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/triangulation_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"

namespace pamr::geometry {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// What was found, fit for a message.
std::string shown(std::string_view word) {
  constexpr std::size_t most = 40;
  std::string text = "\"";
  for (const char c : word.substr(0, most)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > most ? "...\"" : "\"");
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

std::vector<std::string> remark_on_rest(const std::vector<std::string>& things) {
  std::string list;
  for (const auto& thing : things)
    if (!thing.empty()) list += (list.empty() ? "left out: " : ", ") + thing;
  return list.empty() ? std::vector<std::string>{} : std::vector{list};
}

std::string names_of_parts(std::string_view what, const std::vector<std::string>& names) {
  constexpr std::size_t most = 5;
  if (names.size() < 2) return {};
  const auto in_quotes = [](const std::string& name) { return fmt::format("\"{}\"", name); };
  return fmt::format("the names of {} {} ({}), which are one surface", names.size(), what,
                     listed(names, {.most = most}, in_quotes));
}

bool is_same_word(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (lower(a[i]) != lower(b[i])) return false;
  return true;
}

void SurfaceText::fail(const std::string& message) const {
  throw Error(fmt::format("{}:{}: {}", where_, line_, message));
}

void SurfaceText::skip_blanks(bool over_lines) {
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (comment_ != 0 && c == comment_) {
      at_ = std::min(text_.find('\n', at_), text_.size());
      if (at_ == text_.size()) return;
    }
    if (const auto joint = joint_at(at_); joint > 0) {
      at_ += joint - 1;
      ++line_;
    } else if (text_[at_] == '\n') {
      if (!over_lines) return;
      ++line_;
    } else if (!is_blank(text_[at_])) {
      return;
    }
  }
}

std::string_view SurfaceText::word_in_line() {
  skip_blanks(false);
  const auto start = at_;
  while (at_ < text_.size() && !is_blank(text_[at_]) && text_[at_] != '\n' && joint_at(at_) == 0 &&
         (comment_ == 0 || text_[at_] != comment_))
    ++at_;
  return text_.substr(start, at_ - start);
}

std::string SurfaceText::rest_of_line() {
  std::string rest;
  for (auto word = word_in_line(); !word.empty(); word = word_in_line())
    rest.append(rest.empty() ? "" : " ").append(word);
  return rest;
}

std::string_view SurfaceText::word(std::string_view what) {
  skip_blanks(true);
  const auto found = word_in_line();
  if (found.empty()) fail("expected " + std::string(what) + ", found the end of the file");
  return found;
}

double SurfaceText::number_of(std::string_view word, std::string_view what) const {
  const auto digits = word.starts_with('+') ? word.substr(1) : word;
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_number = end == digits.data() + digits.size() && !digits.empty() && !digits.starts_with('+');
  if (is_number && error == std::errc::result_out_of_range) {
    // Too small counts as zero, too large is refused: numbers with a negative exponent are the small ones.
    if (digits.find("e-") != std::string_view::npos || digits.find("E-") != std::string_view::npos) return 0;
  } else if (is_number && error == std::errc() && std::isfinite(value)) {
    return value;
  }
  fail("expected a finite number (" + std::string(what) + "), found " + shown(word));
}

std::int64_t SurfaceText::whole_of(std::string_view word, std::string_view what, std::int64_t low,
                                   std::int64_t high) const {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || value < low || value > high)
    fail(fmt::format("expected a whole number from {} to {} ({}), found {}", low, high, what, shown(word)));
  return value;
}

void SurfaceText::expect(std::string_view wanted) {
  const auto found = word("\"" + std::string(wanted) + "\"");
  if (!is_same_word(found, wanted)) fail("expected \"" + std::string(wanted) + "\", found " + shown(found));
}

std::size_t SurfaceText::joint_at(std::size_t place) const {
  if (!joins_lines_ || text_[place] != '\\') return 0;
  const auto behind = text_.substr(place + 1, 2);
  return behind.starts_with('\n') ? 2 : behind == "\r\n" ? 3 : 0;
}

void SurfaceText::skip_line() {
  if (joins_lines_)
    while (!word_in_line().empty()) continue;
  at_ = std::min(text_.find('\n', at_), text_.size());
  if (at_ == text_.size()) return;
  ++at_;
  ++line_;
}

bool SurfaceText::at_end() {
  skip_blanks(true);
  return at_ == text_.size();
}

}  // namespace pamr::geometry
