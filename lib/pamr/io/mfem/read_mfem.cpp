// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: mfem.org, "Mesh Formats".
#include "pamr/io/mfem/read_mfem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/base/byte_order_mark.hpp"
#include "pamr/io/elements/cut_elements.hpp"
#include "pamr/io/elements/first_line.hpp"
#include "pamr/io/elements/text_cursor.hpp"
#include "pamr/io/elements/whole_mesh.hpp"
#include "pamr/io/text.hpp"

namespace pamr::io {

namespace mfem {

namespace {

constexpr char comment = '#';
constexpr std::string_view first_words = "MFEM mesh v1.";

/// Shapes of elements by MFEM's numbers, as types of Gmsh.
constexpr std::array<int, 8> type_of_shape{
    element_type::point,       element_type::line,       element_type::triangle, element_type::quadrangle,
    element_type::tetrahedron, element_type::hexahedron, element_type::prism,    element_type::pyramid};

/// Reads a file from front to back.
class MfemReader {
 public:
  explicit MfemReader(TextCursor& in) : in_(in) {}

  WholeMesh read() {
    in_.skip_byte_order_mark();
    const auto begin = in_;
    const auto line = in_.line();
    if (!line.starts_with(first_words)) begin.fail("\"MFEM mesh v1.0\"", what_begins(begin.rest()));
    for (in_.skip_empty_lines(comment); !in_.at_end(); in_.skip_empty_lines(comment)) {
      const auto place = in_;
      const auto keyword = in_.keyword();
      (void)in_.line();
      if (keyword == "mfem_mesh_end") {
        in_.skip_empty_lines(comment);
        if (!in_.at_end()) ++mesh_.left_out["data behind mfem_mesh_end"];
        break;
      }
      if (!take(keyword))
        place.fail("dimension, elements, boundary, vertices, nodes or sets of attributes",
                   fmt::format("\"{}\"", keyword.substr(0, 40)));
    }
    if (!has_points_) in_.fail("vertices or nodes with coordinates", "the end of the file");
    name(boundary_sets_, [&](std::int64_t tag, const std::string& text) {
      mesh_.patch_of_tag[tag] = {.name = text, .kind = "", .number = std::max<std::int64_t>(tag, -1)};
    });
    name(element_sets_, [&](std::int64_t tag, const std::string& text) { mesh_.name_of_region[tag] = text; });
    return std::move(mesh_);
  }

 private:
  using Sets = std::map<std::int64_t, std::vector<std::string>>;  ///< names by attribute, of sets of one

  bool take(std::string_view keyword) {
    in_.skip_empty_lines(comment);
    if (keyword == "dimension") {
      if (const auto n = in_.integer("the dimension"); n != 3) in_.fail("3 dimensions", fmt::format("{}", n));
    } else if (keyword == "elements") {
      read_elements(false);
    } else if (keyword == "boundary") {
      read_elements(true);
    } else if (keyword == "attribute_sets") {
      read_sets(element_sets_);
    } else if (keyword == "bdr_attribute_sets") {
      read_sets(boundary_sets_);
    } else if (keyword == "vertices") {
      read_vertices();
    } else if (keyword == "nodes") {
      read_nodes();
    } else {
      return false;
    }
    return true;
  }

  std::int64_t count(std::string_view what) {
    return in_.checked_count(in_.integer(fmt::format("the number of {}", what)), 2, what);
  }

  void read_elements(bool of_boundary) {
    const auto n = count("elements");
    for (std::int64_t i = 0; i < n; ++i) {
      in_.skip_empty_lines(comment);
      const auto attribute = in_.integer("the attribute of an element");
      const auto shape = in_.integer("the shape of an element");
      if (shape < 0 || shape >= std::ssize(type_of_shape)) in_.fail("a shape from 0 to 7", fmt::format("{}", shape));
      const int type = type_of_shape[static_cast<std::size_t>(shape)];
      std::array<std::int64_t, 8> nodes{};
      for (int k = 0; k < n_nodes_of_type(type); ++k)
        nodes[static_cast<std::size_t>(k)] = in_.integer("a vertex of an element");
      if (type == element_type::tetrahedron && !of_boundary) {
        mesh_.cell.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
        mesh_.region.push_back(attribute);
      } else if (type == element_type::triangle && of_boundary) {
        mesh_.triangle.push_back({nodes[0], nodes[1], nodes[2]});
        mesh_.tag.push_back(attribute);
      } else if (is_cut(type) && of_boundary == (type == element_type::quadrangle)) {
        ++mesh_.cut[type];
        for (const auto& cell : tetrahedra_of(type, nodes)) {
          mesh_.cell.push_back(cell);
          mesh_.region.push_back(attribute);
        }
        for (const auto& triangle : triangles_of(type, nodes)) {
          mesh_.triangle.push_back(triangle);
          mesh_.tag.push_back(attribute);
        }
      } else {
        ++mesh_.refused[type];
      }
    }
  }

  /// Names in quotes, each with the number of its attributes and these.
  void read_sets(Sets& sets) {
    const auto n = count("sets");
    for (std::int64_t i = 0; i < n; ++i) {
      in_.skip_empty_lines(comment);
      auto line = in_;
      const auto text = in_.line();
      const auto begin = text.find('"'), end = text.rfind('"');
      if (begin == std::string_view::npos || end == begin) line.fail("a name in double quotes", "none");
      line.pass(end + 1);
      const std::string set(text.substr(begin + 1, end - begin - 1));
      if (const auto n_attributes = line.integer_in_line("the number of attributes"); n_attributes == 1)
        sets[line.integer_in_line("an attribute")].push_back(set);
      else
        mesh_.remarks.push_back(
            fmt::format("the set '{}' of {} attributes was left out", shown_text(set), n_attributes));
    }
  }

  /// An attribute has one name.
  template <class Take>
  void name(const Sets& sets, Take&& take) {
    for (const auto& [attribute, names] : sets) {
      take(attribute, names.front());
      for (std::size_t i = 1; i < names.size(); ++i)
        mesh_.remarks.push_back(fmt::format("the set '{}' was left out: attribute {} is '{}'", shown_text(names[i]),
                                            attribute, shown_text(names.front())));
    }
  }

  void read_vertices() {
    const auto n = count("vertices");
    mesh_.point.resize(static_cast<std::size_t>(n));
    in_.skip_empty_lines(comment);
    if (in_.at_end() || std::isdigit(static_cast<unsigned char>(in_.rest().front())) == 0) return;  // `nodes` follow
    if (const auto width = in_.integer("the dimension of space"); width != 3)
      in_.fail("coordinates in 3 dimensions", fmt::format("{}", width));
    for (auto& p : mesh_.point)
      for (std::size_t k = 0; k < 3; ++k) p[k] = in_.real("a coordinate");
    has_points_ = true;
  }

  /// Coordinates as a function of finite elements: of first order they are those of the vertices.
  void read_nodes() {
    bool by_vertex = false;
    for (in_.skip_empty_lines(comment);; in_.skip_empty_lines(comment)) {
      const auto place = in_;
      const auto line = in_.line();
      const auto value = line.substr(std::min(line.find(':'), line.size() - 1) + 1);
      if (line.starts_with("FiniteElementCollection:")) {
        if (value != " H1_3D_P1" && value != " Linear")
          place.fail("nodes of first order (H1_3D_P1)", fmt::format("those of{}", value.substr(0, 40)));
      } else if (line.starts_with("VDim:")) {
        if (value != " 3") place.fail("VDim: 3", "another");
      } else if (line.starts_with("Ordering:")) {
        by_vertex = value == " 1";
        break;
      } else if (line != "FiniteElementSpace") {
        place.fail("the head of a FiniteElementSpace", "another line");
      }
    }
    for (std::size_t outer = 0, n = mesh_.point.size(); outer < (by_vertex ? n : 3); ++outer)
      for (std::size_t inner = 0; inner < (by_vertex ? 3 : n); ++inner)
        (by_vertex ? mesh_.point[outer][inner] : mesh_.point[inner][outer]) = in_.real("a coordinate");
    has_points_ = true;
  }

  TextCursor& in_;
  WholeMesh mesh_;
  Sets element_sets_, boundary_sets_;
  bool has_points_ = false;
};

}  // namespace

}  // namespace mfem

bool is_mfem(const par::Comm& comm, const std::filesystem::path& file) {
  std::string begin(8, '\0');
  if (comm.is_first()) std::ifstream(file, std::ios::binary).read(begin.data(), 8);
  return comm.any(begin.starts_with("MFEM") || begin == std::string(byte_order_mark) + "MFEM ");
}

ElementMesh read_mfem(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options) {
  return mesh_of_whole(comm, file, options, [&] {
    const MappedFile mapped(file);
    TextCursor in(mapped.bytes(), file.string());
    return mfem::MfemReader(in).read();
  });
}

}  // namespace pamr::io
