// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <numeric>

#include "pamr/base/error.hpp"

namespace pamr::meshing {
namespace {

std::vector<int> counted(std::size_t n) {
  std::vector<int> result(n);
  std::iota(result.begin(), result.end(), 0);
  return result;
}

}  // namespace

/// Reads by recursive descent.
class RegionParser {
 public:
  RegionParser(std::string_view text, std::span<const std::string> names, std::span<const int> side_of,
               const std::string& where, std::vector<int>& program)
      : text_(text), names_(names), side_of_(side_of), where_(where), program_(program) {}

  void read() {
    read_either(0);
    if (next() != '\0') refuse("the end, & or |");
  }

 private:
  static constexpr int deepest = 100;

  [[noreturn]] void refuse(const std::string& expected) const {
    const auto rest = text_.substr(std::min(at_, text_.size()));
    throw Error(fmt::format("{}: expected {} at character {} of the region \"{}\", found {}", where_, expected, at_ + 1,
                            text_, rest.empty() ? "its end" : "\"" + std::string(rest) + "\""));
  }

  char next() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }

  void read_either(int depth) {
    read_both(depth);
    while (next() == '|') {
      ++at_;
      read_both(depth);
      program_.push_back(Region::either);
    }
  }

  void read_both(int depth) {
    read_one(depth);
    while (next() == '&') {
      ++at_;
      read_one(depth);
      program_.push_back(Region::both);
    }
  }

  void read_one(int depth) {
    if (depth > deepest) refuse(fmt::format("at most {} parentheses in one another", deepest));
    const char first = next();
    if (first == '!') {
      ++at_;
      read_one(depth + 1);
      program_.push_back(Region::inverse);
    } else if (first == '(') {
      ++at_;
      read_either(depth + 1);
      if (next() != ')') refuse(")");
      ++at_;
    } else if (first == '+' || first == '-') {
      ++at_;
      program_.push_back(2 * read_name() + (first == '-' ? 1 : 0));
    } else {
      refuse("+NAME, -NAME, ! or (");
    }
  }

  int read_name() {
    const auto is_end = [](char c) {
      return std::isspace(static_cast<unsigned char>(c)) != 0 || c == '&' || c == '|' || c == '(' || c == ')' ||
             c == '!';
    };
    auto end = at_;
    while (end < text_.size() && !is_end(text_[end])) ++end;
    const auto found = std::find(names_.begin(), names_.end(), text_.substr(at_, end - at_));
    if (found == names_.end()) refuse("the name of a surface");
    at_ = end;
    return side_of_[static_cast<std::size_t>(found - names_.begin())];
  }

  std::string_view text_;
  std::span<const std::string> names_;
  std::span<const int> side_of_;
  const std::string& where_;
  std::vector<int>& program_;
  std::size_t at_ = 0;
};

Region Region::among_others(std::string_view text, std::span<const std::string> names, std::span<const int> side_of,
                            const std::string& where) {
  if (const auto n = side_of.empty() ? 0 : static_cast<std::size_t>(side_of.back()) + 1; n > max_surfaces)
    throw Error(fmt::format("{}: expected at most {} surfaces, found {}", where, max_surfaces, n));
  Region result;
  RegionParser(text, names, side_of, where, result.program_).read();
  return result;
}

Region::Region(std::string_view text, std::span<const std::string> names, std::span<const int> side_of,
               const std::string& where)
    : Region(among_others(text, names, side_of, where)) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if ((used() >> side_of[i] & 1U) == 0)
      throw Error(fmt::format("{}: expected every surface in the region, found none of \"{}\" in \"{}\"", where,
                              names[i], text));
}

Region::Region(std::string_view text, std::span<const std::string> names, const std::string& where)
    : Region(text, names, counted(names.size()), where) {}

Sides Region::used() const {
  Sides result = 0;
  for (const int step : program_)
    if (step >= 0) result |= Sides{1} << (step / 2);
  return result;
}

bool Region::contains(Sides sides) const {
  // An operand of | and one of & wait at each depth of parentheses, which the parser bounds.
  std::array<bool, 256> stack;
  std::size_t n = 0;
  for (const int step : program_) {
    if (step >= 0) {
      stack[n++] = ((sides >> (step / 2)) & 1U) == (step % 2 == 0 ? 1U : 0U);
    } else if (step == inverse) {
      stack[n - 1] = !stack[n - 1];
    } else {
      --n;
      stack[n - 1] = step == both ? stack[n - 1] && stack[n] : stack[n - 1] || stack[n];
    }
  }
  return stack[0];
}

}  // namespace pamr::meshing
