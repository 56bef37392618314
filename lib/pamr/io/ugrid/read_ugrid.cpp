// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the format: see `ugrid_layout.hpp`.
#include "pamr/io/ugrid/read_ugrid.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/io/elements/numbers.hpp"
#include "pamr/io/elements/read_shares.hpp"
#include "pamr/io/ugrid/mapbc.hpp"
#include "pamr/io/ugrid/ugrid_layout.hpp"

namespace pamr::io {

namespace ugrid {

namespace {

class UgridReader {
 public:
  UgridReader(TextCursor& in, Share share, bool big_endian) : in_(in), share_(share), swap_(big_endian) {
    in_.set_binary(true);
    parts_.has_regions = false;
  }

  ElementParts read() {
    read_head();
    const auto layout = layout_of(n_);
    if (static_cast<std::int64_t>(in_.remaining()) < layout.bytes - Layout::head)
      in_.fail(fmt::format("a file of {} bytes, as its head says", layout.bytes),
               fmt::format("{}", Layout::head + static_cast<std::int64_t>(in_.remaining())));
    if (const auto more = static_cast<std::int64_t>(in_.remaining()) - (layout.bytes - Layout::head); more > 0)
      parts_.left_out["bytes behind the last array"] = more;
    read_nodes();
    read_faces(layout);
    read_cells(layout);
    return std::move(parts_);
  }

 private:
  std::int64_t integer(std::string_view what) {
    const auto value = in_.value<std::int32_t>(what);
    return swap_ ? byteswapped(value) : value;
  }
  double real(std::string_view what) {
    const auto raw = in_.value<double>(what), value = swap_ ? byteswapped(raw) : raw;
    if (!std::isfinite(value)) in_.fail("coordinates that are finite", "another");
    return value;
  }
  void rows(std::int64_t begin, par::BlockRange own, std::int64_t row_bytes) {
    in_.go_to(static_cast<std::uint64_t>(begin + own.begin * row_bytes), "rows");
  }

  using Nodes = std::array<std::int64_t, max_nodes>;
  Nodes nodes_of(int type) {
    Nodes nodes{};
    for (int k = 0; k < n_nodes_of_type(type); ++k)
      nodes[static_cast<std::size_t>(k)] = integer("a node of an element");
    return nodes;
  }

  void read_faces(const Layout& layout) {
    const auto own = share_.of(n_.triangles), own_quadrangles = share_.of(n_.quadrangles);
    parts_.triangle.resize(static_cast<std::size_t>(own.count()));
    rows(layout.triangles, own, 12);
    for (auto& triangle : parts_.triangle)
      for (auto& node : triangle.node) node = integer("a node of a triangle");
    std::vector<Nodes> quadrangles;
    rows(layout.quadrangles, own_quadrangles, 16);
    for (auto i = own_quadrangles.begin; i < own_quadrangles.end; ++i)
      quadrangles.push_back(nodes_of(element_type::quadrangle));
    rows(layout.references, own, 4);
    for (auto& triangle : parts_.triangle) triangle.group = integer("the surface of a triangle");
    rows(layout.references + 4 * n_.triangles, own_quadrangles, 4);
    for (const auto& nodes : quadrangles)
      keep_element(parts_, element_type::quadrangle, nodes, integer("the surface of a quadrangle"));
  }

  /// The apex of UGRID's pyramid is in the third place; the others are seen counter-clockwise from there as 2, 1, 4, 5.
  void read_cells(const Layout& layout) {
    const auto own = share_.of(n_.tetrahedra), pyramids = share_.of(n_.pyramids), prisms = share_.of(n_.prisms);
    parts_.tetrahedron.resize(static_cast<std::size_t>(own.count()));
    rows(layout.tetrahedra, own, 16);
    for (auto& cell : parts_.tetrahedron)
      for (auto& node : cell.node) node = integer("a node of a tetrahedron");
    rows(layout.pyramids, pyramids, 20);
    for (auto i = pyramids.begin; i < pyramids.end; ++i) {
      const auto [a, b, apex, c, d, none] = nodes_of(element_type::pyramid);
      keep_element(parts_, element_type::pyramid, Nodes{b, a, c, d, apex, none}, 0);
    }
    rows(layout.prisms, prisms, 24);
    for (auto i = prisms.begin; i < prisms.end; ++i)
      keep_element(parts_, element_type::prism, nodes_of(element_type::prism), 0);
  }

  void read_head() {
    for (auto* count :
         {&n_.nodes, &n_.triangles, &n_.quadrangles, &n_.tetrahedra, &n_.pyramids, &n_.prisms, &n_.hexahedra}) {
      *count = integer("the head of seven numbers");
      if (*count < 0)
        in_.fail(fmt::format("numbers in the head that are not negative, in the order of bytes that the name says ({})",
                             swap_ ? "b8: greatest first" : "lb8: least first"),
                 fmt::format("{}", *count));
    }
    parts_.n_nodes = n_.nodes;
    parts_.n_elements = n_.tetrahedra;
    if (share_.rank == 0 && n_.hexahedra > 0) parts_.refused[element_type::hexahedron] = n_.hexahedra;
  }

  void read_nodes() {
    const auto own = share_.of(n_.nodes);
    rows(Layout::head, own, 24);
    for (auto i = own.begin; i < own.end; ++i) {
      const double x = real("x"), y = real("y"), z = real("z");
      parts_.node_tag.push_back(i + 1);
      parts_.position.push_back({x, y, z});
    }
  }

  TextCursor& in_;
  Share share_;
  bool swap_;
  Counts n_;
  ElementParts parts_;
};

}  // namespace

}  // namespace ugrid

ElementMesh read_ugrid(const par::Comm& comm, const std::filesystem::path& file, const ElementOptions& options) {
  bool big_endian = false;
  par::agree(comm, [&] { big_endian = ugrid::is_big_endian(file); });
  const auto mapbc = ugrid::mapbc_of(file);
  const auto conditions = ugrid::read_mapbc(comm, mapbc);
  const auto& named = conditions.patches;
  auto parts = read_shares(
      comm, file, [](TextCursor&) { return false; },
      [&](TextCursor& in, Share share) { return ugrid::UgridReader(in, share, big_endian).read(); });
  auto read = mesh_of_elements(comm, std::move(parts), source_of(file), options, [&](std::int64_t surface) {
    const auto found = named.find(surface);
    auto patch = found != named.end() ? found->second : mesh::Patch{fmt::format("surface_{}", surface), ""};
    patch.number = surface;
    return patch;
  });
  for (auto& remark : ugrid::remarks_of(conditions, mapbc, read.mesh.info)) read.remarks.push_back(std::move(remark));
  return read;
}

}  // namespace pamr::io
