// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/exact.hpp"

namespace pamr {

/// The numbers that a key accepts: finite, from `low` to `high`, ends included unless `low_excluded`.
struct NumberRange {
  double low = std::numeric_limits<double>::lowest();
  double high = std::numeric_limits<double>::max();
  bool low_excluded = false;

  static constexpr NumberRange at_least(double low) { return {low}; }
  static constexpr NumberRange above(double low) { return {low, std::numeric_limits<double>::max(), true}; }
};

/// One table of a TOML file. It remembers which keys were asked for, so that `finish` can refuse all others.
///
/// Every function is local and throws `Error`. Messages have one form everywhere:
///
///     case.toml:3:15: expected temperature = a number above 0 in [stream.free], found "warm"
///     case.toml:3:1: unknown key 'temprature' in [stream.free]; did you mean 'temperature'?
///
/// A reader asks for what it knows and ends with `finish`:
///
///     const auto file = parse_case(text, path);               // or parse_toml: no tables of other tools
///     const auto stream = file.table("stream");               // must be there; find_table: may be there
///     const double t = stream.number("temperature", NumberRange::above(0));
///     const auto mode = stream.find_word("mode", {"fast", "slow"}).value_or("fast");
///     for (const auto& sphere : file.list("sphere"))          // [[sphere]], none or more
///       spheres.push_back(sphere.point<Vec3>("center"));
///     for (const auto& patch : file.table("boundary").all_tables())  // [boundary.NAME], names are free
///       use(patch.name(), patch);
///     file.finish();                                          // also all tables taken from it
///
/// Functions without prefix need the key; `find_...` return nothing where it is missing; `..._or` a fallback. A value
/// of the wrong type or out of range is an error for all of them.
///
/// A table is a handle: copies share the file and the memory of what was asked, and keep the file alive.
class TomlTable {
 public:
  /// Last part of the table's name: "free" of [stream.free]; empty for the file itself.
  const std::string& name() const { return name_; }
  /// Changes how messages call this table, and those within it: `surface "ball"` instead of [[surface]].
  void set_title(std::string title);

  /// True if the key is there. It counts as asked for, but a table of that name is not looked into by `finish`.
  bool has(std::string_view key) const;
  /// All keys in alphabetical order; all count as asked for.
  std::vector<std::string> keys() const;
  /// Accepts the key without looking at it.
  void ignore(std::string_view key) const { (void)has(key); }

  double number(std::string_view key, NumberRange range = {}) const;
  std::optional<double> find_number(std::string_view key, NumberRange range = {}) const;
  double number_or(std::string_view key, double fallback, NumberRange range = {}) const {
    return find_number(key, range).value_or(fallback);
  }

  std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high) const;
  std::optional<std::int64_t> find_integer(std::string_view key, std::int64_t low, std::int64_t high) const;
  std::int64_t integer_or(std::string_view key, std::int64_t fallback, std::int64_t low, std::int64_t high) const {
    return find_integer(key, low, high).value_or(fallback);
  }

  /// An array of integers, maybe empty.
  std::vector<std::int64_t> integers(std::string_view key, std::int64_t low, std::int64_t high) const;

  bool flag(std::string_view key) const;
  bool flag_or(std::string_view key, Exact<bool> fallback) const { return has(key) ? flag(key) : bool{fallback}; }

  /// A text that is not empty. `expected` says for messages what it stands for: "the name of a patch".
  std::string text(std::string_view key, std::string_view expected = "a text") const;
  std::optional<std::string> find_text(std::string_view key, std::string_view expected = "a text") const;
  std::string text_or(std::string_view key, std::string_view fallback, std::string_view expected = "a text") const {
    return find_text(key, expected).value_or(std::string(fallback));
  }
  /// One of the words given.
  std::string word(std::string_view key, std::initializer_list<std::string_view> words) const;
  std::optional<std::string> find_word(std::string_view key, std::initializer_list<std::string_view> words) const;
  std::string word_or(std::string_view key, std::string_view fallback,
                      std::initializer_list<std::string_view> words) const {
    return find_word(key, words).value_or(std::string(fallback));
  }
  /// An array of texts, maybe empty.
  std::vector<std::string> texts(std::string_view key) const;

  /// An array of `n` finite numbers.
  std::vector<double> numbers(std::string_view key, std::size_t n) const;
  template <std::size_t N>
  std::array<double, N> numbers(std::string_view key) const {
    std::array<double, N> result{};
    const auto values = numbers(key, N);
    for (std::size_t i = 0; i < N; ++i) result[i] = values[i];
    return result;
  }
  /// [x, y, z] as an aggregate of three numbers, such as `geometry::Vec3`.
  template <class Point>
  Point point(std::string_view key) const {
    const auto [x, y, z] = numbers<3>(key);
    return {x, y, z};
  }
  /// [[x, y, z], ...], `n` of them.
  template <class Point>
  std::vector<Point> points(std::string_view key, std::size_t n) const {
    std::vector<Point> result;
    for (const auto& [x, y, z] : point_array(key, n)) result.push_back({x, y, z});
    return result;
  }
  /// Lines through two points or more: [[[x, y, z], [x, y, z], ...], ...].
  template <class Point>
  std::vector<std::vector<Point>> polylines(std::string_view key) const {
    std::vector<std::vector<Point>> result;
    for (const auto& line : polyline_array(key)) {
      auto& points = result.emplace_back();
      for (const auto& [x, y, z] : line) points.push_back({x, y, z});
    }
    return result;
  }

  /// A table within this one.
  TomlTable table(std::string_view key) const;
  std::optional<TomlTable> find_table(std::string_view key) const;
  /// The tables of an array of tables, [[key]] or [{...}, ...]; empty where the key is missing.
  std::vector<TomlTable> list(std::string_view key) const;
  /// True if the key holds an array, for `list`. It does not count as asked for.
  bool has_list(std::string_view key) const;
  /// All keys of this table, each of which must be a table, in alphabetical order.
  std::vector<TomlTable> all_tables() const;

  /// Throws if this table, or one that was taken from it, has a key that nobody asked for.
  void finish() const;

  /// FILE:LINE:COLUMN of the key's value; of the table if it has no such key; FILE for the file itself.
  std::string at(std::string_view key = {}) const;
  /// Throws: expected KEY = EXPECTED in [TABLE], found FOUND; by default what the file has there.
  [[noreturn]] void refuse(std::string_view key, std::string_view expected) const;
  [[noreturn]] void refuse(std::string_view key, std::string_view expected, std::string_view found) const;
  /// Throws: FILE:LINE:COLUMN of the table: message.
  [[noreturn]] void fail(std::string_view message) const;

  /// The file's text with only the tables under the top-level key left, each on its line. The table must be the file.
  std::string source_of(std::string_view key) const;

 private:
  struct Position;
  struct Node;
  struct Document;
  friend TomlTable parse_toml(std::string_view text, const std::string& where);

  TomlTable(std::shared_ptr<const Document> document, const Node* node, std::string name);

  const std::string& title() const;
  std::string in() const;
  const Node* find(std::string_view key) const;
  void refuse_misspelled(std::string_view key) const;
  [[noreturn]] void refuse_missing(std::string_view key, std::string_view expected) const;
  [[noreturn]] void refuse_value(std::string_view key, const Node& node, std::string_view expected) const;
  std::optional<double> read_number(const Node& node, NumberRange range) const;
  std::array<double, 3> read_point(std::string_view key, const Node& node, std::string_view expected) const;
  std::vector<std::array<double, 3>> point_array(std::string_view key, std::size_t n) const;
  std::vector<std::vector<std::array<double, 3>>> polyline_array(std::string_view key) const;
  std::string inner_title(std::string_view key) const;
  TomlTable open(std::string_view key, const Node& node, const std::string& title) const;

  std::shared_ptr<const Document> document_;
  const Node* node_;
  std::string name_;
};

/// The top level of a TOML file with this text; `where` names the file in messages. Throws `Error` with the line that
/// is no TOML. Cost: linear.
TomlTable parse_toml(std::string_view text, const std::string& where);

}  // namespace pamr
