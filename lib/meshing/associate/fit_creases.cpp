// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/associate/fit_creases.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::meshing {

namespace {

/// An edge of a boundary face on its way to the rank where its two faces meet: its ends by global number, the third
/// corner of the face.
struct Side {
  std::array<GlobalId, 2> end{};
  std::array<LocalId, 2> local{};  ///< on the rank that sent it
  std::array<geometry::Vec3, 2> point;
  geometry::Vec3 third;
};

/// How far a node lies from the sharp edge that it belongs to.
struct Off {
  LocalId node;
  double distance;
};

void send_sides(const par::Comm& comm, const mesh::DistMesh& mesh, int patch, par::Mailbox<Side>& box) {
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      if (mesh.cell_to_cell[at(c)][slot] != mesh::patch_to_slot(patch)) continue;
      std::array<LocalId, 3> node{};
      for (std::size_t k = 0; k < 3; ++k) node[k] = mesh.cell_to_node[at(c)][at(mesh::tet::face_to_corner[slot][k])];
      for (std::size_t k = 0; k < 3; ++k) {
        auto a = node[k], b = node[(k + 1) % 3];
        if (mesh.node_global[at(b)] < mesh.node_global[at(a)]) std::swap(a, b);
        const Side side{{mesh.node_global[at(a)], mesh.node_global[at(b)]},
                        {a, b},
                        {mesh.point(a), mesh.point(b)},
                        mesh.point(node[(k + 2) % 3])};
        const auto hash = pamr::combine(pamr::combine(0, static_cast<std::uint64_t>(side.end[0])),
                                        static_cast<std::uint64_t>(side.end[1]));
        box.add(static_cast<Rank>(hash % static_cast<std::uint64_t>(comm.size())), side);
      }
    }
}

}  // namespace

CreaseFit fit_creases(const par::Comm& comm, const mesh::DistMesh& mesh, int patch, const geometry::Surface& surface,
                      std::vector<double>& off) {
  par::Mailbox<Side> box(comm);
  send_sides(comm, mesh, patch, box);
  const auto received = box.send();
  std::vector<std::pair<Side, Rank>> side;
  for (std::size_t r = 0; r < received.rank.size(); ++r)
    for (const auto& item : received.from(r)) side.push_back({item, received.rank[r]});
  std::sort(side.begin(), side.end(), [](const auto& a, const auto& b) { return a.first.end < b.first.end; });

  const auto& creases = *surface.creases();
  CreaseFit fit;
  par::Mailbox<Off> answers(comm);
  for (std::size_t i = 0; i + 1 < side.size(); ++i) {
    const auto& [one, rank] = side[i];
    const auto& other = side[i + 1].first;
    if (one.end != other.end) continue;
    const auto [a, b] = one.point;
    const auto distance = [&](geometry::Vec3 p) { return norm(p - surface.project_to_seam(p)); };
    if (creases.crease_between(a, b, one.third, other.third)) {
      ++fit.n_along;
      for (std::size_t k = 0; k < 2; ++k) answers.add(rank, {one.local[k], distance(one.point[k])});
    } else if (const double third = 1.0 / 3;
               creases.piece_at(third * (a + b + one.third)) != creases.piece_at(third * (a + b + other.third))) {
      ++fit.n_across;
      fit.worst_across = std::max({fit.worst_across, distance(a), distance(b)});
    }
  }
  for (const auto& [node, distance] : answers.send().item) off[at(node)] = std::max(off[at(node)], distance);
  fit.n_along = comm.sum(fit.n_along);
  fit.n_across = comm.sum(fit.n_across);
  fit.worst_across = comm.max(fit.worst_across);
  return fit;
}

}  // namespace pamr::meshing
