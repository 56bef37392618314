// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/vtk/vtk_xml.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <iterator>
#include <limits>
#include <pugixml.hpp>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/io/elements/first_line.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io::vtk {

namespace {

using Bytes = std::vector<unsigned char>;

constexpr std::array<std::pair<std::string_view, mesh::StorageType>, 10> number_types{
    {{"Float64", mesh::StorageType::float64},
     {"Float32", mesh::StorageType::float32},
     {"Int64", mesh::StorageType::int64},
     {"Int32", mesh::StorageType::int32},
     {"UInt64", mesh::StorageType::uint64},
     {"UInt32", mesh::StorageType::uint32},
     {"UInt8", mesh::StorageType::uint8},
     {"Int8", mesh::StorageType::int8},
     {"Int16", mesh::StorageType::int16},
     {"UInt16", mesh::StorageType::uint16}}};

constexpr std::string_view blanks = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(blanks);
  return begin == std::string_view::npos ? std::string_view()
                                         : text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

std::string value_of(const pugi::xml_node& element, const char* name, const char* otherwise = "") {
  std::string value = element.attribute(name).as_string(otherwise);
  if (!is_clean_text(value, ""))
    throw Error(fmt::format("element {}: expected one line in UTF-8 as {}, found another text", element.name(), name));
  return value;
}

std::int64_t number_in(const pugi::xml_node& element, const char* name, std::int64_t otherwise) {
  const auto text = value_of(element, name);
  if (text.empty()) return otherwise;
  std::int64_t number = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc() || end != text.data() + text.size() || number < 0)
    throw Error(
        fmt::format("element {}: expected a count as {}, found \"{}\"", element.name(), name, text.substr(0, 40)));
  return number;
}

void read_head(const pugi::xml_node& file, XmlGrid& grid) {
  const auto require = [](std::string_view what, const std::string& found,
                          std::initializer_list<std::string_view> known) {
    if (std::find(known.begin(), known.end(), found) == known.end())
      throw Error(fmt::format("expected {} as {}, found \"{}\"", *known.begin(), what, found.substr(0, 40)));
  };
  require("type of grid", value_of(file, "type"), {"UnstructuredGrid"});
  require("order of bytes", value_of(file, "byte_order", "LittleEndian"), {"LittleEndian"});
  const auto header = value_of(file, "header_type", "UInt32"), compressor = value_of(file, "compressor");
  require("type of headers", header, {"UInt32", "UInt64"});
  require("compressor", compressor, {"vtkZLibDataCompressor", ""});
  grid.has_wide_header = header == "UInt64";
  grid.is_compressed = !compressor.empty();
}

void read_arrays(const pugi::xml_node& place, XmlGrid& grid) {
  for (const auto& array : place.children()) {
    const std::string_view element = array.name();
    if (element != "DataArray" && element != "Array") continue;  // the latter of texts
    grid.arrays.push_back({.place = place.name(),
                           .name = value_of(array, "Name"),
                           .type = value_of(array, "type"),
                           .format = value_of(array, "format", "ascii"),
                           .n_components = std::max<std::int64_t>(1, number_in(array, "NumberOfComponents", 1)),
                           .has_component_names = !array.attribute("ComponentName0").empty(),
                           .offset = static_cast<std::size_t>(number_in(array, "offset", 0)),
                           .content = array.child_value()});
  }
}

[[noreturn]] void fail(const XmlArray& array, const std::string& expected, const std::string& found) {
  throw Error(fmt::format("{} array '{}': expected {}, found {}", array.place, array.name, expected, found));
}

/// A source of bytes: raw, or base64 whose runs may each end with padding.
class ByteSource {
 public:
  ByteSource(const XmlArray& array, std::string_view text, bool is_raw)
      : array_(&array), text_(text), is_raw_(is_raw) {}

  Bytes take(std::size_t n) {
    const auto most = is_raw_ ? text_.size() : rest_.size() + text_.size() / 4 * 3;
    if (n > most) fail(*array_, fmt::format("{} bytes", n), "fewer");
    Bytes bytes;
    bytes.reserve(n + 3);
    if (is_raw_) {
      bytes.assign(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(n));
      text_.remove_prefix(n);
      return bytes;
    }
    bytes.swap(rest_);
    while (bytes.size() < n) group(bytes);
    rest_.assign(bytes.begin() + static_cast<std::ptrdiff_t>(n), bytes.end());
    bytes.resize(n);
    return bytes;
  }

  /// What base64 has beyond the last bytes belongs to the run that ends there.
  void end_run() { rest_.clear(); }

 private:
  static int digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
  }

  void group(Bytes& bytes) {
    std::uint32_t word = 0;
    int n = 0, padding = 0;
    while (n < 4) {
      if (text_.empty()) fail(*array_, "base64 in groups of four characters", "the end of it");
      const char c = text_.front();
      text_.remove_prefix(1);
      if (blanks.find(c) != std::string_view::npos) continue;
      if (c == '=')
        ++padding;
      else if (digit(c) < 0 || padding > 0)
        fail(*array_, "base64", "another character");
      word = word << 6U | static_cast<std::uint32_t>(c == '=' ? 0 : digit(c));
      ++n;
    }
    if (padding > 2) fail(*array_, "base64", "too much padding");
    for (int i = 0; i < 3 - padding; ++i)
      bytes.push_back(static_cast<unsigned char>(word >> static_cast<unsigned>(16 - 8 * i) & 255U));
  }

  const XmlArray* array_;
  std::string_view text_;
  bool is_raw_;
  Bytes rest_;
};

class BinaryReader {
 public:
  BinaryReader(const XmlGrid& grid, const XmlArray& array)
      : array_(&array),
        header_bytes_(grid.has_wide_header ? 8 : 4),
        is_compressed_(grid.is_compressed),
        source_(array, text_of(grid, array), array.format == "appended" && grid.is_raw) {}

  /// So many bytes, no more and no fewer.
  Bytes read(std::uint64_t expected) {
    if (!is_compressed_) {
      require_size(header(), expected);
      return source_.take(expected);
    }
    const auto n_blocks = header(), block = header(), last = header();
    const auto sizes_of_blocks = [&](std::uint64_t i) { return i + 1 == n_blocks && last != 0 ? last : block; };
    constexpr std::uint64_t most = std::uint64_t{1} << 40U;
    if (n_blocks > most || block > most || last > block || (n_blocks > 0 && block == 0) ||
        (block > 0 && n_blocks > most / block))
      fail(*array_, "sizes of blocks that are possible", "others");
    require_size(n_blocks == 0 ? 0 : (n_blocks - 1) * block + sizes_of_blocks(n_blocks - 1), expected);
    std::vector<std::uint64_t> packed;
    for (std::uint64_t i = 0; i < n_blocks; ++i) packed.push_back(header());
    source_.end_run();
    Bytes result;
    for (std::uint64_t i = 0; i < n_blocks; ++i) {
      const auto bytes = source_.take(packed[i]);
      const auto begin = result.size(), n = static_cast<std::size_t>(sizes_of_blocks(i));
      if (n / 1100 > bytes.size()) fail(*array_, fmt::format("{} bytes packed by zlib", n), "too few");
      result.resize(begin + n);
      uLongf size = n;
      if (uncompress(result.data() + begin, &size, bytes.data(), bytes.size()) != Z_OK || size != n)
        fail(*array_, "data packed by zlib", "others");
    }
    return result;
  }

 private:
  static std::string_view text_of(const XmlGrid& grid, const XmlArray& array) {
    if (array.format == "binary") return trimmed(array.content);
    if (array.offset > grid.appended.size()) fail(array, "an offset into the appended data", "one beyond it");
    return grid.appended.substr(array.offset);
  }

  std::uint64_t header() {
    const auto bytes = source_.take(header_bytes_);
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data(), bytes.size());
    return value;
  }

  void require_size(std::uint64_t found, std::uint64_t expected) const {
    if (found != expected) fail(*array_, fmt::format("{} bytes", expected), fmt::format("{}", found));
  }

  const XmlArray* array_;
  std::size_t header_bytes_;
  bool is_compressed_;
  ByteSource source_;
};

/// The word that begins there, for messages.
std::string word_at(const char* begin, const char* end) {
  const std::string_view rest(begin, static_cast<std::size_t>(std::min<std::ptrdiff_t>(end - begin, 20)));
  const auto word = rest.substr(0, rest.find_first_of(blanks));
  return is_clean_text(std::string(word), "") ? std::string(word) : std::string("other bytes");
}

template <class T>
std::vector<T> from_text(const XmlArray& array, std::int64_t n) {
  std::vector<T> values;
  const char *at = array.content.data(), *end = at + array.content.size();
  for (;;) {
    while (at < end && blanks.find(*at) != std::string_view::npos) ++at;
    if (at == end) break;
    T value{};
    const auto [next, code] = std::from_chars(at, end, value);
    if (code != std::errc()) fail(array, "numbers", "\"" + word_at(at, end) + "\"");
    values.push_back(value);
    at = next;
  }
  if (std::ssize(values) != n) fail(array, fmt::format("{} values", n), fmt::format("{}", values.size()));
  return values;
}

template <class Stored, class T>
std::vector<T> from_bytes(const XmlGrid& grid, const XmlArray& array, std::int64_t n) {
  const auto bytes = BinaryReader(grid, array).read(static_cast<std::uint64_t>(n) * sizeof(Stored));
  std::vector<T> values;
  assign_array(values, static_cast<std::size_t>(n), T{});
  for (std::size_t i = 0; i < values.size(); ++i) {
    Stored value;
    std::memcpy(&value, bytes.data() + i * sizeof value, sizeof value);
    if constexpr (std::is_same_v<Stored, std::uint64_t>)
      if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
        fail(array, "integers below 2^63", fmt::format("{}", value));
    values[i] = static_cast<T>(value);
  }
  return values;
}

}  // namespace

const XmlArray* XmlGrid::find(std::string_view place, std::string_view name) const {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const XmlArray& array) {
    return array.place == place && (name.empty() || array.name == name);
  });
  return found == arrays.end() ? nullptr : &*found;
}

XmlGrid parse_grid(std::string& text) {
  const auto appended = text.find("<AppendedData");
  const auto underscore = appended == std::string::npos ? appended : text.find('_', appended);
  if (appended != underscore && underscore == std::string::npos)
    throw Error("AppendedData: expected data after an underscore, found none");
  const auto begin = text.substr(0, 1000);
  // What follows may be raw bytes, which are no XML: the text ends within elements then.
  pugi::xml_document document;
  const auto parsed = document.load_buffer_inplace(text.data(), std::min(underscore, text.size()), pugi::parse_escapes,
                                                   pugi::encoding_utf8);
  const auto file = document.child("VTKFile");
  const auto data = file.child("AppendedData");
  if (parsed.status == pugi::status_no_document_element || (parsed && !file))
    throw Error("expected a file of VTK in XML, found " + what_begins(std::string_view(begin)));
  if (!parsed && !(data && parsed.status == pugi::status_end_element_mismatch))
    throw Error(fmt::format("byte {}: expected XML, found another text ({})", parsed.offset, parsed.description()));
  XmlGrid grid;
  read_head(file, grid);
  const auto body = file.child("UnstructuredGrid");
  const auto pieces = body.children("Piece");
  if (const auto n = std::distance(pieces.begin(), pieces.end()); n != 1)
    throw Error(fmt::format("expected an unstructured grid of 1 piece, found {}", n));
  const auto piece = body.child("Piece");
  grid.n_points = number_in(piece, "NumberOfPoints", 0);
  grid.n_cells = number_in(piece, "NumberOfCells", 0);
  for (const auto& field_data : body.children("FieldData")) read_arrays(field_data, grid);
  for (const auto& place : piece.children()) read_arrays(place, grid);
  if (data) {
    grid.is_raw = value_of(data, "encoding", "base64") == "raw";
    grid.appended = std::string_view(text).substr(underscore + 1);
  }
  return grid;
}

bool is_number_type(std::string_view type) {
  return std::any_of(number_types.begin(), number_types.end(), [&](const auto& entry) { return entry.first == type; });
}

mesh::StorageType storage_of(std::string_view type) {
  const auto* found =
      std::find_if(number_types.begin(), number_types.end(), [&](const auto& entry) { return entry.first == type; });
  if (found == number_types.end()) throw Error(fmt::format("expected numbers, found the type {}", type.substr(0, 20)));
  return found->second;
}

Values values_of(const XmlGrid& grid, const XmlArray& array, std::int64_t n) {
  if (!is_number_type(array.type)) fail(array, "numbers", "the type " + array.type.substr(0, 20));
  const auto type = storage_of(array.type);
  if (array.format == "ascii") {
    if (mesh::is_integer(type)) return from_text<std::int64_t>(array, n);
    return from_text<double>(array, n);
  }
  if (array.format != "binary" && array.format != "appended")
    fail(array, "the format ascii, binary or appended", array.format.substr(0, 20));
  switch (type) {
    case mesh::StorageType::float64:
      return from_bytes<double, double>(grid, array, n);
    case mesh::StorageType::float32:
      return from_bytes<float, double>(grid, array, n);
    case mesh::StorageType::int64:
      return from_bytes<std::int64_t, std::int64_t>(grid, array, n);
    case mesh::StorageType::int32:
      return from_bytes<std::int32_t, std::int64_t>(grid, array, n);
    case mesh::StorageType::int16:
      return from_bytes<std::int16_t, std::int64_t>(grid, array, n);
    case mesh::StorageType::int8:
      return from_bytes<std::int8_t, std::int64_t>(grid, array, n);
    case mesh::StorageType::uint64:
      return from_bytes<std::uint64_t, std::int64_t>(grid, array, n);
    case mesh::StorageType::uint32:
      return from_bytes<std::uint32_t, std::int64_t>(grid, array, n);
    case mesh::StorageType::uint16:
      return from_bytes<std::uint16_t, std::int64_t>(grid, array, n);
    case mesh::StorageType::uint8:
      return from_bytes<std::uint8_t, std::int64_t>(grid, array, n);
  }
  fail(array, "a known type", "another");
}

std::vector<std::int64_t> integers_of(const XmlGrid& grid, const XmlArray& array, std::int64_t n) {
  auto values = values_of(grid, array, n);
  if (values.index() != 1) fail(array, "integers", "reals");
  return std::move(std::get<1>(values));
}

}  // namespace pamr::io::vtk
