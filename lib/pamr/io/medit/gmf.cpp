// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/medit/gmf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "pamr/io/elements/first_line.hpp"
#include "pamr/io/elements/numbers.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io::gmf {

namespace {

constexpr char comment = '#';

constexpr std::array<KnownKeyword, 39> known{{{"Vertices", vertices, 0},
                                              {"Triangles", triangles, 0},
                                              {"Tetrahedra", tetrahedra, 0},
                                              {"SolAtVertices", sol_at_vertices, 0},
                                              {"SolAtTetrahedra", sol_at_tetrahedra, 0},
                                              {"Quadrilaterals", quadrilaterals, 0},
                                              {"Prisms", prisms, 0},
                                              {"Hexahedra", 10, element_type::hexahedron},
                                              {"Pyramids", pyramids, 0},
                                              {"TrianglesP2", 24, element_type::triangle_2},
                                              {"TetrahedraP2", 30, element_type::tetrahedron_2},
                                              {"QuadrilateralsQ2", 27, 10},
                                              {"HexahedraQ2", 33, 12},
                                              {"PrismsP2", 86, 13},
                                              {"PyramidsP2", 87, 14},
                                              {"TrianglesP3", 90, 21},
                                              {"TrianglesP4", 91, 23},
                                              {"TetrahedraP3", 96, 29},
                                              {"TetrahedraP4", 97, 30},
                                              {"Polyhedra", 46, element_type::polygon},
                                              {"Polygons", 47, element_type::polygon},
                                              {"PeriodicVertices", 82, 0},
                                              {"PeriodicTriangles", 84, 0},
                                              {"SolAtEdges", 63, 0},
                                              {"SolAtTriangles", 64, 0},
                                              {"SolAtPrisms", 67, 0},
                                              {"SolAtHexahedra", 68, 0},
                                              {"Edges", 5, left_out},
                                              {"Corners", 13, left_out},
                                              {"Ridges", 14, left_out},
                                              {"RequiredVertices", 15, left_out},
                                              {"RequiredEdges", 16, left_out},
                                              {"RequiredTriangles", 17, left_out},
                                              {"NormalAtVertices", 20, left_out},
                                              {"NormalAtTriangleVertices", 21, left_out},
                                              {"TangentAtEdgeVertices", 19, left_out},
                                              {"Tangents", 59, left_out},
                                              {"Normals", 60, left_out},
                                              {"TangentAtVertices", 61, left_out}}};

}  // namespace

const KnownKeyword* find(std::string_view name) {
  const auto found = std::find_if(known.begin(), known.end(), [&](const auto& k) { return k.name == name; });
  return found == known.end() ? nullptr : &*found;
}

const KnownKeyword* find(std::int32_t code) {
  const auto found = std::find_if(known.begin(), known.end(), [&](const auto& k) { return k.code == code; });
  return found == known.end() ? nullptr : &*found;
}

int version_for(std::int64_t n_bytes, std::int64_t max_count) {
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  return max_count > most ? 4 : n_bytes > most ? 3 : 2;
}

bool Reader::is_binary(TextCursor in) {
  if (in.remaining() < 4) return false;
  const auto code = in.value<std::int32_t>("the order of bytes");
  return code == 1 || code == byteswapped(1);
}

Reader::Reader(TextCursor& in, bool is_binary) : in_(in), binary_(is_binary) {
  in_.set_binary(binary_);
  std::int64_t n_dimensions = 0;
  if (binary_) {
    swap_ = in_.value<std::int32_t>("the order of bytes") != 1;
    version_ = value<std::int32_t>("the version of the format");
    if (version_ < 1 || version_ > 4) fail("version 1 to 4 of the format", fmt::format("{}", version_));
    if (value<std::int32_t>("Dimension") != dimension) fail("the keyword Dimension", "another");
    (void)position("the place of the next keyword");
    n_dimensions = value<std::int32_t>("the dimension");
  } else {
    in_.skip_byte_order_mark();
    in_.skip_empty_lines(comment);
    version_ = number_of("MeshVersionFormatted", "the version of the format");
    if (version_ < 1 || version_ > 4) fail("version 1 to 4 of the format", fmt::format("{}", version_));
    (void)in_.line();
    in_.skip_empty_lines(comment);
    n_dimensions = number_of("Dimension", "the dimension");
    (void)in_.line();
  }
  if (n_dimensions != 3) fail("3 dimensions", fmt::format("{}", n_dimensions));
}

std::int64_t Reader::number_of(std::string_view keyword, std::string_view what) {
  const auto begin = in_;
  const auto found = in_.keyword();
  if (!found.starts_with(keyword)) begin.fail(fmt::format("{} of a Medit file", keyword), what_begins(begin.rest()));
  const auto digits = found.substr(keyword.size());
  if (digits.empty()) return in_.integer(what);
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size()) begin.fail(std::string(what), std::string(found));
  return number;
}

template <class T>
T Reader::value(std::string_view what) {
  const auto read = in_.value<T>(what);
  return swap_ ? byteswapped(read) : read;
}

std::int64_t Reader::position(std::string_view what) {
  return version_ >= 3 ? value<std::int64_t>(what) : value<std::int32_t>(what);
}

std::int64_t Reader::count(std::string_view what) {
  return version_ >= 4 ? value<std::int64_t>(what) : value<std::int32_t>(what);
}

std::int64_t Reader::integer(std::string_view what) {
  if (!binary_) return in_.integer_in_line(what);
  return version_ >= 4 ? value<std::int64_t>(what) : value<std::int32_t>(what);
}

double Reader::real(std::string_view what) {
  if (!binary_) return in_.real_in_line(what);
  const double read = version_ == 1 ? value<float>(what) : value<double>(what);
  if (!std::isfinite(read)) fail(std::string(what) + " that is finite", "another");
  return read;
}

std::int64_t Reader::small(std::string_view what) { return binary_ ? value<std::int32_t>(what) : in_.integer(what); }

void Reader::rows(std::int64_t n, par::BlockRange own, const Row& kind,
                  const std::function<void(std::int64_t row)>& read) {
  const auto& [what, n_reals, n_integers] = kind;
  const auto size = static_cast<std::size_t>(n_reals) * (version_ == 1 ? 4 : 8) +
                    static_cast<std::size_t>(n_integers) * (version_ >= 4 ? 8 : 4);
  in_.checked_count(n, binary_ ? size : 2 * static_cast<std::size_t>(n_reals + n_integers), what);
  if (!binary_) {
    if (!in_.is_line_over(comment)) fail("the end of the line before the rows of " + std::string(what), "more");
    (void)in_.line();
    in_.skip_empty_lines(comment);
  }
  binary_ ? in_.skip_rows(own.begin, size, what) : in_.skip_lines(own.begin, what);
  for (auto row = own.begin; row < own.end; ++row) {
    read(row);
    if (binary_) continue;
    if (!in_.is_line_over(comment)) fail("a line for each row of " + std::string(what), "more numbers in one");
    (void)in_.line();
  }
  binary_ ? in_.skip_rows(n - own.end, size, what) : in_.skip_lines(n - own.end, what);
}

void Reader::for_each_section(const Take& take, const std::function<void(const std::string& name)>& leave) {
  binary_ ? read_binary(take, leave) : read_text(take, leave);
}

void Reader::read_text(const Take& take, const std::function<void(const std::string& name)>& leave) {
  bool is_foreign = false;  // behind a keyword that is not looked at
  for (in_.skip_empty_lines(comment); !in_.at_end(); in_.skip_empty_lines(comment)) {
    const auto name = in_.keyword();
    if (name == "End") {
      (void)in_.line();
      in_.skip_empty_lines(comment);
      if (!in_.at_end()) leave("data behind End");
      return;
    }
    if (name.empty()) {
      if (!is_foreign) fail("a keyword", "something else");
      (void)in_.line();
      continue;
    }
    const auto* found = find(name);
    is_foreign = found == nullptr || (found->refused_type != 0);
    if (found == nullptr) {
      leave(shown_text(name));
      (void)in_.line();
      continue;
    }
    const auto n = in_.integer(std::string("the number of ") + std::string(name));
    if (n < 0) fail("a number of " + std::string(name), fmt::format("{}", n));
    take(*found, n);
    if (is_foreign) (void)in_.line();
  }
}

void Reader::read_binary(const Take& take, const std::function<void(const std::string& name)>& leave) {
  while (in_.remaining() > 0) {
    const auto code = value<std::int32_t>("a keyword");
    if (code == end) {
      if (in_.remaining() > sizeof(std::int64_t)) leave("data behind End");  // the place of a next keyword may follow
      return;
    }
    const auto begin = static_cast<std::int64_t>(in_.position());
    const auto next = position("the place of the next keyword");
    if (next != 0 && next <= begin) fail("a later place of the next keyword", fmt::format("byte {}", next));
    if (const auto* found = find(code); found != nullptr) {
      const auto n = count("a number of rows");
      if (n < 0) fail("a number of " + std::string(found->name), fmt::format("{}", n));
      take(*found, n);
    } else {
      leave(fmt::format("keyword {}", code));
    }
    if (next == 0) return;
    in_.go_to(static_cast<std::uint64_t>(next), "the place of the next keyword");
  }
}

}  // namespace pamr::io::gmf
