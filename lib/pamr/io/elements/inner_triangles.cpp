// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/inner_triangles.hpp"

#include <algorithm>
#include <set>
#include <tuple>

#include "pamr/assemble/tag_boundary.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::io {

namespace {

/// One side of an inner face, or a triangle, at the rank where those of the same nodes meet.
struct Side {
  par::SharedKey face;      ///< ascending
  int is_triangle = 0;      ///< faces of cells come first
  std::int64_t region = 0;  ///< of the cell
  std::int64_t row = 0;     ///< of the triangle on the rank that sent it
  Rank from = 0;            ///< that rank
};

/// Both sides of all inner faces and all triangles, those of the same nodes together. Collective.
std::vector<Side> meet(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<std::int64_t>& region,
                       const mesh::BoundaryTriangles& boundary) {
  par::Mailbox<Side> box(comm);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      if (mesh.cell_to_cell[at(c)][at(slot)] < 0) continue;
      const auto face = mesh::face_key(mesh, {c, slot});
      box.add(assemble::meeting_rank(comm, face), {face, 0, region[at(c)], 0, comm.rank()});
    }
  for (std::size_t t = 0; t < boundary.node.size(); ++t) {
    auto face = boundary.node[t];
    std::sort(face.begin(), face.end());
    box.add(assemble::meeting_rank(comm, face), {face, 1, 0, static_cast<std::int64_t>(t), comm.rank()});
  }
  auto sides = box.send().item;
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.face, a.is_triangle, a.from, a.row) < std::tie(b.face, b.is_triangle, b.from, b.row);
  });
  return sides;
}

}  // namespace

std::vector<std::int64_t> take_out_inner_triangles(const par::Comm& comm, const mesh::DistMesh& mesh,
                                                   mesh::BoundaryTriangles& boundary, std::size_t n_groups) {
  std::vector<std::int64_t> taken(n_groups, 0);
  const auto* field = mesh.find_cell_field(mesh::region_field);
  if (field == nullptr || !field->holds_integers() || field->n_components != 1) return taken;
  const auto sides = meet(comm, mesh, field->integer(), boundary);
  par::Mailbox<std::int64_t> rows(comm);
  for (std::size_t i = 0; i < sides.size();) {
    auto end = i + 1;
    while (end < sides.size() && sides[end].face == sides[i].face) ++end;
    const bool is_between = end - i > 2 && sides[i + 1].is_triangle == 0 && sides[i].region != sides[i + 1].region;
    for (auto t = i + 2; is_between && t < end; ++t) rows.add(sides[t].from, sides[t].row);
    i = end;
  }
  const auto received = rows.send();
  const std::set<std::int64_t> mine(received.item.begin(), received.item.end());
  std::size_t n = 0;
  for (std::size_t t = 0; t < boundary.node.size(); ++t) {
    if (mine.count(static_cast<std::int64_t>(t)) != 0) {
      ++taken[at(boundary.patch[t])];
      continue;
    }
    boundary.node[n] = boundary.node[t];
    boundary.patch[n++] = boundary.patch[t];
  }
  boundary.node.resize(n);
  boundary.patch.resize(n);
  for (auto& number : taken) number = comm.sum(number);
  return taken;
}

}  // namespace pamr::io
