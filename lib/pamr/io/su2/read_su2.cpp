// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: SU2 documentation, "Mesh File".
#include "pamr/io/su2/read_su2.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "pamr/io/elements/first_line.hpp"
#include "pamr/io/elements/read_shares.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io {

namespace {

constexpr char comment = '%';
constexpr std::string_view of_ranks = "SEND_RECEIVE";

std::string_view trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// SU2 calls its elements as VTK does; our reader as Gmsh does.
int gmsh_type(const TextCursor& in, std::int64_t type) {
  constexpr std::array<std::int64_t, 8> of_su2{1, 3, 5, 9, 10, 12, 13, 14};
  const int known = element_type::of_vtk(type);
  if (std::find(of_su2.begin(), of_su2.end(), type) == of_su2.end())
    in.fail("an element type of SU2 (5 triangle, 10 tetrahedron)", fmt::format("{}", type));
  return known;
}

/// Reads a file from front to back.
class Su2Reader {
 public:
  Su2Reader(TextCursor& in, Share share) : in_(in), share_(share) { parts_.has_regions = false; }

  ElementParts read() {
    in_.skip_byte_order_mark();
    const auto first = in_;
    for (in_.skip_empty_lines(comment); !in_.at_end(); in_.skip_empty_lines(comment)) {
      const auto begin = in_;
      const auto line = in_.line();
      const auto equals = line.find('=');
      if (equals == std::string_view::npos) {
        in_ = begin;
        if (!is_foreign_) in_.fail("a keyword with =, as NELEM= 6", "a line without");
        (void)in_.line();
        continue;
      }
      const auto keyword = trimmed(line.substr(0, equals));
      auto value = begin;
      value.pass(equals + 1);
      take(keyword, value, trimmed(line.substr(equals + 1)));
    }
    if (!dimension_ && !has_cells_ && !has_nodes_)
      first.fail("a mesh of SU2 with NDIME=, NELEM= and NPOIN=", what_begins(first.rest()));
    if (!dimension_) in_.fail("NDIME=", "the end of the file");
    if (!has_cells_) in_.fail("NELEM=", "the end of the file");
    if (!has_nodes_) in_.fail("NPOIN=", "the end of the file");
    if (n_markers_ && *n_markers_ != n_found_)
      in_.fail(fmt::format("{} markers as NMARK says", *n_markers_), fmt::format("{}", n_found_));
    return std::move(parts_);
  }

 private:
  /// `value` stands behind the equals sign, the reader behind the line.
  void take(std::string_view keyword, TextCursor& value, std::string_view text) {
    is_foreign_ = false;
    if (keyword == "NDIME") {
      dimension_ = value.integer_in_line("the number of dimensions");
      if (*dimension_ != 3) value.fail("3 dimensions", fmt::format("{}", *dimension_));
    } else if (keyword == "NZONE") {
      const auto n = value.integer_in_line("the number of zones");
      if (n != 1) value.fail("one zone", fmt::format("{}", n));
    } else if (keyword == "NELEM") {
      if (std::exchange(has_cells_, true)) value.fail("NELEM= once", "it again");
      parts_.n_elements = read_elements(value, 0);
    } else if (keyword == "NPOIN") {
      if (std::exchange(has_nodes_, true)) value.fail("NPOIN= once", "it again");
      read_nodes(value);
    } else if (keyword == "NMARK") {
      n_markers_ = value.integer_in_line("the number of markers");
    } else if (keyword == "MARKER_TAG") {
      if (text.empty()) value.fail("the name of a marker", "none");
      tag_ = std::string(text);
      for (const auto& [number, name] : parts_.group_name)
        if (name == tag_ && tag_ != of_ranks) value.fail("different names of markers", "\"" + tag_ + "\" twice");
    } else if (keyword == "MARKER_ELEMS") {
      if (tag_.empty()) value.fail("MARKER_TAG= before MARKER_ELEMS=", "none");
      ++n_found_;
      if (tag_ != of_ranks)
        parts_.group_name[{2, n_found_}] = tag_;
      else if (in_.rest().starts_with("SEND_TO"))
        (void)in_.line();
      if (read_elements(value, tag_ == of_ranks ? 0 : n_found_) > 0 && tag_ == of_ranks)
        ++parts_.left_out["SEND_RECEIVE markers, which join parts of a mesh"];
      tag_.clear();
    } else if (keyword == "NPERIODIC") {
      const auto n = value.integer_in_line("the number of periodic links");
      if (n > 1) in_.fail("no periodic links", fmt::format("{}", n));  // one is what SU2 writes where there is none
    } else {
      is_foreign_ = true;
      // SU2 itself writes the latter where nothing is periodic
      if (keyword != "IZONE" && !keyword.starts_with("PERIODIC_")) leave(keyword);
    }
  }

  /// Counts a keyword that is none of a mesh: boxes of free-form deformation, angles of attack, ... A line of a title with
  /// a sign of equality has no keyword before it.
  void leave(std::string_view keyword) {
    const auto is_of_keyword = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'; };
    if (!std::all_of(keyword.begin(), keyword.end(), is_of_keyword)) return;
    constexpr std::size_t most = 20;
    const auto name = shown_text(keyword);
    ++parts_.left_out[parts_.left_out.size() < most || parts_.left_out.contains(name) ? name : "other keywords"];
  }

  std::int64_t read_elements(TextCursor& value, std::int64_t marker) {
    const auto n = in_.checked_count(value.integer_in_line("a number of elements"), 4, "elements");
    const auto own = share_.of(n);
    in_.skip_lines(own.begin, "an element");
    for (auto i = own.begin; i < own.end; ++i) {
      const int type = gmsh_type(in_, in_.integer_in_line("the type of an element"));
      std::array<std::int64_t, max_nodes> nodes{};
      for (int k = 0; k < n_nodes_of_type(type); ++k) {
        const auto node = in_.integer_in_line("a node of an element");
        if (k < std::ssize(nodes)) nodes[static_cast<std::size_t>(k)] = node;
      }
      for (int k = 0; k < 2 && !in_.is_line_over(comment); ++k) (void)in_.integer_in_line("the number of an element");
      if (!in_.is_line_over(comment)) in_.fail("the end of the line after an element", "more numbers");
      if (type == element_type::prism) turn_prism_of_vtk(nodes);
      if (marker > 0 ? element_type::is_cell(type) : element_type::is_face(type))
        in_.fail(marker > 0 ? "triangles in a marker" : "tetrahedra among the elements", name_of(type));
      if (type == element_type::point || type == element_type::line)
        ++parts_.n_in_group[{type == element_type::line ? 1 : 0, 0}];
      keep_element(parts_, type, nodes, marker);
      (void)in_.line();
    }
    in_.skip_lines(n - own.end, "an element");
    return n;
  }

  static const char* name_of(int type) {
    return type == element_type::triangle     ? "a triangle"
           : type == element_type::quadrangle ? "a quadrangle"
           : type == element_type::prism      ? "a prism"
           : type == element_type::pyramid    ? "a pyramid"
                                              : "a tetrahedron";
  }

  void read_nodes(TextCursor& value) {
    parts_.n_nodes = in_.checked_count(value.integer_in_line("the number of points"), 6, "points");
    if (!value.is_line_over(comment))
      if (const auto n_own = value.integer_in_line("the number of points without those of other parts");
          n_own != parts_.n_nodes)
        value.fail(fmt::format("a mesh in one part with {} points of its own", parts_.n_nodes),
                   fmt::format("{}: the others are those of other parts", n_own));
    const auto own = share_.of(parts_.n_nodes);
    in_.skip_lines(own.begin, "a point");
    for (auto i = own.begin; i < own.end; ++i) {
      const double x = in_.real_in_line("x"), y = in_.real_in_line("y"), z = in_.real_in_line("z");
      for (int k = 0; k < 2 && !in_.is_line_over(comment); ++k) (void)in_.integer_in_line("the number of a point");
      if (!in_.is_line_over(comment)) in_.fail("the end of the line after a point", "more numbers");
      parts_.node_tag.push_back(i);
      parts_.position.push_back({x, y, z});
      (void)in_.line();
    }
    in_.skip_lines(parts_.n_nodes - own.end, "a point");
  }

  TextCursor& in_;
  Share share_;
  ElementParts parts_;
  std::optional<std::int64_t> dimension_, n_markers_;
  bool has_cells_ = false, has_nodes_ = false;
  bool is_foreign_ = true;  ///< within what is no part of the mesh: in lines of a title, at first
  std::int64_t n_found_ = 0;
  std::string tag_;
};

}  // namespace

ElementMesh read_su2(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options) {
  auto parts = read_shares(
      comm, file, [](TextCursor&) { return true; },
      [](TextCursor& in, Share share) { return Su2Reader(in, share).read(); });
  for (const int dimension : {0, 1})
    if (const auto n = comm.sum(parts.n_in_group[{dimension, 0}]); n > 0)
      parts.left_out[dimension == 0 ? "points" : "lines"] = n;
  parts.n_in_group.clear();
  const auto names = parts.group_name;
  return mesh_of_elements(comm, std::move(parts), source_of(file), options, [&](std::int64_t marker) {
    return mesh::Patch{names.at({2, marker}), ""};
  });
}

}  // namespace pamr::io
