// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/meshes.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <tuple>
#include <utility>

#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/surface_toml.hpp"
#include "pamr/mesh/families.hpp"

namespace pamr::test {

namespace {

using Quad = std::array<GlobalId, 4>;

/// The same draws with every standard library (its distributions are not specified to the bit).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  double symmetric() { return 2 * static_cast<double>(engine_() >> 11U) * 0x1p-53 - 1; }
  template <class T>
  void shuffle(std::vector<T>& values) {
    for (auto i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
  }

 private:
  std::mt19937_64 engine_;
};

/// Joins the vectors of all ranks in rank order, on every rank.
template <class T>
std::vector<T> join(const par::Comm& comm, const std::vector<T>& here) {
  std::vector<T> all;
  for (Rank r = 0; r < comm.size(); ++r) {
    const auto part = comm.broadcast(here, r);
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

/// Rows `[begin, end)` of a field.
mesh::Field slice(const mesh::Field& field, GlobalId begin, GlobalId end) {
  auto part = field;
  const auto width = static_cast<std::ptrdiff_t>(field.n_components);
  std::visit(
      [&]<class T>(std::vector<T>& values) {
        values = std::vector<T>(values.begin() + begin * width, values.begin() + end * width);
      },
      part.value);
  return part;
}

/// Row `i` of the result is row `new_to_old[i]` of the field.
mesh::Field reorder(const mesh::Field& field, const std::vector<GlobalId>& new_to_old) {
  auto result = field;
  const auto width = static_cast<std::size_t>(field.n_components);
  std::visit(
      [&]<class T>(std::vector<T>& values) {
        const auto old = values;
        for (std::size_t i = 0; i < new_to_old.size(); ++i)
          for (std::size_t k = 0; k < width; ++k)
            values[i * width + k] = old[static_cast<std::size_t>(new_to_old[i]) * width + k];
      },
      result.value);
  return result;
}

std::vector<GlobalId> inverse(const std::vector<GlobalId>& permutation) {
  std::vector<GlobalId> result(permutation.size());
  for (std::size_t i = 0; i < permutation.size(); ++i)
    result[static_cast<std::size_t>(permutation[i])] = static_cast<GlobalId>(i);
  return result;
}

bool is_valid(const mesh::BlockMesh& whole, const Quad& n) {
  const auto at = [&](GlobalId id) { return whole.node_position[static_cast<std::size_t>(id)]; };
  const geometry::TetPoints p{at(n[0]), at(n[1]), at(n[2]), at(n[3])};
  return geometry::is_positive(p[0], p[1], p[2], p[3]) && geometry::mean_ratio(p) > 1e-3;
}

/// Moves inner nodes by up to `size`, and back halfway where a cell would turn.
void move_inner_nodes(mesh::BlockMesh& whole, Dice& dice, double size) {
  const auto original = whole.node_position;
  for (auto& p : whole.node_position) {
    const auto inside = [](double x) { return x > 0 && x < 1; };
    if (inside(p.x) && inside(p.y) && inside(p.z))
      p = p + size * geometry::Vec3{dice.symmetric(), dice.symmetric(), dice.symmetric()};
  }
  for (bool again = true; again;) {
    again = false;
    for (const auto& nodes : whole.cell_to_node) {
      if (is_valid(whole, nodes)) continue;
      again = true;
      for (const auto id : nodes) {
        auto& p = whole.node_position[static_cast<std::size_t>(id)];
        p = geometry::midpoint(p, original[static_cast<std::size_t>(id)]);
      }
    }
  }
}

/// Families as they lie in the file: first cell and number of cells.
std::vector<std::pair<GlobalId, GlobalId>> families_of(const mesh::BlockMesh& whole) {
  std::vector<std::pair<GlobalId, GlobalId>> families;
  for (GlobalId c = 0; c < whole.info.n_global_cells;) {
    GlobalId n = 1;
    if (!whole.lineage.empty() && whole.lineage[static_cast<std::size_t>(c)].is_removable())
      n = whole.lineage[static_cast<std::size_t>(c)].family_size();
    families.push_back({c, n});
    c += n;
  }
  return families;
}

/// One of the 12 even permutations of four corners.
std::array<std::size_t, 4> even_permutation(Dice& dice) {
  std::array<std::size_t, 4> p{0, 1, 2, 3};
  for (int turns = 0; turns < 2; ++turns) {
    const auto keep = dice.below(4);
    const auto [a, b, c] = mesh::ascending_corners(keep);
    for (auto times = dice.below(3); times > 0; --times) std::tie(p[a], p[b], p[c]) = std::tuple(p[b], p[c], p[a]);
  }
  return p;
}

}  // namespace

mesh::BlockMesh numbered_from(GlobalId first_id, mesh::BlockMesh block) {
  const auto step = first_id - block.info.first_id;
  block.info.first_id = first_id;
  block.first_cell += step;
  for (auto& nodes : block.cell_to_node)
    for (auto& node : nodes) node += step;
  for (auto& neighbors : block.cell_to_cell)
    for (auto& neighbor : neighbors)
      if (neighbor >= 0) neighbor += step;
  return block;
}

mesh::BlockMesh gather(const par::Comm& comm, const mesh::BlockMesh& block) {
  mesh::BlockMesh whole;
  whole.info = block.info;
  whole.first_cell = block.info.first_id;
  whole.cell_to_node = join(comm, block.cell_to_node);
  whole.cell_to_cell = join(comm, block.cell_to_cell);
  whole.lineage = join(comm, block.lineage);
  whole.node_position = join(comm, block.node_position);
  whole.cell_fields = block.cell_fields;
  whole.node_fields = block.node_fields;
  for (auto* fields : {&whole.cell_fields, &whole.node_fields})
    for (auto& field : *fields) std::visit([&](auto& values) { values = join(comm, values); }, field.value);
  return whole;
}

mesh::BlockMesh gather(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::vector<Quad> nodes, neighbors;
  for (std::size_t c = 0; c < mesh.cell_to_node.size(); ++c) {
    Quad n{}, nb{};
    for (std::size_t i = 0; i < 4; ++i) {
      n[i] = mesh.node_global[static_cast<std::size_t>(mesh.cell_to_node[c][i])];
      const auto slot = mesh.cell_to_cell[c][i];
      nb[i] = mesh.is_own(slot)     ? mesh.cell_global[static_cast<std::size_t>(slot)]
              : mesh.is_ghost(slot) ? mesh.ghost_global[static_cast<std::size_t>(slot - mesh.n_cells())]
                                    : slot;
    }
    nodes.push_back(n);
    neighbors.push_back(nb);
  }
  const auto rows_of = [&](std::vector<GlobalId> ids) {
    for (auto& id : ids) id -= mesh.info.first_id;
    return ids;
  };
  const auto cell_order = inverse(rows_of(join(comm, mesh.cell_global)));
  const auto all_nodes = join(comm, nodes);
  const auto all_neighbors = join(comm, neighbors);
  const auto all_lineage = join(comm, mesh.lineage);
  mesh::BlockMesh whole;
  whole.info = mesh.info;
  whole.first_cell = mesh.info.first_id;
  for (const auto at : cell_order) {
    whole.cell_to_node.push_back(all_nodes[static_cast<std::size_t>(at)]);
    whole.cell_to_cell.push_back(all_neighbors[static_cast<std::size_t>(at)]);
    whole.lineage.push_back(all_lineage[static_cast<std::size_t>(at)]);
  }
  const auto node_global = rows_of(join(comm, mesh.node_global));
  std::vector<GlobalId> node_order(static_cast<std::size_t>(mesh.info.n_global_nodes), 0);
  for (std::size_t i = 0; i < node_global.size(); ++i)
    node_order[static_cast<std::size_t>(node_global[i])] = static_cast<GlobalId>(i);
  const auto position = join(comm, mesh.node_position);
  for (const auto at : node_order) whole.node_position.push_back(position[static_cast<std::size_t>(at)]);
  const auto gather_fields = [&](const std::vector<mesh::Field>& fields, const std::vector<GlobalId>& order) {
    std::vector<mesh::Field> all;
    for (auto field : fields) {
      std::visit([&](auto& values) { values = join(comm, values); }, field.value);
      field = reorder(field, order);
      std::visit([&](auto& values) { values.resize(order.size() * static_cast<std::size_t>(field.n_components)); },
                 field.value);
      all.push_back(field);
    }
    return all;
  };
  whole.cell_fields = gather_fields(mesh.cell_fields, cell_order);
  whole.node_fields = gather_fields(mesh.node_fields, node_order);
  return whole;
}

mesh::BlockMesh cut(const par::Comm& comm, const mesh::BlockMesh& whole, const std::vector<GlobalId>& begin) {
  const auto rank = static_cast<std::size_t>(comm.rank());
  const auto first = begin[rank], last = rank + 1 < begin.size() ? begin[rank + 1] : whole.info.n_global_cells;
  const auto part = [](const auto& values, GlobalId from, GlobalId to) {
    if (values.empty()) return values;
    return std::decay_t<decltype(values)>(values.begin() + from, values.begin() + to);
  };
  mesh::BlockMesh block;
  block.info = whole.info;
  block.first_cell = whole.info.first_id + first;
  block.cell_to_node = part(whole.cell_to_node, first, last);
  block.cell_to_cell = part(whole.cell_to_cell, first, last);
  block.lineage = part(whole.lineage, first, last);
  for (const auto& field : whole.cell_fields) block.cell_fields.push_back(slice(field, first, last));
  const auto nodes = par::block_range(whole.info.n_global_nodes, comm.rank(), comm.size());
  block.node_position = part(whole.node_position, nodes.begin, nodes.end);
  for (const auto& field : whole.node_fields) block.node_fields.push_back(slice(field, nodes.begin, nodes.end));
  return block;
}

mesh::BlockMesh cut(const par::Comm& comm, const mesh::BlockMesh& whole) {
  std::vector<GlobalId> begin;
  for (Rank r = 0; r < comm.size(); ++r)
    begin.push_back(par::block_range(whole.info.n_global_cells, r, comm.size()).begin);
  return cut(comm, whole, begin);
}

geometry::SharedSurfaces surfaces_of(const std::string& toml) {
  return std::make_shared<const geometry::SurfaceSet>(geometry::surfaces_from_toml(toml, "test"));
}

mesh::BlockMesh kuhn_cube(const par::Comm& comm, int n) {
  auto block = assemble::kuhn_cube(comm, n);
  block.info.surfaces = geometry::no_surfaces();
  for (auto& patch : block.info.patches) patch.surface = -1;
  return block;
}

mesh::BlockMesh random_mesh(const par::Comm& comm, std::uint64_t seed, int n) {
  auto whole = gather(comm, kuhn_cube(comm, n));
  Dice dice(mix(seed));
  move_inner_nodes(whole, dice, 0.3 / n);
  return permute(comm, cut(comm, whole), mix(seed + 1));
}

std::vector<Rank> random_destinations(const par::Comm& comm, const mesh::BlockMesh& block, std::uint64_t seed) {
  std::vector<Rank> to;
  for (std::size_t c = 0; c < block.cell_to_node.size(); ++c)
    to.push_back(
        static_cast<Rank>(combine(mix(seed), static_cast<std::uint64_t>(block.first_cell - block.info.first_id) + c) %
                          static_cast<std::uint64_t>(comm.size())));
  return to;
}

mesh::BlockMesh permute(const par::Comm& comm, const mesh::BlockMesh& block, std::uint64_t seed) {
  const auto old = gather(comm, block);
  Dice dice(seed);
  auto families = families_of(old);
  dice.shuffle(families);
  std::vector<GlobalId> new_to_old_cell;
  for (const auto& [first, n] : families)
    for (GlobalId k = 0; k < n; ++k) new_to_old_cell.push_back(first + k);
  const auto old_to_new_cell = inverse(new_to_old_cell);
  std::vector<GlobalId> new_to_old_node(old.node_position.size());
  std::iota(new_to_old_node.begin(), new_to_old_node.end(), 0);
  dice.shuffle(new_to_old_node);
  const auto old_to_new_node = inverse(new_to_old_node);

  auto whole = old;
  for (std::size_t c = 0; c < new_to_old_cell.size(); ++c) {
    const auto from = static_cast<std::size_t>(new_to_old_cell[c]);
    const bool is_member = !old.lineage.empty() && old.lineage[from].is_closure();
    const auto corner = is_member ? std::array<std::size_t, 4>{0, 1, 2, 3} : even_permutation(dice);
    if (!old.lineage.empty()) whole.lineage[c] = old.lineage[from];
    for (std::size_t i = 0; i < 4; ++i) {
      whole.cell_to_node[c][i] = old_to_new_node[static_cast<std::size_t>(old.cell_to_node[from][corner[i]])];
      if (old.cell_to_cell.empty()) continue;
      const auto neighbor = old.cell_to_cell[from][corner[i]];
      whole.cell_to_cell[c][i] = neighbor < 0 ? neighbor : old_to_new_cell[static_cast<std::size_t>(neighbor)];
    }
  }
  for (std::size_t i = 0; i < new_to_old_node.size(); ++i)
    whole.node_position[i] = old.node_position[static_cast<std::size_t>(new_to_old_node[i])];
  for (auto& field : whole.cell_fields) field = reorder(field, new_to_old_cell);
  for (auto& field : whole.node_fields) field = reorder(field, new_to_old_node);
  return cut(comm, whole);
}

mesh::BlockMesh without_neighbors(mesh::BlockMesh block) {
  block.cell_to_cell.clear();
  block.info.patches.clear();
  return block;
}

mesh::BlockMesh small_mesh(const par::Comm& comm, std::vector<geometry::Vec3> nodes,
                           std::vector<std::array<GlobalId, 4>> cells) {
  mesh::BlockMesh whole;
  whole.info.n_global_nodes = static_cast<GlobalId>(nodes.size());
  whole.info.n_global_cells = static_cast<GlobalId>(cells.size());
  whole.info.patches = {{"wall", "patch"}};
  whole.node_position = std::move(nodes);
  whole.cell_to_node = std::move(cells);
  return cut(comm, whole);
}

mesh::BlockMesh closure_family(mesh::FamilyKind kind, int index) {
  mesh::BlockMesh whole;
  whole.node_position = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Quad parent{0, 1, 2, 3};
  const auto add_middle = [&](std::size_t i, std::size_t j) {
    whole.node_position.push_back(geometry::midpoint(whole.node_position[i], whole.node_position[j]));
    return static_cast<GlobalId>(whole.node_position.size()) - 1;
  };
  const auto add_cell = [&](const Quad& nodes) {
    whole.lineage.push_back(mesh::Lineage(kind, index, static_cast<int>(whole.cell_to_node.size()), 0));
    whole.cell_to_node.push_back(nodes);
  };
  if (kind == mesh::FamilyKind::edge) {
    const auto corner = mesh::tet::edge_to_corner[static_cast<std::size_t>(index)];
    const auto i = static_cast<std::size_t>(corner[0]), j = static_cast<std::size_t>(corner[1]);
    auto first = parent, second = parent;
    first[j] = second[i] = add_middle(i, j);
    add_cell(first);
    add_cell(second);
  } else {
    const auto corner = mesh::ascending_corners(static_cast<std::size_t>(index));
    const auto a = corner[0], b = corner[1], c = corner[2];
    const auto ab = add_middle(a, b), ac = add_middle(a, c), bc = add_middle(b, c);
    const auto with = [&](GlobalId at_a, GlobalId at_b, GlobalId at_c) {
      auto nodes = parent;
      nodes[a] = at_a;
      nodes[b] = at_b;
      nodes[c] = at_c;
      add_cell(nodes);
    };
    with(parent[a], ab, ac);
    with(ab, parent[b], bc);
    with(ac, bc, parent[c]);
    with(bc, ac, ab);
  }
  whole.info.n_global_nodes = static_cast<GlobalId>(whole.node_position.size());
  whole.info.n_global_cells = static_cast<GlobalId>(whole.cell_to_node.size());
  whole.info.patches = {{"wall", "patch"}};
  return whole;
}

}  // namespace pamr::test
