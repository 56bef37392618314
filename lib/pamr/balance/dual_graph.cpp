// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/dual_graph.hpp"

#include <algorithm>
#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/mesh/ghost_values.hpp"
#include "pamr/order/hilbert.hpp"

namespace pamr::balance {

namespace {

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
  std::size_t place(GlobalId id) const { return at(std::lower_bound(id_.begin(), id_.end(), id) - id_.begin()); }
  GlobalId id(std::size_t place) const { return id_[place]; }

 private:
  std::vector<GlobalId> id_;
};

/// Length of the curve's stretches: 2^18 of them; their counters fit a second-level cache.
constexpr unsigned bucket_bits = 18;

/// Indices in ascending order of their buckets, those of one bucket in the order in which they stand.
std::vector<std::uint32_t> sort_by_bucket(const std::vector<std::uint32_t>& bucket) {
  std::vector<std::uint32_t> order(bucket.size());
  if (4 * bucket.size() < std::size_t{1} << bucket_bits) {  // counters would take more room than the rest of the mesh
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(),
              [&](auto a, auto b) { return bucket[a] != bucket[b] ? bucket[a] < bucket[b] : a < b; });
    return order;
  }
  std::vector<std::uint32_t> place((std::size_t{1} << bucket_bits) + 1, 0);
  for (const auto b : bucket) ++place[b + 1];
  for (std::size_t b = 1; b < place.size(); ++b) place[b] += place[b - 1];
  for (std::size_t i = 0; i < bucket.size(); ++i) order[place[bucket[i]]++] = static_cast<std::uint32_t>(i);
  return order;
}

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
  const order::CurveGrid grid(geometry::box_of(mesh.node_position));
  std::vector<std::uint32_t> bucket;
  std::vector<LocalId> first;
  bucket.reserve(at(mesh.n_cells()));
  first.reserve(at(mesh.n_cells()));
  for (LocalId c = 0; c < mesh.n_cells(); c += family_of(mesh, c).size) {
    const auto p = mesh.points(c);
    bucket.push_back(static_cast<std::uint32_t>(grid.key(geometry::centroid(p)) >> (63U - bucket_bits)));
    first.push_back(c);
  }
  const auto order = sort_by_bucket(bucket);
  free_array(bucket);
  Groups groups;
  groups.cell.reserve(at(mesh.n_cells()));
  std::int64_t weight = 0;
  for (const auto i : order) {
    const auto family = family_of(mesh, first[i]);
    for (auto c = family.first; c < family.first + family.size; ++c) {
      groups.cell.push_back(c);
      weight += cell_weight[at(c)];
    }
    if (weight < weight_of_group) continue;
    groups.offset.push_back(groups.cell.size());
    weight = 0;
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
  const auto beyond = mesh::ghost_values(comm, mesh, vertex);
  free_array(vertex);
  const GhostVertices ghosts(beyond);

  graph.weight.resize(n, 0);
  graph.arc_begin.reserve(n + 1);
  graph.arc_begin.push_back(0);
  std::vector<std::int64_t> arc_to(n + ghosts.size(), -1);  // arc of the vertex at hand to each other one
  for (std::size_t v = 0; v < n; ++v) {
    const auto begin = graph.arc_begin.back();
    for (const auto cell : groups.cells(v)) {
      graph.weight[v] += cell_weight[at(cell)];
      for (const auto neighbor : mesh.cell_to_cell[at(cell)]) {
        if (neighbor < 0) continue;
        const auto ghost = mesh.is_ghost(neighbor) ? ghosts.place(beyond[at(neighbor - mesh.n_cells())]) : 0;
        const auto other = mesh.is_ghost(neighbor) ? n + ghost : at(cell_to_group[at(neighbor)]);
        if (other == v) continue;
        if (arc_to[other] < begin) {
          arc_to[other] = static_cast<std::int64_t>(graph.neighbor.size());
          graph.neighbor.push_back(other < n ? graph.first_vertex + static_cast<GlobalId>(other) : ghosts.id(ghost));
          graph.n_faces.push_back(0);
        }
        ++graph.n_faces[at(arc_to[other])];
      }
    }
    graph.arc_begin.push_back(static_cast<std::int64_t>(graph.neighbor.size()));
  }
  return graph;
}

}  // namespace pamr::balance
