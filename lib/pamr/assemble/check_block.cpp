// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/check_block.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <string_view>

#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/mesh/local_size.hpp"

namespace pamr::assemble {

namespace {

void require_size(std::size_t found, std::size_t expected, const std::string& what, Rank rank) {
  if (found != expected)
    throw Error(fmt::format("{}: expected {} entries, found {} (rank {})", what, expected, found, rank));
}

void check_fields(const std::vector<mesh::Field>& fields, std::size_t n, const char* place, bool has_map, Rank rank) {
  for (const auto& field : fields) {
    if (field.n_components < 1)
      throw Error(fmt::format("{} field `{}`: expected at least 1 component, found {}", std::string(place), field.name,
                              field.n_components));
    const auto size = std::visit([](const auto& values) { return values.size(); }, field.value);
    require_size(size, n * static_cast<std::size_t>(field.n_components),
                 std::string(place) + " field `" + field.name + "`", rank);
    mesh::require_level0_field(field, place == std::string_view("cell"), has_map);
  }
}

void check_sizes(const mesh::BlockMesh& block, std::span<const Rank> destination, const Contents& contents,
                 GlobalId first_cell, GlobalId n_cells_found, const par::BlockRange& nodes, Rank rank) {
  const auto n = block.cell_to_node.size();
  if (n_cells_found != block.info.n_global_cells)
    throw Error(fmt::format("mesh: expected {} cells, found {} in all blocks together", block.info.n_global_cells,
                            n_cells_found));
  if (block.info.first_id < 0 || block.info.first_id > mesh::max_first_id)
    throw Error(
        fmt::format("mesh: expected a first id from 0 to {}, found {}", mesh::max_first_id, block.info.first_id));
  if (n != 0 && block.first_cell != first_cell)
    throw Error(fmt::format("mesh: expected the block of rank {} to begin at cell {}, found {}", rank, first_cell,
                            block.first_cell));
  if (contents.has_neighbors) require_size(block.cell_to_cell.size(), n, "cell_to_cell", rank);
  if (contents.has_lineage) require_size(block.lineage.size(), n, "lineage", rank);
  if (contents.has_origin) require_size(block.cell_origin.size(), n, "cell_origin", rank);
  if (contents.has_destinations) require_size(destination.size(), n, "destinations", rank);
  require_size(block.node_position.size(), static_cast<std::size_t>(nodes.count()), "node block", rank);
  const bool has_map = block.info.level0 != nullptr;
  check_fields(block.cell_fields, n, "cell", has_map, rank);
  check_fields(block.node_fields, static_cast<std::size_t>(nodes.count()), "node", has_map, rank);
}

std::string cell_at(const mesh::BlockMesh& block, std::size_t i) {
  return fmt::format("cell {}", block.first_cell + static_cast<GlobalId>(i));
}

void check_nodes(const mesh::BlockMesh& block) {
  const auto all = block.info.node_ids();
  for (std::size_t c = 0; c < block.cell_to_node.size(); ++c) {
    const auto& n = block.cell_to_node[c];
    for (const auto id : n)
      if (!all.contains(id))
        throw Error(fmt::format("cell_to_node, {}: expected node numbers from {} to {}, found {}", cell_at(block, c),
                                all.first, all.end() - 1, id));
    if (n[0] == n[1] || n[0] == n[2] || n[0] == n[3] || n[1] == n[2] || n[1] == n[3] || n[2] == n[3])
      throw Error(fmt::format("cell_to_node, {}: expected four different nodes, found {} {} {} {}", cell_at(block, c),
                              n[0], n[1], n[2], n[3]));
  }
}

void check_neighbors(const mesh::BlockMesh& block) {
  const auto all = block.info.cell_ids();
  const auto n_patches = static_cast<GlobalId>(block.info.patches.size());
  for (std::size_t c = 0; c < block.cell_to_cell.size(); ++c)
    for (const auto id : block.cell_to_cell[c]) {
      if (id >= all.end())
        throw Error(
            fmt::format("cell_to_cell, {}: expected neighbors below {}, found {}", cell_at(block, c), all.end(), id));
      if (id >= 0 && id < all.first)
        throw Error(
            fmt::format("cell_to_cell, {}: expected neighbors from {} on, found {}", cell_at(block, c), all.first, id));
      if (id < -n_patches)
        throw Error(fmt::format("cell_to_cell, {}: expected one of {} patches (-1 to {}), found {}", cell_at(block, c),
                                n_patches, -n_patches, id));
      if (id == block.first_cell + static_cast<GlobalId>(c))
        throw Error("cell_to_cell, " + cell_at(block, c) + ": expected another cell, found the cell itself");
    }
}

void check_boundary(const mesh::BlockMesh& block, Rank rank) {
  const auto all = block.info.node_ids();
  const auto& [nodes, patches] = block.boundary;
  require_size(patches.size(), nodes.size(), "patches of the boundary triangles", rank);
  for (std::size_t t = 0; t < nodes.size(); ++t) {
    const auto where = fmt::format("boundary triangle {} of rank {}", t, rank);
    for (const auto id : nodes[t])
      if (!all.contains(id))
        throw Error(
            fmt::format("{}: expected node numbers from {} to {}, found {}", where, all.first, all.end() - 1, id));
    const auto [a, b, c] = nodes[t];
    if (a == b || a == c || b == c)
      throw Error(fmt::format("{}: expected three different nodes, found {} {} {}", where, a, b, c));
    if (patches[t] < 0 || patches[t] >= std::ssize(block.info.patches))
      throw Error(fmt::format("{}: expected one of {} patches, from 0 on, found {}", where, block.info.patches.size(),
                              patches[t]));
  }
}

void check_lineage(const mesh::BlockMesh& block) {
  for (std::size_t c = 0; c < block.lineage.size(); ++c)
    if (!mesh::is_well_formed(block.lineage[c]))
      throw Error(fmt::format("lineage, {}: expected state, child, level and path of a cell, found {}",
                              cell_at(block, c), block.lineage[c].bits()));
}

std::uint64_t fold(std::uint64_t seed, const std::vector<mesh::Field>& fields) {
  for (const auto& field : fields) {
    for (const char letter : field.name) seed = combine(seed, static_cast<unsigned char>(letter));
    seed = combine(seed, static_cast<std::uint64_t>(field.n_components));
    seed = combine(seed, field.holds_integers() ? 1 : 2);
  }
  return combine(seed, fields.size());
}

/// Fields and counts travel between ranks by position, so their description must be the same on all: a number that
/// says whether it is, 0 or more.
std::int64_t description_of(const mesh::BlockMesh& block) {
  auto hash = combine(static_cast<std::uint64_t>(block.info.n_global_nodes),
                      static_cast<std::uint64_t>(block.info.n_global_cells));
  hash = combine(hash, static_cast<std::uint64_t>(block.info.first_id));
  hash = fold(fold(combine(hash, block.info.patches.size()), block.cell_fields), block.node_fields);
  return static_cast<std::int64_t>(hash >> 1U);
}

/// What the rank that holds the first member of a closure family tells those that hold the rest of it.
struct Announcement {
  GlobalId first = 0;
  std::uint64_t lineage = 0;
  Rank to = 0;
};

struct FamilyContext {
  const mesh::BlockMesh* block;
  GlobalId begin;
  GlobalId end;

  mesh::Lineage lineage_of(GlobalId id) const { return block->lineage[static_cast<std::size_t>(id - begin)]; }
  bool is_here(GlobalId id) const { return id >= begin && id < end; }
};

[[noreturn]] void refuse_family(GlobalId cell, mesh::Lineage found, const std::string& expected) {
  throw Error(fmt::format("lineage, cell {}: found {}, expected {}", cell, mesh::describe(found), expected));
}

/// Families that begin here and end on later ranks, for those ranks.
std::vector<par::Outgoing<Announcement>> announce(const FamilyContext& here, const std::vector<GlobalId>& starts,
                                                  std::span<const Rank> to, GlobalId end_of_cells) {
  std::vector<par::Outgoing<Announcement>> messages;
  for (auto id = std::max(here.begin, here.end - (mesh::max_family_size - 1)); id < here.end; ++id) {
    const auto lineage = here.lineage_of(id);
    if (!lineage.is_removable() || lineage.child() != 0) continue;
    const auto last = std::min(id + lineage.family_size(), end_of_cells);
    for (auto member = here.end; member < last; ++member) {
      const auto holder =
          static_cast<Rank>(std::upper_bound(starts.begin(), starts.end(), member) - starts.begin() - 1);
      if (messages.empty() || messages.back().to != holder)
        messages.push_back({holder, {{id, lineage.bits(), to[static_cast<std::size_t>(id - here.begin)]}}});
    }
  }
  return messages;
}

/// Refuses what is not a whole family in template order. `announced`: the families that began on earlier ranks and
/// reach into this one (one at most, or the lineage is bad).
void check_families(const FamilyContext& here, std::span<const Announcement> announced, GlobalId end_of_cells) {
  const auto require_member = [&](GlobalId id, GlobalId first, mesh::Lineage of_first) {
    const auto expected = mesh::sibling(of_first, static_cast<int>(id - first));
    if (here.is_here(id) && here.lineage_of(id) != expected)
      refuse_family(id, here.lineage_of(id),
                    fmt::format("{}, of the family of cell {}", mesh::describe(expected), first));
  };
  for (const auto& family : announced)
    for (int k = 1; k < mesh::Lineage(family.lineage).family_size(); ++k)
      require_member(family.first + k, family.first, mesh::Lineage(family.lineage));
  for (auto id = here.begin; id < here.end; ++id) {
    const auto lineage = here.lineage_of(id);
    if (!lineage.is_removable()) continue;
    const auto first = id - lineage.child();
    if (lineage.child() == 0) {
      if (id + lineage.family_size() > end_of_cells)
        refuse_family(id, lineage, fmt::format("{} cells of its family from there on", lineage.family_size()));
      for (int k = 1; k < lineage.family_size(); ++k) require_member(id + k, id, lineage);
    } else if (here.is_here(first)) {
      if (here.lineage_of(first) != mesh::sibling(lineage, 0))
        refuse_family(first, here.lineage_of(first),
                      fmt::format("{}, for the family of cell {}", mesh::describe(mesh::sibling(lineage, 0)), id));
    } else if (std::none_of(announced.begin(), announced.end(),
                            [&](const Announcement& family) { return family.first == first; })) {
      refuse_family(id, lineage, fmt::format("the first member of its family at cell {}", first));
    }
  }
}

}  // namespace

Contents check_block(const par::Comm& comm, const mesh::BlockMesh& block, std::span<const Rank> destination) {
  const auto n = static_cast<GlobalId>(block.cell_to_node.size());
  const auto description = description_of(block);
  std::array<std::int64_t, 7> most{block.cell_to_cell.empty() ? 0 : 1,
                                   block.lineage.empty() ? 0 : 1,
                                   destination.empty() ? 0 : 1,
                                   description,
                                   -description,
                                   block.cell_origin.empty() ? 0 : 1,
                                   block.boundary.node.empty() && block.boundary.patch.empty() ? 0 : 1};
  comm.max_in_place(most);
  const Contents contents{.has_neighbors = most[0] != 0,
                          .has_boundary = most[6] != 0,
                          .has_lineage = most[1] != 0,
                          .has_origin = most[5] != 0,
                          .has_destinations = most[2] != 0};
  const auto count = comm.all_gather(n);
  const auto first_cell =
      block.info.first_id + std::accumulate(count.begin(), count.begin() + comm.rank(), GlobalId{0});
  const auto n_cells = std::accumulate(count.begin(), count.end(), GlobalId{0});
  const auto nodes = par::block_range(block.info.n_global_nodes, comm.rank(), comm.size());
  if (most[3] != -most[4])
    throw Error("mesh: expected the same counts, patches and fields on every rank, found different ones");
  mesh::require_local_size(comm, n, "mesh");
  par::agree(comm, [&] {
    check_sizes(block, destination, contents, first_cell, n_cells, nodes, comm.rank());
    check_nodes(block);
    check_neighbors(block);
    check_boundary(block, comm.rank());
    check_lineage(block);
    for (const auto to : destination)
      if (to < 0 || to >= comm.size())
        throw Error(fmt::format("destinations: expected ranks from 0 to {}, found {}", comm.size() - 1, to));
  });
  return contents;
}

std::vector<Rank> family_destinations(const par::Comm& comm, const mesh::BlockMesh& block,
                                      std::span<const Rank> destination, const Contents& contents) {
  const auto n = static_cast<GlobalId>(block.cell_to_node.size());
  std::vector<Rank> to(destination.begin(), destination.end());
  if (!contents.has_destinations) to.assign(static_cast<std::size_t>(n), comm.rank());
  if (!contents.has_lineage) return to;

  auto starts = comm.all_gather(n);
  std::exclusive_scan(starts.begin(), starts.end(), starts.begin(), block.info.first_id);
  const auto begin = starts[static_cast<std::size_t>(comm.rank())];
  const FamilyContext here{&block, begin, begin + n};
  const auto announced = comm.sparse_exchange(announce(here, starts, to, block.info.cell_ids().end()));
  par::agree(comm, [&] { check_families(here, announced.item, block.info.cell_ids().end()); });

  for (const auto& family : announced.item)
    for (int k = 1; k < mesh::Lineage(family.lineage).family_size(); ++k)
      if (here.is_here(family.first + k)) to[static_cast<std::size_t>(family.first + k - begin)] = family.to;
  for (auto id = here.begin; id < here.end; ++id) {
    const auto lineage = here.lineage_of(id);
    const auto first = id - lineage.child();
    if (lineage.is_removable() && here.is_here(first))
      to[static_cast<std::size_t>(id - begin)] = to[static_cast<std::size_t>(first - begin)];
  }
  return to;
}

}  // namespace pamr::assemble
