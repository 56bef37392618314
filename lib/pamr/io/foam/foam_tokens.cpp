// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/foam/foam_tokens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <system_error>

#include "pamr/io/elements/mesh_of_elements.hpp"
#include "pamr/io/foam/gunzip.hpp"

namespace pamr::io::foam {

namespace {

constexpr std::string_view marks = "(){};[]";

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
    const auto rest = in_.rest();
    if (rest.starts_with("//")) {
      (void)in_.line();
    } else if (rest.starts_with("/*")) {
      const auto end = rest.find("*/");
      if (end == std::string_view::npos) fail("the end of a comment", "the end of the file");
      in_.pass(end + 2);
    } else if (!rest.empty() && std::isspace(static_cast<unsigned char>(rest.front())) != 0) {
      in_.pass(1);
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
  if (marks.find(rest.front()) == std::string_view::npos)
    while (n < rest.size() && std::isspace(static_cast<unsigned char>(rest[n])) == 0 &&
           marks.find(rest[n]) == std::string_view::npos)
      ++n;
  in_.pass(n);
  return rest.substr(0, n);
}

bool FoamFile::passes(std::string_view text) {
  skip_blanks();
  const auto here = in_;
  if (!in_.at_end() && word(text) == text) return true;
  in_ = here;
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

std::int64_t FoamFile::integer(std::string_view what) {
  const auto here = in_;
  const auto text = word(what);
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size())
    here.fail(std::string(what), "\"" + std::string(text.substr(0, 40)) + "\"");
  return number;
}

std::int64_t FoamFile::count(std::size_t min_bytes, std::string_view what) {
  return in_.checked_count(integer(fmt::format("the number of {}", what)), min_bytes, what);
}

std::int64_t FoamFile::raw_label() {
  return label_bytes_ == 8 ? in_.value<std::int64_t>("a number") : in_.value<std::int32_t>("a number");
}

std::vector<std::int64_t> FoamFile::labels() {
  std::vector<std::int64_t> numbers;
  if (passes("{")) fail("a number before the list", "none");
  const auto here = in_;
  const auto announced = integer("the number of numbers");
  if (passes("{")) {
    // No array grows beyond the file: those of tetrahedra do not.
    if (announced < 0 || announced > static_cast<std::int64_t>(in_.position() + in_.remaining()))
      here.fail("a number of equal numbers that fits the file", fmt::format("{}", announced));
    numbers.assign(static_cast<std::size_t>(announced), integer("a number"));
    require("}");
    return numbers;
  }
  const auto n = in_.checked_count(announced, binary_ ? static_cast<std::size_t>(label_bytes_) : 1, "numbers");
  if (n == 0 && !passes("(")) return numbers;
  if (n > 0) require("(");
  numbers.reserve(static_cast<std::size_t>(n));
  for (std::int64_t i = 0; i < n; ++i) numbers.push_back(binary_ ? raw_label() : integer("a number"));
  require(")");
  return numbers;
}

std::int64_t FoamFile::count_flags() {
  const auto here = in_;
  const auto announced = integer("the number of flags");
  if (!binary_ || passes("{")) {
    in_ = here;
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
        const auto here = in_;
        const auto text = word("a coordinate");
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), p[k]);
        if (error != std::errc() || end != text.data() + text.size())
          here.fail("a coordinate", "\"" + std::string(text.substr(0, 40)) + "\"");
      } else {
        p[k] = scalar_bytes_ == 4 ? static_cast<double>(in_.value<float>("a coordinate"))
                                  : in_.value<double>("a coordinate");
      }
    if (!binary_) require(")");
  }
  require(")");
  return result;
}

std::vector<std::vector<std::int64_t>> FoamFile::faces() {
  std::vector<std::vector<std::int64_t>> result;
  if (is_compact_ && binary_) {
    const auto begins = labels(), nodes = labels();
    for (std::size_t f = 0; f + 1 < begins.size(); ++f) {
      if (begins[f] < 0 || begins[f + 1] < begins[f] || begins[f + 1] > std::ssize(nodes))
        fail("begins of faces that grow", "others");
      result.emplace_back(nodes.begin() + begins[f], nodes.begin() + begins[f + 1]);
    }
    return result;
  }
  if (binary_) fail("binary faces of class faceCompactList", "another class");
  const auto n = count(7, "faces");
  require("(");
  for (std::int64_t i = 0; i < n; ++i) result.push_back(labels());
  require(")");
  return result;
}

}  // namespace pamr::io::foam
