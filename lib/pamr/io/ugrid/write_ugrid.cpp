// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/ugrid/write_ugrid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/io/elements/boundary_rows.hpp"
#include "pamr/io/elements/numbers.hpp"
#include "pamr/io/rows_in_order.hpp"
#include "pamr/io/shared_output.hpp"
#include "pamr/io/ugrid/mapbc.hpp"
#include "pamr/io/ugrid/ugrid_layout.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::io {

namespace {

/// The axis along which a patch has no extent, -1 for none. Collective.
std::vector<int> flat_axes(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::vector<geometry::Box> boxes(mesh.info.patches.size());
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const auto neighbor = mesh.cell_to_cell[at(c)][slot];
      if (neighbor >= 0) continue;
      auto& box = boxes[at(mesh::slot_to_patch(neighbor))];
      for (const auto corner : mesh::tet::face_to_corner[slot])
        box.extend(mesh.point(mesh.cell_to_node[at(c)][at(corner)]));
    }
  std::vector<int> axes;
  for (const auto& here : boxes) {
    const auto box = mesh::box_over_ranks(comm, here);
    int axis = -1;
    for (std::size_t k = 3; k-- > 0;)
      if (box.low[k] == box.high[k]) axis = static_cast<int>(k);
    axes.push_back(axis);
  }
  return axes;
}

}  // namespace

std::filesystem::path mapbc_file(const std::filesystem::path& file) { return ugrid::mapbc_of(file); }

void write_ugrid(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                 const Remark& remark) {
  const bool swap = ugrid::is_big_endian(file);
  const auto rows = rows_in_order(comm, mesh);
  const auto boundary = boundary_rows(rows);
  const auto number = patch_numbers(rows.group_name, "surface_", 1, rows.patch_number);
  const auto axes = flat_axes(comm, mesh);
  std::vector<std::int64_t> n_faces(rows.group_name.size(), 0);
  for (const auto& face : boundary) ++n_faces[at(face.patch)];
  comm.sum_in_place(n_faces);
  const auto n_triangles = comm.sum(std::ssize(boundary));
  const auto most = std::max({rows.n_nodes, n_triangles, mesh.info.n_global_cells});
  if (most > std::numeric_limits<std::int32_t>::max())
    throw Error(fmt::format("UGRID: expected at most 2^31 - 1 nodes, triangles and cells, found {}", most));

  SharedOutput out(comm, file);
  std::string bytes;
  const auto integer = [&](std::int64_t value) { append_bytes(bytes, static_cast<std::int32_t>(value), swap); };
  const auto flush = [&] {
    out.append(bytes);
    bytes.clear();
  };
  for (const auto count :
       {rows.n_nodes, n_triangles, GlobalId{0}, mesh.info.n_global_cells, GlobalId{0}, GlobalId{0}, GlobalId{0}})
    integer(count);
  out.append_once(bytes);
  bytes.clear();
  for (const auto p : rows.position)
    for (const auto x : {p.x, p.y, p.z}) append_bytes(bytes, x, swap);
  flush();
  for (const auto& face : boundary)
    for (const std::size_t k : {0, 2, 1}) integer(face.node[k] + 1);
  flush();
  for (const auto& face : boundary) integer(number[at(face.patch)]);
  flush();
  for (const auto& cell : rows.cell_to_node)
    for (const auto node : cell) integer(node + 1);
  flush();
  SharedOutput conditions(comm, ugrid::mapbc_of(file));
  conditions.append_once(ugrid::mapbc_text(mesh.info, number, axes, n_faces, remark));
  out.commit();
  conditions.commit();
}

}  // namespace pamr::io
