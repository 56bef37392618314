// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/io/elements/element_parts.hpp"
#include "pamr/io/elements/text_cursor.hpp"

/// What Medit's files of meshes and of fields have in common. Source: libMeshb (github.com/LoicMarechal/libMeshb),
/// "GMF: Gamma Mesh Format" and its table of keywords.
namespace pamr::io::gmf {

/// Numbers of keywords in binary files.
enum Keyword : std::int32_t {
  dimension = 3,
  vertices = 4,
  triangles = 6,
  quadrilaterals = 7,
  tetrahedra = 8,
  prisms = 9,
  pyramids = 49,
  end = 54,
  sol_at_vertices = 62,
  sol_at_tetrahedra = 66,
};

/// Keywords that a reader acts on or refuses: all of them with a count behind.
struct KnownKeyword {
  std::string_view name;
  std::int32_t code = 0;
  int refused_type = 0;  ///< type of elements that are no part of a mesh of ours (`element_type`), `left_out`, else 0
};
/// Of what a mesh of ours has no place for.
inline constexpr int left_out = -1;
const KnownKeyword* find(std::string_view name);
const KnownKeyword* find(std::int32_t code);

/// Reads either kind of file from front to back.
class Reader {
 public:
  /// Passes what comes before the first keyword but `Dimension`. Throws `Error` for what is no such file of three
  /// dimensions.
  Reader(TextCursor& in, bool is_binary);

  /// Whether a file is binary, by its first bytes.
  static bool is_binary(TextCursor in);

  using Take = std::function<void(const KnownKeyword&, std::int64_t n)>;
  /// Runs through the sections up to the end: calls `take` for each known keyword, with the number of its rows; it has
  /// to read all rows, or, in a binary file, any of the first. Those of other keywords are passed: `leave` has their
  /// names, "keyword 72" in a binary file.
  void for_each_section(const Take& take, const std::function<void(const std::string& name)>& leave);

  /// The name of the rows of a section, and the numbers that each has in a binary file.
  struct Row {
    std::string_view what;
    int n_reals = 0, n_integers = 0;
  };
  /// Reads rows `own` of `n`: `read` reads the numbers of one. In a text each row is a line of its own.
  void rows(std::int64_t n, par::BlockRange own, const Row& kind, const std::function<void(std::int64_t row)>& read);

  /// The next number of a row.
  std::int64_t integer(std::string_view what);
  double real(std::string_view what);
  /// A number before the rows: 32 bits in every binary version.
  std::int64_t small(std::string_view what);

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const { in_.fail(expected, found); }

 private:
  template <class T>
  T value(std::string_view what);
  /// Of a keyword of the head in a text: behind it, or at its end (`Dimension3`).
  std::int64_t number_of(std::string_view keyword, std::string_view what);
  std::int64_t position(std::string_view what);
  std::int64_t count(std::string_view what);
  void read_text(const Take& take, const std::function<void(const std::string& name)>& leave);
  void read_binary(const Take& take, const std::function<void(const std::string& name)>& leave);

  TextCursor& in_;
  bool binary_, swap_ = false;
  std::int64_t version_ = 2;
};

/// The versions of a binary file: 2 has positions of 32 bits, 3 of 64 bits, 4 counts and numbers of 64 bits as well.
int version_for(std::int64_t n_bytes, std::int64_t max_count);

}  // namespace pamr::io::gmf
