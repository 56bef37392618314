// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/part/join_part.hpp"

#include <algorithm>
#include <numeric>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/cell_runs.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::adapt {

namespace {

LocalId link_behind(const PartRuns& runs, const mesh::DistMesh& whole, LocalId slot) {
  if (slot < 0) return slot;
  return whole.is_own(slot) && runs.has(slot) ? runs.place_of(slot) : open_slot(whole.info);
}

/// For each cell of the whole mesh the number of the first that it has become. Collective: four sparse exchanges.
std::vector<GlobalId> first_numbers(const par::Comm& comm, const PartRuns& runs, const mesh::DistMesh& whole,
                                    const MeshPart& before) {
  std::vector<LocalId> count(at(whole.n_cells()), 0);
  for (const auto& run : runs.all())
    for (auto c = run.from; c < run.from + run.count; ++c) ++count[at(run.is_of_whole ? c : before.whole_cell[at(c)])];
  const auto all = whole.info.cell_ids();
  const auto block = par::scatter_rows<LocalId>(comm, all, count, 1, whole.cell_global);
  auto next = whole.info.first_id + comm.exclusive_sum(std::accumulate(block.begin(), block.end(), std::int64_t{0}));
  std::vector<GlobalId> first;
  for (const auto in_cell : block) {
    first.push_back(next);
    next += in_cell;
  }
  return par::fetch_rows<GlobalId>(comm, all, first, 1, whole.cell_global);
}

}  // namespace

std::vector<LocalId> cells_of_whole(const PartRuns& runs, const MeshPart& before) {
  std::vector<LocalId> cells;
  reserve_array(cells, at(runs.n_cells()));
  for (const auto& run : runs.all())
    for (auto c = run.from; c < run.from + run.count; ++c)
      cells.push_back(run.is_of_whole ? c : before.whole_cell[at(c)]);
  return cells;
}

std::vector<refine::RebuiltFamily> join_plans(const PartRuns& runs, const WholeCells& whole, const MeshPart& before) {
  std::vector<refine::RebuiltFamily> plans;
  for (auto plan : whole.closure.rebuilt) {
    if (!runs.is_added(plan.first)) continue;
    plan.first = runs.place_of(plan.first);
    plans.push_back(plan);
  }
  const auto middle = std::ssize(plans);
  for (auto plan : before.known.plans) {
    plan.first = runs.place_of_before(plan.first);
    plans.push_back(plan);
  }
  std::inplace_merge(plans.begin(), plans.begin() + middle, plans.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
  return plans;
}

mesh::CellNeighbors links_of_whole(const PartRuns& runs, const mesh::DistMesh& whole, const Run& run,
                                   mesh::CellNeighbors links) {
  for (auto& slot : links)
    if (slot >= run.from && slot < run.from + run.count)
      slot += run.to - run.from;
    else
      slot = link_behind(runs, whole, slot);
  return links;
}

mesh::CellNeighbors links_of_part(const PartRuns& runs, const mesh::DistMesh& whole, const MeshPart& before,
                                  LocalId cell) {
  const auto open = open_slot(whole.info);
  auto links = before.mesh.cell_to_cell[at(cell)];
  for (int face = 0; face < 4; ++face) {
    auto& slot = links[at(face)];
    if (slot == open)
      slot = link_behind(runs, whole, whole.cell_to_cell[at(before.whole_cell[at(cell)])][at(face)]);
    else if (slot >= 0)
      slot = before.mesh.is_own(slot) ? runs.place_of_before(slot) : open;
  }
  return links;
}

BorderFaces join_border_faces(const PartRuns& runs, const mesh::DistMesh& whole, const MeshPart& before,
                              const std::vector<std::uint8_t>& has_face) {
  BorderFaces border;
  const auto& old = before.mesh;
  for (std::size_t i = 0, j = 0; i < whole.border_rank.size(); ++i) {
    if (j < old.border_rank.size() && old.border_rank[j] == whole.border_rank[i]) {
      for (auto k = old.border_offset[j]; k < old.border_offset[j + 1]; ++k)
        border.border_face.push_back({runs.place_of_before(old.border_face[k].cell), old.border_face[k].slot});
      ++j;
    }
    for (auto k = whole.border_offset[i]; k < whole.border_offset[i + 1]; ++k)
      if (has_face[k] != 0 && (!before.is_cut || before.has_face[k] == 0))
        border.border_face.push_back({runs.place_of(whole.border_face[k].cell), whole.border_face[k].slot});
    if (border.border_face.size() == border.border_offset.back()) continue;
    border.border_rank.push_back(whole.border_rank[i]);
    border.border_offset.push_back(border.border_face.size());
  }
  return border;
}

GlobalId number_in_order(const par::Comm& comm, const PartRuns& runs, const mesh::DistMesh& whole,
                         const MeshPart& before, std::vector<GlobalId>& of_cell) {
  const auto n = runs.n_cells();
  if (!mesh::cell_runs(comm, whole).empty()) {
    const auto first = whole.info.first_id + comm.exclusive_sum(n);
    of_cell.clear();
    reserve_array(of_cell, at(n));
    for (LocalId c = 0; c < n; ++c) of_cell.push_back(first + c);
  } else {
    const auto first = first_numbers(comm, runs, whole, before);
    of_cell.clear();
    for (const auto& run : runs.all())
      for (auto c = run.from; c < run.from + run.count; ++c) {
        const auto cell = run.is_of_whole ? c : before.whole_cell[at(c)];
        const bool is_next = !run.is_of_whole && c > 0 && before.whole_cell[at(c) - 1] == cell;
        of_cell.push_back(is_next ? of_cell.back() + 1 : first[at(cell)]);
      }
  }
  return comm.sum(n);
}

std::vector<GlobalId> numbers_behind_border(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::vector<GlobalId> mine;
  for (const auto face : mesh.border_face) mine.push_back(mesh.cell_global[at(face.cell)]);
  const par::Pattern faces{mesh.border_rank, mesh.border_offset, std::vector<LocalId>(mesh.border_face.size(), 0)};
  return par::Exchange(comm, faces).swap<GlobalId>(mine);
}

}  // namespace pamr::adapt
