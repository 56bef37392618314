// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/catalog.hpp"

#include <algorithm>
#include <cstring>

#include "pamr/base/error.hpp"

namespace pamr::io {

namespace {

template <class Entries>
auto find_by_path(const Entries& entries, std::string_view path) {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const auto& e) { return e.path == path; });
  return found == entries.end() ? nullptr : &*found;
}

void put(std::string& out, std::int64_t value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

void put(std::string& out, const std::string& text) {
  put(out, static_cast<std::int64_t>(text.size()));
  out += text;
}

template <class T>
void put(std::string& out, const std::vector<T>& values);

void put(std::string& out, const ArrayEntry& entry) {
  put(out, entry.path);
  put(out, static_cast<std::int64_t>(entry.type));
  put(out, entry.shape);
  put(out, entry.values);
  put(out, std::int64_t{entry.is_chunked});
}

void put(std::string& out, const TextEntry& entry) {
  put(out, entry.path);
  put(out, entry.texts);
}

void put(std::string& out, const NumberEntry& entry) {
  put(out, entry.path);
  put(out, entry.values);
}

template <class T>
void put(std::string& out, const std::vector<T>& values) {
  put(out, static_cast<std::int64_t>(values.size()));
  for (const auto& value : values) put(out, value);
}

/// Takes values off the front of packed bytes.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : rest_(bytes) {}

  bool is_done() const { return rest_.empty(); }

  void get(std::int64_t& value) { std::memcpy(&value, take(sizeof value).data(), sizeof value); }

  void get(std::string& text) { text = take(size()); }

  void get(ArrayEntry& entry) {
    get(entry.path);
    std::int64_t type = 0;
    get(type);
    require(type >= 0 && type <= static_cast<std::int64_t>(mesh::StorageType::uint16));
    entry.type = static_cast<mesh::StorageType>(type);
    get(entry.shape);
    get(entry.values);
    std::int64_t is_chunked = 0;
    get(is_chunked);
    entry.is_chunked = is_chunked != 0;
  }

  void get(TextEntry& entry) {
    get(entry.path);
    get(entry.texts);
  }

  void get(NumberEntry& entry) {
    get(entry.path);
    get(entry.values);
  }

  template <class T>
  void get(std::vector<T>& values) {
    values.resize(size());
    for (auto& value : values) get(value);
  }

 private:
  static void require(bool good) {
    if (!good) throw Error("the process that looked through the file gave a garbled answer");
  }

  // Every item takes 8 bytes or more, so a length beyond the bytes at hand is known to be wrong before it is used.
  std::size_t size() {
    std::int64_t n = 0;
    get(n);
    require(n >= 0 && static_cast<std::uint64_t>(n) <= rest_.size());
    return static_cast<std::size_t>(n);
  }

  std::string_view take(std::size_t n) {
    require(n <= rest_.size());
    const auto front = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return front;
  }

  std::string_view rest_;
};

}  // namespace

const ArrayEntry* Catalog::find_array(std::string_view path) const { return find_by_path(arrays, path); }
const TextEntry* Catalog::find_text(std::string_view path) const { return find_by_path(texts, path); }
const NumberEntry* Catalog::find_number(std::string_view path) const { return find_by_path(numbers, path); }

std::string pack(const Catalog& catalog) {
  std::string out;
  put(out, std::int64_t{catalog.has_pamr_group});
  put(out, catalog.arrays);
  put(out, catalog.texts);
  put(out, catalog.numbers);
  put(out, catalog.others);
  return out;
}

Catalog unpack(std::string_view bytes) {
  Unpacker unpacker(bytes);
  Catalog catalog;
  std::int64_t has_pamr_group = 0;
  unpacker.get(has_pamr_group);
  catalog.has_pamr_group = has_pamr_group != 0;
  unpacker.get(catalog.arrays);
  unpacker.get(catalog.texts);
  unpacker.get(catalog.numbers);
  unpacker.get(catalog.others);
  return catalog;
}

}  // namespace pamr::io
