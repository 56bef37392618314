// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/foam/foam_tokens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>
#include <utility>

#include "pamr/base/memory.hpp"
#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/io/foam/gunzip.hpp"

namespace pamr::io::foam {

namespace {

constexpr std::string_view marks = "(){};[]", blanks = " \t\n\v\f\r";

enum class Kind : unsigned char { other, blank, mark };

/// Of each character.
constexpr auto kinds = [] {
  std::array<Kind, 256> kind{};
  for (const char c : marks) kind[static_cast<unsigned char>(c)] = Kind::mark;
  for (const char c : blanks) kind[static_cast<unsigned char>(c)] = Kind::blank;
  return kind;
}();

Kind kind_of(char c) { return kinds[static_cast<unsigned char>(c)]; }

bool is_there(const std::filesystem::path& file) {
  std::error_code none;
  return std::filesystem::exists(file, none);
}

std::filesystem::path packed_name(std::filesystem::path file) { return file += ".gz"; }

bool is_packed(const std::filesystem::path& file) { return file.extension() == ".gz"; }

}  // namespace

bool is_present(const std::filesystem::path& file) { return is_there(file) || is_there(packed_name(file)); }

FoamFile::FoamFile(const std::filesystem::path& file)
    : file_(!is_there(file) && is_present(file) ? packed_name(file) : file),
      mapped_(file_),
      unpacked_(is_packed(file_) ? gunzip(mapped_.bytes(), source_of(file_)) : std::string()),
      in_(is_packed(file_) ? std::string_view(unpacked_) : mapped_.bytes(), file_.string()) {
  if (!passes("FoamFile")) fail("a file of OpenFOAM that begins with FoamFile", "another beginning");
  const auto head = dictionary([](const std::string&) { return false; });
  const auto entry = [&](const char* key) {
    const auto found = head.find(key);
    return found == head.end() ? std::string() : found->second;
  };
  binary_ = entry("format") == "binary";
  is_compact_ = entry("class") == "faceCompactList";
  if (entry("arch").find("label=64") != std::string::npos) label_bytes_ = 8;
  if (entry("arch").find("scalar=32") != std::string::npos) scalar_bytes_ = 4;
}

void FoamFile::skip_blanks() {
  for (;;) {
    const auto all = in_.rest();
    std::size_t n = 0;
    while (n < all.size() && kind_of(all[n]) == Kind::blank) ++n;
    in_.pass(n);
    const auto rest = all.substr(n);
    if (rest.empty() || rest.front() != '/') return;
    if (rest.starts_with("//")) {
      (void)in_.line();
    } else if (rest.starts_with("/*")) {
      const auto end = rest.find("*/");
      if (end == std::string_view::npos) fail("the end of a comment", "the end of the file");
      in_.pass(end + 2);
    } else {
      return;
    }
  }
}

std::string_view FoamFile::word(std::string_view what) {
  skip_blanks();
  const auto rest = in_.rest();
  if (rest.empty()) fail(std::string(what), "the end of the file");
  std::size_t n = 1;
  if (rest.front() == '"') {
    n = rest.find('"', 1);
    if (n == std::string_view::npos) fail("the end of a text in quotes", "the end of the file");
    in_.pass(n + 1);
    return rest.substr(1, n - 1);
  }
  if (kind_of(rest.front()) == Kind::other)
    while (n < rest.size() && kind_of(rest[n]) == Kind::other) ++n;
  in_.pass(n);
  return rest.substr(0, n);
}

bool FoamFile::passes(std::string_view text) {
  skip_blanks();
  const auto here = in_.position();
  if (!in_.at_end() && word(text) == text) return true;
  in_.go_back(here);
  return false;
}

void FoamFile::require(std::string_view text) {
  if (!passes(text)) fail(std::string(text), in_.at_end() ? "the end of the file" : "something else");
}

std::string FoamFile::value() {
  if (passes("{")) {
    for (int depth = 1; depth > 0;) {
      const auto next = word("the end of a dictionary");
      depth += next == "{" ? 1 : next == "}" ? -1 : 0;
    }
    return {};
  }
  std::string first;
  for (auto next = word("a value"); next != ";"; next = word("a semicolon"))
    if (first.empty()) first = next;
  return first;
}

template <class T>
T FoamFile::number(std::string_view what) {
  const auto here = in_.position();
  const auto text = word(what);
  T number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc() && end == text.data() + text.size()) return number;
  in_.go_back(here);
  fail(std::string(what), "\"" + std::string(text.substr(0, 40)) + "\"");
}

std::int64_t FoamFile::integer(std::string_view what) { return number<std::int64_t>(what); }

std::int64_t FoamFile::count(std::size_t min_bytes, std::string_view what) {
  return in_.checked_count(integer(fmt::format("the number of {}", what)), min_bytes, what);
}

std::int64_t FoamFile::raw_label() {
  return label_bytes_ == 8 ? in_.value<std::int64_t>("a number") : in_.value<std::int32_t>("a number");
}

std::vector<std::int64_t> FoamFile::labels() {
  std::vector<std::int64_t> numbers;
  append_labels(numbers);
  return numbers;
}

void FoamFile::append_labels(std::vector<std::int64_t>& numbers) {
  if (passes("{")) fail("a number before the list", "none");
  const auto here = in_.position();
  const auto announced = integer("the number of numbers");
  if (passes("{")) {
    // No array grows beyond the file: those of tetrahedra do not.
    if (announced < 0 || announced > static_cast<std::int64_t>(in_.position() + in_.remaining())) {
      in_.go_back(here);
      fail("a number of equal numbers that fits the file", fmt::format("{}", announced));
    }
    numbers.insert(numbers.end(), at(announced), integer("a number"));
    require("}");
    return;
  }
  const auto n = in_.checked_count(announced, binary_ ? static_cast<std::size_t>(label_bytes_) : 1, "numbers");
  if (n == 0 && !passes("(")) return;
  if (n > 0) require("(");
  if (numbers.empty()) reserve_array(numbers, at(n));
  for (std::int64_t i = 0; i < n; ++i) numbers.push_back(binary_ ? raw_label() : integer("a number"));
  require(")");
}

std::int64_t FoamFile::count_flags() {
  const auto here = in_.position();
  const auto announced = integer("the number of flags");
  if (!binary_ || passes("{")) {
    in_.go_back(here);
    const auto flags = labels();
    return std::count_if(flags.begin(), flags.end(), [](std::int64_t flag) { return flag != 0; });
  }
  const auto n = in_.checked_count(announced, 1, "flags");
  if (n == 0 && !passes("(")) return 0;
  if (n > 0) require("(");
  std::int64_t n_set = 0;
  for (std::int64_t i = 0; i < n; ++i) n_set += in_.value<char>("a flag") != 0 ? 1 : 0;
  require(")");
  return n_set;
}

std::vector<geometry::Vec3> FoamFile::points() {
  const auto n = count(binary_ ? 3 * static_cast<std::size_t>(scalar_bytes_) : 7, "points");
  require("(");
  std::vector<geometry::Vec3> result(static_cast<std::size_t>(n));
  for (auto& p : result) {
    if (!binary_) require("(");
    for (std::size_t k = 0; k < 3; ++k)
      if (!binary_) {
        p[k] = number<double>("a coordinate");
      } else {
        p[k] = scalar_bytes_ == 4 ? static_cast<double>(in_.value<float>("a coordinate"))
                                  : in_.value<double>("a coordinate");
      }
    if (!binary_) require(")");
  }
  require(")");
  return result;
}

FaceNodes FoamFile::faces() {
  if (is_compact_ && binary_) {
    auto begin = labels(), node = labels();
    for (std::size_t f = 0; f + 1 < begin.size(); ++f)
      if (begin[f] < 0 || begin[f + 1] < begin[f] || begin[f + 1] > std::ssize(node))
        fail("begins of faces that grow", "others");
    return {std::move(begin), std::move(node)};
  }
  if (binary_) fail("binary faces of class faceCompactList", "another class");
  const auto n = count(7, "faces");
  require("(");
  std::vector<std::int64_t> begin, node;
  reserve_array(begin, at(n) + 1);
  reserve_array(node, 3 * at(n));
  begin.push_back(0);
  for (std::int64_t i = 0; i < n; ++i) {
    append_labels(node);
    begin.push_back(std::ssize(node));
  }
  require(")");
  return {std::move(begin), std::move(node)};
}

}  // namespace pamr::io::foam
