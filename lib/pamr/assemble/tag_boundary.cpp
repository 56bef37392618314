// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/tag_boundary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/face_groups.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/gather_few.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::assemble {

namespace {

/// A face or a triangle at the rank where the two meet.
struct Meeting {
  par::SharedKey face;   ///< ascending
  int is_triangle = 0;   ///< faces of cells come first
  int patch = 0;         ///< that it has; -1: none yet
  std::int64_t row = 0;  ///< of a face 4 cell + slot, of a triangle its row; on the rank that sent it
  Rank from = 0;         ///< that rank
};

/// The patch of a face, on its way back.
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

void sort(std::vector<Meeting>& meeting) {
  std::sort(meeting.begin(), meeting.end(), [](const Meeting& a, const Meeting& b) {
    return std::tie(a.face, a.is_triangle, a.from, a.row) < std::tie(b.face, b.is_triangle, b.from, b.row);
  });
}

/// The end of the entries with the same face as that of `begin`.
std::size_t end_of_face(const std::vector<Meeting>& meeting, std::size_t begin) {
  std::size_t end = begin;
  while (end < meeting.size() && meeting[end].face == meeting[begin].face) ++end;
  return end;
}

/// All boundary faces and triangles of the ranks that meet here, those of the same nodes together. Collective.
std::vector<Meeting> meet(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::BoundaryTriangles& triangles,
                          bool has_patches) {
  par::Mailbox<Meeting> box(comm);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      const auto neighbor = mesh.cell_to_cell[at(c)][at(slot)];
      if (neighbor >= 0) continue;
      const auto face = mesh::face_key(mesh, {c, slot});
      const int patch = has_patches ? mesh::slot_to_patch(neighbor) : -1;
      box.add(meeting_rank(comm, face), {face, 0, patch, 4 * std::int64_t{c} + slot, comm.rank()});
    }
  for (std::size_t t = 0; t < triangles.node.size(); ++t) {
    const auto face = sorted(triangles.node[t]);
    box.add(meeting_rank(comm, face), {face, 1, triangles.patch[t], static_cast<std::int64_t>(t), comm.rank()});
  }
  auto meeting = box.send().item;
  sort(meeting);
  return meeting;
}

/// The triangles, which are no faces of the boundary, with the faces inside that they are, seen from both sides: only
/// faces of which all nodes are nodes of such triangles are looked at. Collective.
std::vector<Meeting> meet_inside(const par::Comm& comm, const mesh::DistMesh& mesh, std::vector<Meeting> triangles) {
  std::vector<GlobalId> node;
  for (const auto& triangle : triangles)
    for (const auto one : triangle.face)
      if (mesh.info.node_ids().contains(one)) node.push_back(one);
  const auto is_there =
      par::scatter_rows<std::uint8_t>(comm, mesh.info.node_ids(), std::vector<std::uint8_t>(node.size(), 1), 1, node);
  const auto is_of_one = par::fetch_rows<std::uint8_t>(comm, mesh.info.node_ids(), is_there, 1, mesh.node_global);
  const mesh::InnerPatches inner(mesh);
  par::Mailbox<Meeting> box(comm);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      if (mesh.cell_to_cell[at(c)][at(slot)] < 0) continue;
      const auto& corner = mesh::tet::face_to_corner[at(slot)];
      if (!std::all_of(corner.begin(), corner.end(),
                       [&](int k) { return is_of_one[at(mesh.cell_to_node[at(c)][at(k)])] != 0; }))
        continue;
      const auto face = mesh::face_key(mesh, {c, slot});
      box.add(meeting_rank(comm, face), {face, 0, inner.of({c, slot}), 4 * std::int64_t{c} + slot, comm.rank()});
    }
  const auto faces = box.send().item;
  triangles.insert(triangles.end(), faces.begin(), faces.end());
  sort(triangles);
  return triangles;
}

/// A misfit as one number: the lowest of all ranks is that of the lowest rank, then of the lowest row.
std::int64_t to_number(const Meeting& triangle, bool is_on_face) {
  return (std::int64_t{triangle.from} << 32U | triangle.row) << 1U | (is_on_face ? 1 : 0);
}
BoundaryMatch::Misfit to_misfit(std::int64_t number) {
  return {static_cast<Rank>(number >> 33U), number >> 1U & 0xffffffff, (number & 1) != 0};
}

/// Throws what is wrong with a triangle. Collective.
[[noreturn]] void refuse(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::BoundaryTriangles& triangles,
                         const BoundaryMatch::Misfit& misfit) {
  const bool is_mine = comm.rank() == misfit.rank;
  const auto row = at(misfit.row);
  const auto nodes = comm.broadcast(
      is_mine ? std::vector<GlobalId>(triangles.node[row].begin(), triangles.node[row].end()) : std::vector<GlobalId>(),
      misfit.rank);
  const auto key = sorted({nodes[0], nodes[1], nodes[2]});
  const mesh::InnerPatches patches(mesh);
  std::int64_t patch = -1;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot)
      if (mesh::face_key(mesh, {c, slot}) == key) patch = patches.of_any({c, slot});
  patch = comm.max(patch);
  const auto own_patch = comm.max(std::int64_t{is_mine ? triangles.patch[row] : -1});
  const auto where = fmt::format("triangle {} of rank {}, nodes {} {} {}: expected ", misfit.row, misfit.rank, nodes[0],
                                 nodes[1], nodes[2]);
  if (misfit.is_on_face)
    throw Error(fmt::format("{}one patch for each face, found '{}' beside '{}'", where,
                            mesh.info.patches[at(own_patch)].name, mesh.info.patches[at(patch)].name));
  throw Error(where + "a face of a cell, found no cell with these nodes");
}

/// Result of matching the faces and triangles on this rank.
struct Outcome {
  BoundaryMatch match;
  std::int64_t first = std::numeric_limits<std::int64_t>::max();  ///< triangle that cannot be used, as a number
  std::vector<Meeting> apart;                                     ///< triangles without a face

  /// The patch of the face that `meeting[begin .. end)` are, -1 without triangle and where it had none; notes what
  /// contradicts. `n_faces`: of them, which come first.
  int patch_of(const std::vector<Meeting>& meeting, std::size_t begin, std::size_t n_faces, std::size_t end) {
    int patch = meeting[begin].patch;
    bool is_contradicted = false;
    for (auto t = begin + n_faces; t < end; ++t) {
      if (patch < 0) patch = meeting[t].patch;
      if (meeting[t].patch == patch) continue;
      is_contradicted = true;
      first = std::min(first, to_number(meeting[t], true));
    }
    match.n_contradictions += is_contradicted ? 1 : 0;
    return patch;
  }
};

/// Matches boundary faces with triangles; other triangles are put into `outcome.apart`. Local.
void match_outside(const std::vector<Meeting>& meeting, std::optional<int> untagged, Outcome& outcome,
                   par::Mailbox<Answer>& answers) {
  for (std::size_t i = 0, end = 0; i < meeting.size(); i = end) {
    end = end_of_face(meeting, i);
    if (meeting[i].is_triangle != 0) {
      outcome.apart.insert(outcome.apart.end(), meeting.begin() + static_cast<std::ptrdiff_t>(i),
                           meeting.begin() + static_cast<std::ptrdiff_t>(end));
      continue;
    }
    const int patch = outcome.patch_of(meeting, i, 1, end);
    outcome.match.n_untagged += i + 1 == end ? 1 : 0;
    if (untagged) answers.add(meeting[i].from, {meeting[i].row, patch < 0 ? *untagged : patch});
  }
}

/// Matches inner faces with triangles; both cells at a face get the answer. Local.
void match_inside(const std::vector<Meeting>& meeting, Outcome& outcome, par::Mailbox<Answer>& answers) {
  for (std::size_t i = 0, end = 0; i < meeting.size(); i = end) {
    end = end_of_face(meeting, i);
    std::size_t n_faces = 0;
    while (i + n_faces < end && meeting[i + n_faces].is_triangle == 0) ++n_faces;
    if (n_faces == end - i) continue;
    if (n_faces == 0) {
      outcome.match.n_apart += static_cast<std::int64_t>(end - i);
      for (auto t = i; t < end; ++t) outcome.first = std::min(outcome.first, to_number(meeting[t], false));
      continue;
    }
    const bool is_known = meeting[i].patch >= 0;
    std::set<int> claimed;
    for (auto t = i + n_faces; t < end; ++t) claimed.insert(meeting[t].patch);
    const int patch = is_known ? outcome.patch_of(meeting, i, n_faces, end) : *claimed.begin();
    ++outcome.match.n_inner[at(patch)];
    for (const int other : claimed)
      if (!is_known && other != patch) ++outcome.match.in_two_patches[{patch, other}];
    for (auto f = i; f < i + n_faces; ++f) answers.add(meeting[f].from, {meeting[f].row, patch});
  }
}

/// Collective.
void sum_pairs(const par::Comm& comm, std::map<std::pair<int, int>, std::int64_t>& pairs) {
  struct Count {
    int kept, other;
    std::int64_t n;
  };
  std::vector<Count> here;
  for (const auto& [pair, n] : pairs) here.push_back({pair.first, pair.second, n});
  pairs.clear();
  for (const auto& [kept, other, n] : par::gather_few(comm, std::move(here))) pairs[{kept, other}] += n;
}

/// Throws where faces inside have triangles of two patches. Local.
void require_one_patch(const mesh::MeshInfo& info, const BoundaryMatch& match) {
  for (const auto& [pair, n] : match.in_two_patches)
    throw Error(fmt::format("triangles: expected one patch for each face, found {} faces inside in '{}' and in '{}'", n,
                            info.patches[at(pair.first)].name, info.patches[at(pair.second)].name));
}

void require_number_of_patches(std::size_t n) {
  if (n > at(mesh::max_inner_patches))
    throw Error(
        fmt::format("patches of faces inside: expected at most {} patches, found {}", mesh::max_inner_patches, n));
}

}  // namespace

BoundaryMatch match_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& triangles,
                             std::optional<int> untagged) {
  Outcome outcome;
  outcome.match.n_inner.resize(mesh.info.patches.size());
  par::Mailbox<Answer> answers(comm);
  match_outside(meet(comm, mesh, triangles, !untagged), untagged, outcome, answers);
  for (const auto& answer : answers.send().item)
    mesh.cell_to_cell[at(answer.row / 4)][at(answer.row % 4)] = mesh::patch_to_slot(answer.patch);
  if (comm.any(!outcome.apart.empty())) {
    require_number_of_patches(mesh.info.patches.size());
    par::Mailbox<Answer> inside(comm);
    match_inside(meet_inside(comm, mesh, std::move(outcome.apart)), outcome, inside);
    auto& word = mesh::make_inner_patches(mesh);
    for (const auto& answer : inside.send().item)
      word[at(answer.row / 4)] =
          mesh::with_inner_patch(word[at(answer.row / 4)], static_cast<int>(answer.row % 4), answer.patch);
  }
  auto& match = outcome.match;
  std::array<std::int64_t, 3> sum{match.n_untagged, match.n_apart, match.n_contradictions};
  comm.sum_in_place(sum);
  match.n_untagged = sum[0];
  match.n_apart = sum[1];
  match.n_contradictions = sum[2];
  comm.sum_in_place(match.n_inner);
  sum_pairs(comm, match.in_two_patches);
  const auto first = comm.min(outcome.first);
  if (first != std::numeric_limits<std::int64_t>::max()) match.first_misfit = to_misfit(first);
  return match;
}

void tag_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& triangles) {
  auto& patches = mesh.info.patches;
  const auto untagged = mesh::find_untagged(patches);
  const bool is_new = untagged == patches.size();
  const auto match = match_boundary(comm, mesh, triangles, static_cast<int>(untagged));
  if (match.first_misfit) refuse(comm, mesh, triangles, *match.first_misfit);
  require_one_patch(mesh.info, match);
  if (match.n_untagged > 0 && is_new) patches.push_back(mesh::untagged_patch(patches));
}

void compare_boundary(const par::Comm& comm, mesh::DistMesh& mesh, const mesh::BoundaryTriangles& triangles) {
  const auto match = match_boundary(comm, mesh, triangles, {});
  if (match.first_misfit) refuse(comm, mesh, triangles, *match.first_misfit);
  require_one_patch(mesh.info, match);
}

}  // namespace pamr::assemble
