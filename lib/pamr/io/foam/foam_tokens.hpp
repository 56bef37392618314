// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/io/elements/text_cursor.hpp"

/// Words, dictionaries and lists of OpenFOAM's files. Source: OpenFOAM user guide, "Basic input/output file format" and
/// "Mesh description".
namespace pamr::io::foam {

/// Whether a file is there, packed by gzip or not.
bool is_present(const std::filesystem::path& file);

/// Nodes of faces that have any number of corners.
class FaceNodes {
 public:
  FaceNodes() = default;
  /// `begin`: where each face begins among the nodes, and where the last one ends; ascending. Empty: no faces.
  FaceNodes(std::vector<std::int64_t> begin, std::vector<std::int64_t> node)
      : begin_(std::move(begin)), node_(std::move(node)) {}

  std::size_t size() const { return begin_.empty() ? 0 : begin_.size() - 1; }
  std::span<const std::int64_t> operator[](std::size_t face) const {
    return std::span(node_).subspan(at(begin_[face]), at(begin_[face + 1] - begin_[face]));
  }

 private:
  std::vector<std::int64_t> begin_, node_;
};

/// One file of `polyMesh`, read from front to back. Local; errors name the file and the line.
class FoamFile {
 public:
  /// Reads the header, of the file that gzip has packed where there is no other. Throws `Error` where there is none.
  explicit FoamFile(const std::filesystem::path& file);

  /// The next word, number, text in quotes or mark of punctuation, over comments.
  std::string_view word(std::string_view what);
  /// Passes this word.
  void require(std::string_view text);
  /// Whether the next word is this one; it is passed then.
  bool passes(std::string_view text);

  std::int64_t integer(std::string_view what);
  /// The entries of a dictionary up to its closing brace: the first word behind each key; what is in brackets is
  /// passed. `take` may read an entry itself, and returns whether it has.
  template <class Take>
  std::map<std::string, std::string> dictionary(Take&& take) {
    std::map<std::string, std::string> entries;
    require("{");
    while (!passes("}")) {
      const std::string key(word("a key of a dictionary"));
      if (!take(key)) entries[key] = value();
    }
    return entries;
  }
  /// Numbers in a list, as text or bytes, with their count before them: 3(7 7 8), or 3{7} where all are 7.
  std::vector<std::int64_t> labels();
  /// Reads a list of 0 and 1, which bytes hold in one each; how many are 1.
  std::int64_t count_flags();
  std::vector<geometry::Vec3> points();
  FaceNodes faces();

  /// The count before a list; each item takes at least so many bytes.
  std::int64_t count(std::size_t min_bytes, std::string_view what);
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const { in_.fail(expected, found); }

 private:
  std::string value();
  void skip_blanks();
  template <class T>
  T number(std::string_view what);
  void append_labels(std::vector<std::int64_t>& numbers);
  std::int64_t raw_label();

  std::filesystem::path file_;  ///< with .gz where it is packed
  MappedFile mapped_;
  std::string unpacked_;
  TextCursor in_;
  bool binary_ = false, is_compact_ = false;
  int label_bytes_ = 4, scalar_bytes_ = 8;
};

}  // namespace pamr::io::foam
