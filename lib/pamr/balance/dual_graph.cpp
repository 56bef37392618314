// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/dual_graph.hpp"

#include <algorithm>

#include "pamr/base/contract.hpp"

namespace pamr::balance {

namespace {

constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// First cell of the family of a cell and the number of cells there; the cell itself where there is no whole family.
struct Family {
  LocalId first = 0;
  LocalId size = 1;
};

Family family_of(const mesh::DistMesh& mesh, LocalId cell) {
  const auto lineage = mesh.lineage[at(cell)];
  if (!lineage.is_removable()) return {cell, 1};
  return {cell - lineage.child(), lineage.family_size()};
}

/// Global vertices on the other side of rank borders, each once, with a place of its own behind the own vertices.
class GhostVertices {
 public:
  explicit GhostVertices(const std::vector<GlobalId>& of_face) : id_(of_face) {
    std::sort(id_.begin(), id_.end());
    id_.erase(std::unique(id_.begin(), id_.end()), id_.end());
  }
  std::size_t size() const { return id_.size(); }
  std::size_t place(GlobalId id) const {
    return static_cast<std::size_t>(std::lower_bound(id_.begin(), id_.end(), id) - id_.begin());
  }
  GlobalId id(std::size_t place) const { return id_[place]; }

 private:
  std::vector<GlobalId> id_;
};

std::vector<LocalId> invert(const Groups& groups) {
  std::vector<LocalId> cell_to_group(groups.cell.size());
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const auto cell : groups.cells(g)) cell_to_group[at(cell)] = static_cast<LocalId>(g);
  return cell_to_group;
}

}  // namespace

Groups group_families(const mesh::DistMesh& mesh) {
  Groups groups;
  groups.cell.resize(at(mesh.n_cells()));
  for (LocalId c = 0; c < mesh.n_cells(); ++c) groups.cell[at(c)] = c;
  for (LocalId c = 0; c < mesh.n_cells();) {
    c += family_of(mesh, c).size;
    groups.offset.push_back(at(c));
  }
  return groups;
}

Groups group_by_weight(const mesh::DistMesh& mesh, std::span<const std::int64_t> cell_weight,
                       std::int64_t weight_of_group) {
  PAMR_EXPECTS(cell_weight.size() == at(mesh.n_cells()));
  Groups groups;
  groups.cell.reserve(at(mesh.n_cells()));
  std::vector<std::uint8_t> is_queued(at(mesh.n_cells()), 0);  // by first cell of the family
  std::vector<LocalId> rim;                                    // families met but not taken, first come first served
  std::size_t next_of_rim = 0;
  LocalId next_seed = 0;
  std::int64_t weight = 0;
  const auto queue = [&](Family family) {
    if (is_queued[at(family.first)] != 0) return;
    is_queued[at(family.first)] = 1;
    rim.push_back(family.first);
  };
  // the families met first stay queued when a group is full: the next one begins there
  while (groups.cell.size() < at(mesh.n_cells())) {
    if (next_of_rim == rim.size()) {
      if (groups.cell.size() > groups.offset.back()) {
        groups.offset.push_back(groups.cell.size());
        weight = 0;
      }
      while (is_queued[at(family_of(mesh, next_seed).first)] != 0) ++next_seed;
      rim.clear();
      next_of_rim = 0;
      queue(family_of(mesh, next_seed));
    }
    const auto family = family_of(mesh, rim[next_of_rim++]);
    for (auto c = family.first; c < family.first + family.size; ++c) {
      groups.cell.push_back(c);
      weight += cell_weight[at(c)];
      for (const auto neighbour : mesh.cell_to_cell[at(c)])
        if (mesh.is_own(neighbour)) queue(family_of(mesh, neighbour));
    }
    if (weight >= weight_of_group) {
      groups.offset.push_back(groups.cell.size());
      weight = 0;
    }
  }
  if (groups.cell.size() > groups.offset.back()) groups.offset.push_back(groups.cell.size());
  return groups;
}

DualGraph build_dual_graph(const par::Comm& comm, const mesh::DistMesh& mesh, const Groups& groups,
                           std::span<const std::int64_t> cell_weight) {
  PAMR_EXPECTS(cell_weight.size() == at(mesh.n_cells()) && groups.cell.size() == at(mesh.n_cells()));
  DualGraph graph;
  const auto n = groups.size();
  graph.first_vertex = comm.exclusive_sum(static_cast<std::int64_t>(n));
  graph.n_global_vertices = comm.sum(static_cast<std::int64_t>(n));

  const auto cell_to_group = invert(groups);
  std::vector<GlobalId> vertex(at(mesh.n_cells()));
  for (std::size_t c = 0; c < vertex.size(); ++c) vertex[c] = graph.first_vertex + cell_to_group[c];
  const auto beyond = swap_over_faces<GlobalId>(comm, mesh, vertex);
  vertex = {};
  const GhostVertices ghosts(beyond);

  graph.weight.resize(n, 0);
  graph.arc_begin.reserve(n + 1);
  graph.arc_begin.push_back(0);
  std::vector<std::int64_t> arc_to(n + ghosts.size(), -1);  // arc of the vertex at hand to each other one
  for (std::size_t v = 0; v < n; ++v) {
    const auto begin = graph.arc_begin.back();
    for (const auto cell : groups.cells(v)) {
      graph.weight[v] += cell_weight[at(cell)];
      for (const auto neighbour : mesh.cell_to_cell[at(cell)]) {
        if (neighbour < 0) continue;
        const auto ghost = mesh.is_ghost(neighbour) ? ghosts.place(beyond[at(neighbour - mesh.n_cells())]) : 0;
        const auto other = mesh.is_ghost(neighbour) ? n + ghost : at(cell_to_group[at(neighbour)]);
        if (other == v) continue;
        if (arc_to[other] < begin) {
          arc_to[other] = static_cast<std::int64_t>(graph.neighbour.size());
          graph.neighbour.push_back(other < n ? graph.first_vertex + static_cast<GlobalId>(other) : ghosts.id(ghost));
          graph.n_faces.push_back(0);
        }
        ++graph.n_faces[at(arc_to[other])];
      }
    }
    graph.arc_begin.push_back(static_cast<std::int64_t>(graph.neighbour.size()));
  }
  return graph;
}

}  // namespace pamr::balance
