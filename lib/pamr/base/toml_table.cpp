// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/toml_table.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <variant>

#include "pamr/base/error.hpp"
#include "pamr/base/nearest_word.hpp"

namespace pamr {

namespace {

/// The line of a text, without blanks around it.
std::string_view line_of(std::string_view text, std::uint32_t line) {
  for (; line > 1 && !text.empty(); --line) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  text = text.substr(0, text.find('\n'));
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

std::string parse_message(std::string_view text, const std::string& where, const toml::parse_error& error) {
  const auto begin = error.source().begin;
  const std::string_view description = error.description();
  const bool is_string = description.find("string") != std::string_view::npos;
  const bool is_open = description.find("control characters") != std::string_view::npos ||
                       description.find("end-of-file") != std::string_view::npos;
  const auto what = is_string && is_open ? std::string("missing quote") : fmt::format("expected TOML: {}", description);
  return fmt::format("{}:{}:{}: {} in the line: {}", where, begin.line, begin.column, what, line_of(text, begin.line));
}

std::string joined(const std::vector<std::string>& words, std::string_view last) {
  std::string result;
  for (std::size_t i = 0; i < words.size(); ++i)
    result += (i == 0 ? std::string_view() : i + 1 == words.size() ? last : std::string_view(", ")), result += words[i];
  return result;
}

std::string described(NumberRange range) {
  const NumberRange any;
  const auto low = fmt::format("{}{:g}", range.low_excluded ? "above " : "of at least ", range.low);
  if (range.high == any.high) return range.low == any.low ? "a number" : "a number " + low;
  if (range.low == any.low) return fmt::format("a number of at most {:g}", range.high);
  if (range.low_excluded) return fmt::format("a number above {:g} and at most {:g}", range.low, range.high);
  return fmt::format("a number between {:g} and {:g}", range.low, range.high);
}

}  // namespace

struct TomlTable::Position {
  std::uint32_t line = 0, column = 0;

  explicit Position(const toml::source_region& source) : line(source.begin.line), column(source.begin.column) {}
};

/// A copy of toml++'s tree, so that its header stays in this file, with what was asked for beside each table.
struct TomlTable::Node {
  struct Entry {
    Position position;
    Node* node;
  };
  using Table = std::map<std::string, Entry, std::less<>>;
  using Array = std::vector<const Node*>;
  struct Date {};

  Position position;
  std::variant<Date, bool, std::int64_t, double, std::string, Array, Table> value;
  bool is_inline = false;
  mutable std::set<std::string, std::less<>> asked{};  ///< keys of a table
  mutable bool is_opened = false;                      ///< a table that was taken as a `TomlTable`
  mutable std::string title{};                         ///< what messages call that table; empty for the file

  template <class T>
  const T* as() const {
    return std::get_if<T>(&value);
  }
  const Table& entries() const { return *as<Table>(); }
  std::optional<double> finite() const;
  std::string shown() const;
};

struct TomlTable::Document {
  std::string text, where;
  std::vector<std::unique_ptr<Node>> nodes{};

  Node* copy(const toml::node& from);
  std::string at(Position position) const { return fmt::format("{}:{}:{}", where, position.line, position.column); }
};

std::optional<double> TomlTable::Node::finite() const {
  if (const auto* integer = as<std::int64_t>()) return static_cast<double>(*integer);
  const auto* real = as<double>();
  return real != nullptr && std::isfinite(*real) ? std::optional(*real) : std::nullopt;
}

/// What a node holds, for a message.
std::string TomlTable::Node::shown() const {
  constexpr std::size_t longest = 60;
  if (const auto* text = as<std::string>())
    return text->size() <= longest ? "\"" + *text + "\"" : "\"" + text->substr(0, longest) + "...\"";
  if (const auto* integer = as<std::int64_t>()) return fmt::format("{}", *integer);
  if (const auto* real = as<double>()) {
    const auto text = fmt::format("{}", *real);
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;  // no integer, infinity or NaN
  }
  if (const auto* truth = as<bool>()) return *truth ? "true" : "false";
  if (const auto* array = as<Array>()) return fmt::format("an array of {}", array->size());
  return as<Table>() != nullptr ? "a table" : "a date or time";
}

TomlTable::Node* TomlTable::Document::copy(const toml::node& from) {
  Node* node = nodes.emplace_back(new Node{Position(from.source()), Node::Date{}}).get();
  if (const auto truth = from.value_exact<bool>()) node->value = *truth;
  if (const auto integer = from.value_exact<std::int64_t>()) node->value = *integer;
  if (const auto real = from.value_exact<double>()) node->value = *real;
  if (const auto text_value = from.value_exact<std::string>()) node->value = *text_value;
  if (const auto* array = from.as_array()) {
    Node::Array items;
    for (const auto& item : *array) items.push_back(copy(item));
    node->value = std::move(items);
  }
  if (const auto* table = from.as_table()) {
    Node::Table entries;
    for (const auto& [key, item] : *table)
      entries.emplace(std::string(key.str()), Node::Entry{Position(key.source()), copy(item)});
    node->value = std::move(entries);
    node->is_inline = table->is_inline();
  }
  return node;
}

TomlTable parse_toml(std::string_view text, const std::string& where) {
  auto document = std::make_shared<TomlTable::Document>(TomlTable::Document{std::string(text), where});
  try {
    const auto* root = document->copy(toml::parse(text, where));
    return {document, root, ""};
  } catch (const toml::parse_error& error) {
    throw Error(parse_message(text, where, error));
  }
}

TomlTable::TomlTable(std::shared_ptr<const Document> document, const Node* node, std::string name)
    : document_(std::move(document)), node_(node), name_(std::move(name)) {
  node_->is_opened = true;
}

const std::string& TomlTable::title() const { return node_->title; }

void TomlTable::set_title(std::string title) { node_->title = std::move(title); }

/// " in [stream.free]", for messages; nothing for the file.
std::string TomlTable::in() const { return title().empty() ? "" : " in " + title(); }

bool TomlTable::has(std::string_view key) const {
  node_->asked.emplace(key);
  return node_->entries().contains(key);
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> result;
  for (const auto& [key, entry] : node_->entries()) {
    node_->asked.insert(key);
    result.push_back(key);
  }
  return result;
}

const TomlTable::Node* TomlTable::find(std::string_view key) const {
  node_->asked.emplace(key);
  const auto entry = node_->entries().find(key);
  return entry == node_->entries().end() ? nullptr : entry->second.node;
}

// --- errors

std::string TomlTable::at(std::string_view key) const {
  const auto entry = node_->entries().find(key);
  if (entry != node_->entries().end()) return document_->at(entry->second.node->position);
  return title().empty() ? document_->where : document_->at(node_->position);
}

void TomlTable::fail(std::string_view message) const { throw Error(fmt::format("{}: {}", at(), message)); }

void TomlTable::refuse(std::string_view key, std::string_view expected, std::string_view found) const {
  throw Error(fmt::format("{}: expected {} = {}{}, found {}", at(key), key, expected, in(), found));
}

void TomlTable::refuse(std::string_view key, std::string_view expected) const {
  const auto* node = find(key);
  if (node == nullptr) refuse_missing(key, expected);
  refuse(key, expected, node->shown());
}

void TomlTable::refuse_value(std::string_view key, const Node& node, std::string_view expected) const {
  throw Error(
      fmt::format("{}: expected {} = {}{}, found {}", document_->at(node.position), key, expected, in(), node.shown()));
}

/// A key that nobody asked for and that looks like the missing one is taken for a misspelling of it.
void TomlTable::refuse_misspelled(std::string_view key) const {
  std::vector<std::string> others;
  for (const auto& [other, entry] : node_->entries())
    if (!node_->asked.contains(other)) others.push_back(other);
  if (const auto near = nearest_word(key, others))
    throw Error(fmt::format("{}: unknown key '{}'{}; did you mean '{}'?",
                            document_->at(node_->entries().at(*near).position), *near, in(), key));
}

void TomlTable::refuse_missing(std::string_view key, std::string_view expected) const {
  refuse_misspelled(key);
  refuse(key, expected, "none");
}

void TomlTable::finish() const {
  for (const auto& [key, entry] : node_->entries()) {
    if (!node_->asked.contains(key)) {
      const std::vector<std::string> known(node_->asked.begin(), node_->asked.end());
      const auto near = nearest_word(key, known);
      const auto hint = near            ? fmt::format("did you mean '{}'?", *near)
                        : known.empty() ? std::string("expected no keys")
                                        : fmt::format("expected one of {}", joined(known, ", "));
      throw Error(fmt::format("{}: unknown key '{}'{}; {}", document_->at(entry.position), key, in(), hint));
    }
    const auto finish_opened = [&, name = std::string_view(key)](const Node& node) {
      if (node.is_opened) TomlTable(document_, &node, std::string(name)).finish();
    };
    finish_opened(*entry.node);
    if (const auto* array = entry.node->as<Node::Array>())
      for (const auto* item : *array) finish_opened(*item);
  }
}

// --- values

std::optional<double> TomlTable::read_number(const Node& node, NumberRange range) const {
  const auto value = node.finite();
  if (!value || !(*value >= range.low && *value <= range.high) || (range.low_excluded && *value == range.low))
    return std::nullopt;
  return value;
}

std::optional<double> TomlTable::find_number(std::string_view key, NumberRange range) const {
  const auto* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto value = read_number(*node, range);
  if (!value) refuse_value(key, *node, described(range));
  return value;
}

double TomlTable::number(std::string_view key, NumberRange range) const {
  const auto value = find_number(key, range);
  if (!value) refuse_missing(key, described(range));
  return *value;
}

std::optional<std::int64_t> TomlTable::find_integer(std::string_view key, std::int64_t low, std::int64_t high) const {
  const auto* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = node->as<std::int64_t>();
  if (value == nullptr || *value < low || *value > high)
    refuse_value(key, *node, fmt::format("an integer between {} and {}", low, high));
  return *value;
}

std::int64_t TomlTable::integer(std::string_view key, std::int64_t low, std::int64_t high) const {
  const auto value = find_integer(key, low, high);
  if (!value) refuse_missing(key, fmt::format("an integer between {} and {}", low, high));
  return *value;
}

std::vector<std::int64_t> TomlTable::integers(std::string_view key, std::int64_t low, std::int64_t high) const {
  const auto expected = fmt::format("an array of integers between {} and {}", low, high);
  const auto* node = find(key);
  if (node == nullptr) refuse_missing(key, expected);
  const auto* array = node->as<Node::Array>();
  if (array == nullptr) refuse_value(key, *node, expected);
  std::vector<std::int64_t> result;
  for (const auto* item : *array) {
    const auto* value = item->as<std::int64_t>();
    if (value == nullptr || *value < low || *value > high) refuse_value(key, *item, expected);
    result.push_back(*value);
  }
  return result;
}

bool TomlTable::flag(std::string_view key) const {
  const auto* node = find(key);
  if (node == nullptr) refuse_missing(key, "true or false");
  const auto* value = node->as<bool>();
  if (value == nullptr) refuse_value(key, *node, "true or false");
  return *value;
}

std::optional<std::string> TomlTable::find_text(std::string_view key, std::string_view expected) const {
  const auto* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = node->as<std::string>();
  if (value == nullptr || value->empty()) refuse_value(key, *node, expected);
  return *value;
}

std::string TomlTable::text(std::string_view key, std::string_view expected) const {
  const auto value = find_text(key, expected);
  if (!value) refuse_missing(key, expected);
  return *value;
}

namespace {

std::string one_of(std::initializer_list<std::string_view> words) {
  std::vector<std::string> quoted;
  for (const auto word : words) quoted.push_back(fmt::format("\"{}\"", word));
  return joined(quoted, " or ");
}

}  // namespace

std::optional<std::string> TomlTable::find_word(std::string_view key,
                                                std::initializer_list<std::string_view> words) const {
  const auto* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = node->as<std::string>();
  if (value == nullptr || std::find(words.begin(), words.end(), *value) == words.end())
    refuse_value(key, *node, one_of(words));
  return *value;
}

std::string TomlTable::word(std::string_view key, std::initializer_list<std::string_view> words) const {
  const auto value = find_word(key, words);
  if (!value) refuse_missing(key, one_of(words));
  return *value;
}

std::vector<std::string> TomlTable::texts(std::string_view key) const {
  constexpr std::string_view expected = "an array of texts";
  const auto* node = find(key);
  if (node == nullptr) refuse_missing(key, expected);
  const auto* array = node->as<Node::Array>();
  if (array == nullptr) refuse_value(key, *node, expected);
  std::vector<std::string> result;
  for (const auto* item : *array) {
    const auto* text = item->as<std::string>();
    if (text == nullptr) refuse_value(key, *item, expected);
    result.push_back(*text);
  }
  return result;
}

std::vector<double> TomlTable::numbers(std::string_view key, std::size_t n) const {
  const auto expected = fmt::format("an array of {} numbers", n);
  const auto* node = find(key);
  if (node == nullptr) refuse_missing(key, expected);
  const auto* array = node->as<Node::Array>();
  if (array == nullptr || array->size() != n) refuse_value(key, *node, expected);
  std::vector<double> result;
  for (const auto* item : *array) {
    const auto value = item->finite();
    if (!value) refuse_value(key, *item, expected);
    result.push_back(*value);
  }
  return result;
}

std::array<double, 3> TomlTable::read_point(std::string_view key, const Node& node, std::string_view expected) const {
  const auto* array = node.as<Node::Array>();
  if (array == nullptr || array->size() != 3) refuse_value(key, node, expected);
  std::array<double, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto value = (*array)[i]->finite();
    if (!value) refuse_value(key, *(*array)[i], expected);
    result[i] = *value;
  }
  return result;
}

std::vector<std::array<double, 3>> TomlTable::point_array(std::string_view key, std::size_t n) const {
  const auto expected = fmt::format("an array of {} points [[x, y, z], ...]", n);
  const auto* node = find(key);
  if (node == nullptr) refuse_missing(key, expected);
  const auto* array = node->as<Node::Array>();
  if (array == nullptr || array->size() != n) refuse_value(key, *node, expected);
  std::vector<std::array<double, 3>> result;
  for (const auto* point : *array) result.push_back(read_point(key, *point, expected));
  return result;
}

std::vector<std::vector<std::array<double, 3>>> TomlTable::polyline_array(std::string_view key) const {
  constexpr std::string_view expected = "polylines [[[x, y, z], [x, y, z], ...], ...]";
  const auto* node = find(key);
  if (node == nullptr) refuse_missing(key, expected);
  const auto* lines = node->as<Node::Array>();
  if (lines == nullptr) refuse_value(key, *node, expected);
  std::vector<std::vector<std::array<double, 3>>> result;
  for (const auto* line : *lines) {
    const auto* points = line->as<Node::Array>();
    if (points == nullptr || points->size() < 2) refuse_value(key, *line, expected);
    auto& read = result.emplace_back();
    for (const auto* point : *points) read.push_back(read_point(key, *point, expected));
  }
  return result;
}

// --- tables

/// [stream] within the file, [stream.free] within [stream], "profile of surface "ball"" within a table with a title.
std::string TomlTable::inner_title(std::string_view key) const {
  if (title().empty()) return fmt::format("[{}]", key);
  if (!title().starts_with('[')) return fmt::format("{} of {}", key, title());
  const auto begin = title().find_first_not_of('[');
  return fmt::format("[{}.{}]", title().substr(begin, title().find(']') - begin), key);
}

TomlTable TomlTable::open(std::string_view key, const Node& node, const std::string& title) const {
  if (node.as<Node::Table>() == nullptr)
    throw Error(fmt::format("{}: expected a table {}, found {}", document_->at(node.position), title, node.shown()));
  if (!node.is_opened) node.title = title;
  return {document_, &node, std::string(key)};
}

std::optional<TomlTable> TomlTable::find_table(std::string_view key) const {
  const auto* node = find(key);
  if (node == nullptr) return std::nullopt;
  return open(key, *node, inner_title(key));
}

TomlTable TomlTable::table(std::string_view key) const {
  auto result = find_table(key);
  if (result) return *std::move(result);
  refuse_misspelled(key);
  fail(fmt::format("expected a table {}, found none", inner_title(key)));
}

std::vector<TomlTable> TomlTable::list(std::string_view key) const {
  std::vector<TomlTable> result;
  const auto* node = find(key);
  if (node == nullptr) return result;
  auto title = inner_title(key);
  if (title.starts_with('[')) title = "[" + title + "]";
  const auto* array = node->as<Node::Array>();
  if (array == nullptr)
    throw Error(fmt::format("{}: expected tables {}, found {}", document_->at(node->position), title, node->shown()));
  for (std::size_t i = 0; i < array->size(); ++i) result.push_back(open(key, *(*array)[i], title));
  return result;
}

bool TomlTable::has_list(std::string_view key) const {
  const auto entry = node_->entries().find(key);
  return entry != node_->entries().end() && entry->second.node->as<Node::Array>() != nullptr;
}

std::vector<TomlTable> TomlTable::all_tables() const {
  std::vector<TomlTable> result;
  for (const auto& key : keys()) result.push_back(*find_table(key));
  return result;
}

// --- source

std::string TomlTable::source_of(std::string_view key) const {
  using Headers = std::vector<std::pair<std::uint32_t, bool>>;  // lines of tables with a header, and if they are kept
  Headers headers;
  const auto collect = [&](const auto& self, const Node& node, bool is_kept) -> void {
    if (const auto* array = node.as<Node::Array>())
      for (const auto* item : *array) self(self, *item, is_kept);
    if (node.as<Node::Table>() == nullptr || node.is_inline) return;
    headers.emplace_back(node.position.line, is_kept);
    for (const auto& [name, entry] : node.entries()) self(self, *entry.node, is_kept);
  };
  for (const auto& [name, entry] : node_->entries()) collect(collect, *entry.node, name == key);
  std::sort(headers.begin(), headers.end());

  const std::string_view text = document_->text;
  std::string result;
  std::size_t line = 1, next = 0;
  bool is_kept = false;
  for (std::size_t begin = 0; begin < text.size(); ++line) {
    const auto end = std::min(text.find('\n', begin), text.size());
    for (; next < headers.size() && headers[next].first <= line; ++next) is_kept = headers[next].second;
    if (is_kept) result += text.substr(begin, end - begin);
    result += '\n';
    begin = end + 1;
  }
  return result;
}

}  // namespace pamr
