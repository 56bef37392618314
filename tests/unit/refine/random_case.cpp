// SPDX-License-Identifier: GPL-3.0-or-later
#include "random_case.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "pamr/base/hash.hpp"
#include "pamr/geometry/orientation.hpp"
#include "support/meshes.hpp"

namespace pamr::test {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// A number of a cell's own: of its points, in any order.
std::uint64_t hash_of(const geometry::TetPoints& points) {
  std::uint64_t sum = 0;
  for (const auto p : points) sum += combine(combine(mix(bits_of(p.x)), bits_of(p.y)), bits_of(p.z));
  return mix(sum);
}

bool is_marked(const geometry::TetPoints& points, Law law, std::uint64_t seed, GlobalId n_cells) {
  if (law == Law::random) {
    const auto one_in = std::min<std::uint64_t>(30, static_cast<std::uint64_t>(n_cells) / 2 + 1);
    return combine(seed, hash_of(points)) % one_in == 0;
  }
  Dice dice(mix(seed));
  const geometry::Vec3 center{dice.unit(), dice.unit(), dice.unit()};
  const double radius = 0.2 + 0.4 * dice.unit();
  const auto inside = std::count_if(points.begin(), points.end(), [&](auto p) { return norm(p - center) < radius; });
  return law == Law::corner ? inside >= 2 : inside != 0 && inside != 4;
}

geometry::TetPoints points_of(const mesh::BlockMesh& whole, const std::array<GlobalId, 4>& n) {
  const auto& p = whole.node_position;
  return {p[at(n[0])], p[at(n[1])], p[at(n[2])], p[at(n[3])]};
}

/// Messages for one rank only.
template <class T>
std::vector<T> send_all(const par::Comm& comm, const std::vector<T>& rows, Rank root) {
  return comm.sparse_exchange<T>({{root, rows}}).item;
}

}  // namespace

bool is_full_level() {
  const char* level = std::getenv("PAMR_TEST_LEVEL");
  return level != nullptr && std::string_view(level) == "full";
}

std::uint64_t n_cases_on(const par::Comm& world, std::uint64_t quick, std::uint64_t full) {
  const std::array<std::uint64_t, 5> sixteenths{0, 8, 4, 3, 1};
  const auto size = static_cast<std::size_t>(world.size());
  return n_cases(quick, size < sixteenths.size() ? full * sixteenths[size] / 16 : std::min<std::uint64_t>(full, 40));
}

std::vector<std::uint64_t> seeds_alone(const par::Comm& world) {
  const auto size = static_cast<std::uint64_t>(world.size());
  const auto n = size == 1 ? n_cases(50, 1000) : n_cases(7, 40);
  const auto begin = (size - 1) * 1000;
  std::vector<std::uint64_t> seeds;
  for (auto i = static_cast<std::uint64_t>(world.rank()); i < n; i += size) seeds.push_back(begin + i);
  return seeds;
}

std::uint64_t n_cases_together(const par::Comm& world) {
  return n_cases_on(world, world.size() == 1 ? 50 : world.size() <= 4 ? 24 : 10, 2000);
}

std::vector<std::uint8_t> mark(const mesh::DistMesh& mesh, Law law, std::uint64_t seed) {
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    flags.push_back(is_marked(mesh.points(c), law, seed, mesh.info.n_global_cells) ? 1 : 0);
  return flags;
}

std::vector<std::uint8_t> mark(const mesh::BlockMesh& whole, Law law, std::uint64_t seed) {
  std::vector<std::uint8_t> flags;
  for (const auto& n : whole.cell_to_node)
    flags.push_back(is_marked(points_of(whole, n), law, seed, whole.info.n_global_cells) ? 1 : 0);
  return flags;
}

mesh::BlockMesh gather_on(const par::Comm& comm, const mesh::DistMesh& mesh, Rank root) {
  struct CellRow {
    GlobalId id;
    std::array<GlobalId, 4> node, neighbor;
    std::uint64_t lineage;
    std::int64_t parent;
  };
  struct NodeRow {
    GlobalId id;
    geometry::Vec3 position;
  };
  const auto* parent = mesh.find_cell_field("parent");
  std::vector<CellRow> cells;
  for (std::size_t c = 0; c < mesh.cell_to_node.size(); ++c) {
    CellRow row{mesh.cell_global[c], {}, {}, mesh.lineage[c].bits(), parent == nullptr ? -1 : parent->integer()[c]};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto slot = mesh.cell_to_cell[c][i];
      row.node[i] = mesh.node_global[at(mesh.cell_to_node[c][i])];
      row.neighbor[i] = mesh.is_own(slot)     ? mesh.cell_global[at(slot)]
                        : mesh.is_ghost(slot) ? mesh.ghost_global[at(slot - mesh.n_cells())]
                                              : slot;
    }
    cells.push_back(row);
  }
  std::vector<NodeRow> nodes;
  for (std::size_t i = 0; i < mesh.node_global.size(); ++i)
    nodes.push_back({mesh.node_global[i], mesh.node_position[i]});
  cells = send_all(comm, cells, root);
  nodes = send_all(comm, nodes, root);
  const auto by_id = [](const auto& a, const auto& b) { return a.id < b.id; };
  std::sort(cells.begin(), cells.end(), by_id);
  std::sort(nodes.begin(), nodes.end(), by_id);

  mesh::BlockMesh whole;
  whole.info = mesh.info;
  mesh::CellField parents{"parent", "", 1, mesh::StorageType::int64, std::vector<std::int64_t>{}};
  for (const auto& row : cells) {
    whole.cell_to_node.push_back(row.node);
    whole.cell_to_cell.push_back(row.neighbor);
    whole.lineage.emplace_back(row.lineage);
    parents.integer().push_back(row.parent);
  }
  if (parent != nullptr) whole.cell_fields.push_back(parents);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (i == 0 || nodes[i].id != nodes[i - 1].id) whole.node_position.push_back(nodes[i].position);
  return whole;
}

std::string bytes_of(const mesh::BlockMesh& whole) {
  std::string bytes;
  append_bytes(whole.node_position, bytes);
  append_bytes(whole.cell_to_node, bytes);
  append_bytes(whole.cell_to_cell, bytes);
  append_bytes(whole.lineage, bytes);
  return bytes;
}

void shake(mesh::BlockMesh& whole, std::uint64_t seed) {
  const auto original = whole.node_position;
  std::vector<double> shortest(original.size(), 1e300);  // edge at each node
  for (const auto& n : whole.cell_to_node)
    for (const auto a : n)
      for (const auto b : n)
        if (a != b) shortest[at(a)] = std::min(shortest[at(a)], norm(original[at(a)] - original[at(b)]));
  Dice dice(mix(seed));
  for (std::size_t i = 0; i < original.size(); ++i) {
    const geometry::Vec3 direction{dice.symmetric(), dice.symmetric(), dice.symmetric()};
    if (dice.below(3) == 0) whole.node_position[i] = original[i] + 0.8 * shortest[i] * direction;
  }
  for (bool again = true; again;) {
    again = false;
    for (const auto& n : whole.cell_to_node) {
      const auto p = points_of(whole, n);
      if (geometry::is_positive(p[0], p[1], p[2], p[3]) && geometry::mean_ratio(p) > 1e-6) continue;
      again = true;
      for (const auto node : n) {
        auto& moved = whole.node_position[at(node)];
        const auto back = geometry::midpoint(moved, original[at(node)]);
        moved = norm(back - original[at(node)]) < 1e-3 * shortest[at(node)] ? original[at(node)] : back;
      }
    }
  }
}

mesh::DistMesh scatter(const par::Comm& comm, const mesh::BlockMesh& whole, std::uint64_t seed) {
  auto block = cut(comm, whole);
  if (seed % 4 == 0) return assemble::assemble(comm, std::move(block));
  const auto destination = random_destinations(comm, block, seed);
  return assemble::assemble(comm, std::move(block), destination);
}

mesh::BlockMesh broadcast(const par::Comm& comm, const mesh::BlockMesh& whole, Rank root) {
  mesh::BlockMesh result;
  result.info = whole.info;
  result.cell_to_node = comm.broadcast(whole.cell_to_node, root);
  result.cell_to_cell = comm.broadcast(whole.cell_to_cell, root);
  result.lineage = comm.broadcast(whole.lineage, root);
  result.node_position = comm.broadcast(whole.node_position, root);
  result.info.n_global_cells = static_cast<GlobalId>(result.cell_to_node.size());
  result.info.n_global_nodes = static_cast<GlobalId>(result.node_position.size());
  return result;
}

std::vector<std::uint8_t> flag_some(const mesh::BlockMesh& whole, const Places& reached, Dice& dice) {
  std::vector<std::uint8_t> flags;
  bool any = false;
  for (const auto& place : places_of_base_cells(whole)) {
    const bool is_open = reached.count(place) == 0;
    flags.push_back(is_open && (!any || dice.below(3) == 0) ? 1 : 0);
    any = any || is_open;
  }
  return flags;
}

}  // namespace pamr::test
