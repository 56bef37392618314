// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/coarsen/coarsen.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "pamr/base/contract.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/coarsen/coarse_fields.hpp"
#include "pamr/mesh/cell_runs.hpp"
#include "pamr/mesh/offsets.hpp"
#include "pamr/refine/family.hpp"

namespace pamr::coarsen {

namespace {

NewPlaces find_places(const mesh::DistMesh& mesh, std::span<const Group> groups, std::vector<std::uint8_t>& counts) {
  NewPlaces places;
  reserve_array(places.cell, at(mesh.n_cells()));
  reserve_array(places.first_of_group, groups.size());
  assign_array(counts, at(mesh.n_cells()), std::uint8_t{1});
  LocalId next = 0;
  for (LocalId c = 0; c < mesh.n_cells();) {
    const auto g = places.first_of_group.size();
    if (g == groups.size() || groups[g].first != c) {
      places.cell.push_back(next++);
      ++c;
      continue;
    }
    places.first_of_group.push_back(next);
    const auto n = refine::split_pattern[groups[g].now].n_children;
    for (; c < groups[g].end; ++c) {
      places.cell.push_back(-1 - static_cast<LocalId>(g));
      counts[at(c)] = 0;
    }
    counts[at(groups[g].first)] = static_cast<std::uint8_t>(n);
    next += n;
  }
  return places;
}

/// The nodes that stay: their old local numbers; fills the new one of each old node.
std::vector<LocalId> find_nodes(std::span<const std::uint8_t> stays, std::vector<LocalId>& new_node) {
  std::vector<LocalId> old_node;
  reserve_array(old_node, stays.size());
  assign_array(new_node, stays.size(), invalid_local);
  for (std::size_t n = 0; n < stays.size(); ++n) {
    if (stays[n] == 0) continue;
    new_node[n] = static_cast<LocalId>(old_node.size());
    old_node.push_back(static_cast<LocalId>(n));
  }
  return old_node;
}

void place_nodes(const mesh::DistMesh& old, const std::vector<LocalId>& old_node,
                 const std::vector<GlobalId>& new_number, mesh::DistMesh& coarse) {
  reserve_array(coarse.node_position, old_node.size());
  reserve_array(coarse.node_global, old_node.size());
  for (const auto node : old_node) {
    coarse.node_position.push_back(old.point(node));
    coarse.node_global.push_back(new_number[at(node)]);
  }
}

/// Appends a cell; `nodes`: of the old mesh.
void append_cell(mesh::CellNodes nodes, GlobalId number, mesh::Lineage lineage, std::span<const LocalId> new_node,
                 mesh::DistMesh& coarse) {
  for (auto& node : nodes) {
    node = new_node[at(node)];
    PAMR_ENSURES(node != invalid_local);
  }
  coarse.cell_to_node.push_back(nodes);
  coarse.cell_global.push_back(number);
  coarse.lineage.push_back(lineage);
}

/// Appends the cells that take the place of a group.
void append_group(const Group& group, mesh::Lineage base, GlobalId first_number, std::span<const LocalId> new_node,
                  mesh::DistMesh& coarse) {
  const auto& pattern = refine::split_pattern[group.now];
  for (int child = 0; child < pattern.n_children; ++child) {
    const auto& code = pattern.child_to_node[at(child)];
    append_cell({group.node[at(code[0])], group.node[at(code[1])], group.node[at(code[2])], group.node[at(code[3])]},
                first_number + child, group.now == 0 ? base : base.closed(group.now, child), new_node, coarse);
  }
}

void make_cells(const mesh::DistMesh& old, std::span<const Group> groups, const NewPlaces& places,
                const std::vector<LocalId>& new_node, const std::vector<GlobalId>& first_number,
                mesh::DistMesh& coarse) {
  const auto n_gone = std::count_if(places.cell.begin(), places.cell.end(), [](LocalId c) { return c < 0; });
  std::size_t n = places.cell.size() - at(n_gone);
  for (const auto& group : groups) n += at(refine::split_pattern[group.now].n_children);
  reserve_array(coarse.cell_to_node, n);
  reserve_array(coarse.cell_global, n);
  reserve_array(coarse.lineage, n);
  auto group = groups.begin();
  for (LocalId c = 0; c < old.n_cells(); ++c) {
    if (!places.is_in_group(c)) {
      append_cell(old.cell_to_node[at(c)], first_number[at(c)], old.lineage[at(c)], new_node, coarse);
    } else if (group != groups.end() && group->first == c) {
      append_group(*group, parent_lineage(old, *group), first_number[at(c)], new_node, coarse);
      ++group;
    }
  }
}

}  // namespace

Coarsened take_back(const par::Comm& comm, const mesh::DistMesh& mesh, const Settled& settled,
                    std::span<const std::int8_t> flags) {
  Coarsened result;
  auto& coarse = result.mesh;
  coarse.info = mesh.info;
  const auto& groups = settled.groups;
  std::vector<std::uint8_t> counts;
  result.places = find_places(mesh, groups, counts);
  const auto& places = result.places;
  std::vector<LocalId> new_node;
  result.old_node = find_nodes(settled.node_stays, new_node);
  place_nodes(mesh, result.old_node, mesh::node_offsets(comm, mesh, settled.node_stays, mesh.info.first_id), coarse);
  const bool in_runs = !mesh::cell_runs(comm, mesh).empty();
  make_cells(mesh, groups, places, new_node, mesh::cell_offsets(comm, mesh, in_runs, counts, mesh.info.first_id),
             coarse);
  coarse.info.n_global_cells = comm.sum(std::int64_t{coarse.n_cells()});
  std::int64_t last = mesh.info.first_id - 1;
  for (const auto number : coarse.node_global) last = std::max(last, number);
  coarse.info.n_global_nodes = comm.max(last) + 1 - mesh.info.first_id;
  link_coarse(comm, mesh, groups, places, coarse);
  carry_level0(mesh, groups, result);
  assign_array(result.flags, coarse.cell_to_node.size(), std::uint8_t{0});
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (flags[at(c)] > 0 && !places.is_in_group(c)) result.flags[at(places.cell[at(c)])] = 1;
  return result;
}

std::vector<LocalId> find_needed_nodes(const Settled& settled, const Coarsened& coarse,
                                       std::span<const refine::EdgeMask> marks) {
  std::vector<LocalId> needed;
  for (std::size_t g = 0; g < settled.groups.size(); ++g) {
    const auto& group = settled.groups[g];
    const auto& table = refine::family_table[group.now];
    for (int child = 0; child < refine::split_pattern[group.now].n_children; ++child)
      for (unsigned rest = marks[at(coarse.places.first_of_group[g] + child)]; rest != 0; rest &= rest - 1) {
        const int e = std::countr_zero(rest);
        const auto edge = group.now == 0 ? refine::FamilyEdge{refine::EdgeRole::parent, static_cast<std::int8_t>(e)}
                                         : table.edge[at(child)][at(e)];
        if (edge.role != refine::EdgeRole::parent) continue;
        if (const auto node = group.node[at(4 + edge.parent_edge)]; node != invalid_local) needed.push_back(node);
      }
  }
  return needed;
}

}  // namespace pamr::coarsen
