// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/text_cursor.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>

#include "pamr/base/byte_order_mark.hpp"
#include "pamr/base/error.hpp"

namespace pamr::io {

namespace {

/// A piece of the file as it may stand in a message: short, without control characters.
std::string shown(std::string_view text) {
  std::string result;
  for (const char c : text.substr(0, 40)) result += c >= ' ' && c <= '~' ? c : '?';
  return "\"" + result + (text.size() > 40 ? "...\"" : "\"");
}

/// A real whose exponent is written as Fortran does, behind D or Q or, with three digits, behind its sign alone.
bool read_fortran(std::string_view text, double& value) {
  if (text.size() > 60) return false;
  auto place = text.find_first_of("dDqQ");
  std::string plain(text);
  if (place != std::string_view::npos) {
    plain[place] = 'e';
  } else {
    place = text.find_first_of("+-", 1);
    if (place == std::string_view::npos || text.size() != place + 4) return false;
    plain.insert(place, 1, 'e');
  }
  const auto [end, error] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  return error == std::errc{} && end == plain.data() + plain.size();
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
    throw Error("file '" + file.string() + "': expected a file that can be read, found: " + std::strerror(errno));
  struct stat status {};
  const bool is_regular = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  const auto size = is_regular ? static_cast<std::size_t>(status.st_size) : 0;
  void* memory = size > 0 ? mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0) : nullptr;
  close(descriptor);
  if (!is_regular) throw Error("file '" + file.string() + "': expected a regular file, found something else");
  if (memory == MAP_FAILED)
    throw Error("file '" + file.string() + "': expected a file that can be mapped, found: " + std::strerror(errno));
  if (memory != nullptr) {
    madvise(memory, size, MADV_SEQUENTIAL);
    bytes_ = {static_cast<const char*>(memory), size};
  }
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) munmap(const_cast<char*>(bytes_.data()), bytes_.size());
}

void TextCursor::fail(const std::string& expected, const std::string& found) const {
  const auto passed = bytes_.substr(0, std::min(at_, bytes_.size()));
  const auto place = binary_ ? fmt::format("byte {}", at_)
                             : fmt::format("line {}", 1 + std::count(passed.begin(), passed.end(), '\n'));
  throw Error("file '" + file_ + "', " + place + ": expected " + expected + ", found " + found);
}

void TextCursor::need(std::size_t n, std::string_view what) const {
  if (remaining() < n) fail(std::string(what), "the end of the file");
}

void TextCursor::skip_byte_order_mark() {
  if (at_ == 0 && bytes_.starts_with(byte_order_mark)) at_ = byte_order_mark.size();
}

std::string_view TextCursor::line() {
  const auto end = bytes_.find('\n', at_);
  auto text = bytes_.substr(at_, end == std::string_view::npos ? end : end - at_);
  at_ = end == std::string_view::npos ? bytes_.size() : end + 1;
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  return text;
}

void TextCursor::skip_to_line(std::string_view text) {
  for (auto from = at_;;) {
    const auto begin = bytes_.find(text.front(), from);
    if (begin == std::string_view::npos) {
      at_ = bytes_.size();
      fail(std::string(text), "the end of the file");
    }
    from = begin + 1;
    if (begin > 0 && begin != at_ && bytes_[begin - 1] != '\n') continue;
    if (bytes_.substr(begin, text.size()) != text) continue;
    auto end = begin + text.size();
    while (end < bytes_.size() && (bytes_[end] == ' ' || bytes_[end] == '\t')) ++end;
    if (end < bytes_.size() && bytes_[end] == '\r') ++end;
    if (end < bytes_.size() && bytes_[end] != '\n') continue;
    at_ = std::min(end + 1, bytes_.size());
    return;
  }
}

void TextCursor::skip_lines(std::int64_t n, std::string_view what) {
  constexpr std::size_t near = 2 * LineIndex::default_chunk;  // farther than this the index is faster
  const auto start = at_;
  for (; n > 0 && (index_ == nullptr || at_ - start < near); --n) {
    const auto end = bytes_.find('\n', at_);
    at_ = end == std::string_view::npos ? bytes_.size() : end + 1;
    if (end == std::string_view::npos) fail(std::string(what), "the end of the file");
  }
  if (n <= 0) return;
  const auto there = index_->after_lines(at_, n);
  at_ = there == std::string_view::npos ? bytes_.size() : there;
  if (there == std::string_view::npos) fail(std::string(what), "the end of the file");
}

void TextCursor::skip_rows(std::int64_t n, std::size_t size, std::string_view what) {
  if (n < 0 || static_cast<std::size_t>(n) > remaining() / size) fail(std::string(what), "the end of the file");
  at_ += static_cast<std::size_t>(n) * size;
}

std::string_view TextCursor::word(std::string_view what) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
  auto end = at_;
  while (end < bytes_.size() && !is_blank(bytes_[end])) ++end;
  if (end == at_) fail(std::string(what), "the end of the file");
  return bytes_.substr(at_, end - at_);
}

std::int64_t TextCursor::integer(std::string_view what) {
  const auto text = word(what);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) fail(std::string(what), shown(text));
  at_ += text.size();
  return value;
}

double TextCursor::real(std::string_view what) {
  const auto begin = at_;
  const auto value = real_or_none(what);
  if (std::isfinite(value)) return value;
  at_ = begin;
  fail(std::string(what) + " that is finite", shown(word(what)));
}

double TextCursor::real_or_none(std::string_view what) {
  const auto text = word(what);
  double value = 0;
  const auto digits = text.front() == '+' ? text.substr(1) : text;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_read = error == std::errc{} && end == digits.data() + digits.size();
  if (!is_read && !read_fortran(digits, value)) fail(std::string(what) + " that is finite", shown(text));
  at_ += text.size();
  return value;
}

void TextCursor::skip_blanks() {
  while (at_ < bytes_.size() && (bytes_[at_] == ' ' || bytes_[at_] == '\t' || bytes_[at_] == '\r')) ++at_;
}

void TextCursor::require_word_in_line(std::string_view what) {
  skip_blanks();
  if (at_end()) fail(std::string(what), "the end of the file");
  if (bytes_[at_] == '\n') fail(std::string(what), "the end of the line");
}

std::int64_t TextCursor::integer_in_line(std::string_view what) {
  require_word_in_line(what);
  return integer(what);
}

double TextCursor::real_in_line(std::string_view what) {
  require_word_in_line(what);
  return real(what);
}

bool TextCursor::is_line_over(char comment) {
  skip_blanks();
  return at_end() || bytes_[at_] == '\n' || bytes_[at_] == comment;
}

void TextCursor::skip_empty_lines(char comment) {
  while (!at_end()) {
    const auto begin = at_;
    if (!is_line_over(comment)) {
      at_ = begin;
      return;
    }
    (void)line();
  }
}

std::string_view TextCursor::keyword() {
  while (at_ < bytes_.size() && (std::isspace(static_cast<unsigned char>(bytes_[at_])) != 0)) ++at_;
  if (at_end() || std::isalpha(static_cast<unsigned char>(bytes_[at_])) == 0) return {};
  const auto begin = at_;
  while (at_ < bytes_.size() && (std::isalnum(static_cast<unsigned char>(bytes_[at_])) != 0 || bytes_[at_] == '_'))
    ++at_;
  return bytes_.substr(begin, at_ - begin);
}

void TextCursor::go_to(std::uint64_t byte, std::string_view what) {
  if (byte < at_ || byte > bytes_.size())
    fail(fmt::format("{} between here and the end of the file", what), fmt::format("byte {}", byte));
  at_ = byte;
}

std::int64_t TextCursor::checked_count(std::int64_t count, std::size_t min_bytes, std::string_view what) const {
  if (count < 0 || static_cast<std::uint64_t>(count) > remaining() / min_bytes)
    fail("a number of " + std::string(what) + " that fits the file", fmt::format("{}", count));
  return count;
}

}  // namespace pamr::io
