// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/tag_boundary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::assemble {

namespace {

/// A boundary face or a triangle at the rank where the two meet.
struct Meeting {
  par::SharedKey face;   ///< ascending
  int is_triangle = 0;   ///< faces of cells come first
  int is_inner = 0;      ///< of a face: it has cells on both sides
  int patch = 0;         ///< that it has; -1: none yet
  std::int64_t row = 0;  ///< of a face 4 cell + slot, of a triangle its row; on the rank that sent it
  Rank from = 0;         ///< that rank
};

/// The patch of a boundary face, on its way back.
struct Answer {
  std::int64_t row;
  int patch;
};

Rank meeting_rank(const par::Comm& comm, const par::SharedKey& face) {
  std::uint64_t h = 0;
  for (const auto node : face) h = combine(h, static_cast<std::uint64_t>(node));
  return static_cast<Rank>(h % static_cast<std::uint64_t>(comm.size()));
}

par::SharedKey sorted(par::SharedKey face) {
  std::sort(face.begin(), face.end());
  return face;
}

/// All faces and triangles of the ranks that meet here, those of the same nodes together. Collective.
std::vector<Meeting> meet(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::BoundaryTriangles& boundary,
                          bool has_patches, std::span<const mesh::CellFace> inner_faces) {
  par::Mailbox<Meeting> box(comm);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      const auto neighbor = mesh.cell_to_cell[at(c)][at(slot)];
      if (neighbor >= 0) continue;
      const auto face = mesh::face_key(mesh, {c, slot});
      const int patch = has_patches ? mesh::slot_to_patch(neighbor) : -1;
      box.add(meeting_rank(comm, face), {face, 0, 0, patch, 4 * std::int64_t{c} + slot, comm.rank()});
    }
  for (const auto& inner : inner_faces) {
    const auto face = mesh::face_key(mesh, inner);
    box.add(meeting_rank(comm, face), {face, 0, 1, -1, 4 * std::int64_t{inner.cell} + inner.slot, comm.rank()});
  }
  for (std::size_t t = 0; t < boundary.node.size(); ++t) {
    const auto face = sorted(boundary.node[t]);
    box.add(meeting_rank(comm, face), {face, 1, 0, boundary.patch[t], static_cast<std::int64_t>(t), comm.rank()});
  }
  auto meeting = box.send().item;
  std::sort(meeting.begin(), meeting.end(), [](const Meeting& a, const Meeting& b) {
    return std::tie(a.face, a.is_triangle, a.from, a.row) < std::tie(b.face, b.is_triangle, b.from, b.row);
  });
  return meeting;
}

/// A misfit as one number: the lowest of all ranks is that of the lowest rank, then of the lowest row.
std::int64_t to_number(const Meeting& triangle, bool is_on_boundary) {
  return (std::int64_t{triangle.from} << 32U | triangle.row) << 1U | (is_on_boundary ? 1 : 0);
}
BoundaryMatch::Misfit to_misfit(std::int64_t number) {
  return {static_cast<Rank>(number >> 33U), number >> 1U & 0xffffffff, (number & 1) != 0};
}

/// Throws what is wrong with a triangle. Collective.
[[noreturn]] void refuse(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::BoundaryTriangles& boundary,
                         const BoundaryMatch::Misfit& misfit) {
  const bool is_mine = comm.rank() == misfit.rank;
  const auto row = at(misfit.row);
  const auto nodes = comm.broadcast(
      is_mine ? std::vector<GlobalId>(boundary.node[row].begin(), boundary.node[row].end()) : std::vector<GlobalId>(),
      misfit.rank);
  const auto key = sorted({nodes[0], nodes[1], nodes[2]});
  constexpr auto none = std::numeric_limits<std::int64_t>::max();
  std::int64_t least = none, greatest = -1, patch = -1;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot)
      if (mesh::face_key(mesh, {c, slot}) == key) {
        const auto id = mesh.cell_global[at(c)];
        least = std::min(least, id);
        greatest = std::max(greatest, id);
        const auto neighbor = mesh.cell_to_cell[at(c)][at(slot)];
        if (neighbor < 0) patch = mesh::slot_to_patch(neighbor);
      }
  least = comm.min(least);
  greatest = comm.max(greatest);
  patch = comm.max(patch);
  const auto own_patch = comm.max(std::int64_t{is_mine ? boundary.patch[row] : -1});
  const auto where = fmt::format("boundary triangle {} of rank {}, nodes {} {} {}: expected ", misfit.row, misfit.rank,
                                 nodes[0], nodes[1], nodes[2]);
  if (misfit.is_on_boundary)
    throw Error(fmt::format("{}one patch for each face, found '{}' beside '{}'", where,
                            mesh.info.patches[at(own_patch)].name, mesh.info.patches[at(patch)].name));
  if (greatest < 0) throw Error(where + "a face of the boundary, found no cell with these nodes");
  throw Error(
      fmt::format("{}a face of the boundary, found one inside, between cells {} and {}", where, least, greatest));
}

}  // namespace

BoundaryMatch match_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& boundary,
                             std::optional<int> untagged, std::span<const mesh::CellFace> inner_faces) {
  const auto meeting = meet(comm, mesh, boundary, !untagged, inner_faces);
  BoundaryMatch match;
  match.n_inner.resize(mesh.info.patches.size());
  constexpr auto none = std::numeric_limits<std::int64_t>::max();
  std::int64_t first = none;
  par::Mailbox<Answer> answers(comm);
  for (std::size_t i = 0; i < meeting.size();) {
    std::size_t end = i;
    while (end < meeting.size() && meeting[end].face == meeting[i].face) ++end;
    if (meeting[i].is_inner != 0) {
      for (auto t = i + 1; t < end; ++t) ++match.n_inner[at(meeting[t].patch)];
      i = end;
      continue;
    }
    const bool has_face = meeting[i].is_triangle == 0;
    const auto first_triangle = i + (has_face ? 1 : 0);
    int patch = has_face ? meeting[i].patch : -1;
    bool is_contradicted = false;
    for (auto t = first_triangle; t < end; ++t) {
      if (has_face && patch < 0) patch = meeting[t].patch;
      const bool differs = has_face && meeting[t].patch != patch;
      is_contradicted = is_contradicted || differs;
      if (!has_face || differs) first = std::min(first, to_number(meeting[t], has_face));
    }
    if (!has_face) match.n_not_on_boundary += static_cast<std::int64_t>(end - i);
    match.n_contradictions += is_contradicted ? 1 : 0;
    match.n_untagged += has_face && first_triangle == end ? 1 : 0;
    if (has_face && untagged) answers.add(meeting[i].from, {meeting[i].row, patch < 0 ? *untagged : patch});
    i = end;
  }
  for (const auto& answer : answers.send().item)
    mesh.cell_to_cell[at(answer.row / 4)][at(answer.row % 4)] = mesh::patch_to_slot(answer.patch);
  std::array<std::int64_t, 3> sum{match.n_untagged, match.n_not_on_boundary, match.n_contradictions};
  comm.sum_in_place(sum);
  match.n_untagged = sum[0];
  match.n_not_on_boundary = sum[1];
  match.n_contradictions = sum[2];
  comm.sum_in_place(match.n_inner);
  first = comm.min(first);
  if (first != none) match.first_misfit = to_misfit(first);
  return match;
}

void tag_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& boundary) {
  auto& patches = mesh.info.patches;
  const auto rest =
      std::find_if(patches.begin(), patches.end(), [](const auto& patch) { return patch.name == "boundary"; });
  const auto untagged = static_cast<int>(rest - patches.begin());
  const auto match = match_boundary(comm, mesh, boundary, untagged);
  if (match.first_misfit) refuse(comm, mesh, boundary, *match.first_misfit);
  if (match.n_untagged > 0 && rest == patches.end()) patches.push_back({"boundary", "patch"});
}

void compare_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& boundary) {
  const auto match = match_boundary(comm, mesh, boundary, {});
  if (match.first_misfit) refuse(comm, mesh, boundary, *match.first_misfit);
}

}  // namespace pamr::assemble
