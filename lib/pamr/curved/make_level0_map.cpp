// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/make_level0_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/curved/level0_edges.hpp"
#include "pamr/curved/level0_shapes.hpp"
#include "pamr/curved/optimize_bulges.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/cell_runs.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/offsets.hpp"
#include "pamr/mesh/periodic_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/interface_nodes.hpp"

namespace pamr::curved {

namespace {

using geometry::Vec3;
using mesh::tet::edge_to_corner;

constexpr double max_off_surface = 0.01;  ///< of an edge at a node of level 0
constexpr std::uint8_t n_layers = 2;      ///< edges from a coarse edge to the last bent node
constexpr std::uint8_t far_away = 255;

/// Level 0 with what is known of its nodes, too.
struct Level0 : Level0Edges {
  std::vector<std::uint8_t> distance;  ///< of each node from coarse edges, in edges; `far_away`: more than `n_layers`
  std::vector<std::uint8_t> is_bent;   ///< of each node
};

bool is_curved(const geometry::Surface* surface) { return surface != nullptr && !surface->is_flat(); }

/// Collective: one exchange of shared nodes for each layer and one before.
void find_distances(Level0& level0) {
  auto& distance = level0.distance;
  distance.assign(at(level0.mesh.n_nodes()), far_away);
  const par::Exchange exchange(level0.comm, level0.borders.nodes);
  const auto fold = [&] {
    par::fold_shared(exchange, distance,
                     [](std::uint8_t& mine, std::uint8_t theirs) { mine = std::min(mine, theirs); });
  };
  for (std::size_t e = 0; e < level0.n_edges(); ++e)
    if (level0.is_coarse[e] != 0)
      for (const auto node : level0.ends(e)) distance[at(node)] = 0;
  fold();
  for (std::uint8_t layer = 0; layer < n_layers; ++layer) {
    for (std::size_t e = 0; e < level0.n_edges(); ++e) {
      const auto [a, b] = level0.ends(e);
      for (const auto& [from, to] : {std::array{a, b}, std::array{b, a}})
        if (distance[at(from)] == layer && distance[at(to)] == far_away)
          distance[at(to)] = static_cast<std::uint8_t>(layer + 1);
    }
    fold();
  }
}

bool has_bent_node(const Level0& level0, LocalId cell) {
  const auto& nodes = level0.mesh.cell_to_node[at(cell)];
  return std::any_of(nodes.begin(), nodes.end(), [&](LocalId n) { return level0.is_bent[at(n)] != 0; });
}

/// Rules 2 to 4 of the page. Collective: an exchange of shared nodes and a reduction for each patch that comes in.
void find_bent_nodes(Level0& level0) {
  const auto& movables = level0.nodes.movables;
  std::vector<std::int64_t> is_bent_patch(level0.mesh.info.patches.size(), 0);
  const auto bend_patches_of = [&](std::size_t edge) {
    for (const auto p : movables[at(level0.movable[edge])].patch)
      if (p >= 0 && is_curved(level0.nodes.info.surface_of(p))) is_bent_patch[at(p)] = 1;
  };
  const auto is_on_bent_patch = [&](std::size_t edge) {
    const auto& patch = movables[at(level0.movable[edge])].patch;
    return std::any_of(patch.begin(), patch.end(), [&](int p) { return p >= 0 && is_bent_patch[at(p)] != 0; });
  };
  const auto has_bulge = [&](std::size_t edge) { return !(level0.bulge[edge] == Vec3{}); };
  for (std::size_t e = 0; e < level0.n_edges(); ++e)
    if (level0.is_coarse[e] != 0) bend_patches_of(e);
  level0.is_bent.assign(at(level0.mesh.n_nodes()), 0);
  for (std::size_t n = 0; n < level0.is_bent.size(); ++n) level0.is_bent[n] = level0.distance[n] <= n_layers ? 1 : 0;
  for (bool is_new = true; is_new;) {
    level0.comm.max_in_place(is_bent_patch);
    for (std::size_t e = 0; e < level0.n_edges(); ++e)
      if (has_bulge(e) && is_on_bent_patch(e))
        for (const auto node : level0.ends(e)) level0.is_bent[at(node)] = 1;
    par::fold_shared(par::Exchange(level0.comm, level0.borders.nodes), level0.is_bent,
                     [](std::uint8_t& mine, std::uint8_t theirs) { mine = std::max(mine, theirs); });
    const auto before = is_bent_patch;
    for (LocalId c = 0; c < level0.mesh.n_cells(); ++c) {
      if (!has_bent_node(level0, c)) continue;
      for (std::size_t e = 0; e < 6; ++e)
        if (const auto edge = at(level0.edge(c, e)); has_bulge(edge) && !is_on_bent_patch(edge)) bend_patches_of(edge);
    }
    is_new = level0.comm.any(is_bent_patch != before);
  }
}

/// The planes of the boundary faces at an edge.
struct FacePlanes {
  std::array<Vec3, 2> normal{};  ///< in ascending order, of the two signs the larger one
  int count = 0;
  bool is_fixed = false;

  void add(Vec3 n) {
    if (geometry::lexicographically_less(n, -n)) n = -n;
    if (count < 2) normal[at(count)] = n;
    if (++count == 2 && geometry::lexicographically_less(normal[1], normal[0])) std::swap(normal[0], normal[1]);
  }
  void add(const FacePlanes& other) {
    for (int i = 0; i < other.count; ++i) add(other.normal[at(std::min(i, 1))]);
    is_fixed = is_fixed || other.is_fixed;
  }
};

Vec3 unit_normal(const mesh::DistMesh& mesh, LocalId cell, std::size_t face) {
  std::array<Vec3, 3> p;
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = mesh.point(mesh.cell_to_node[at(cell)][at(mesh::tet::face_to_corner[face][k])]);
  std::sort(p.begin(), p.end(), geometry::lexicographically_less);
  const auto n = cross(p[1] - p[0], p[2] - p[0]);
  return (1 / norm(n)) * n;
}

/// Collective: one exchange of shared edges.
std::vector<FacePlanes> find_face_planes(const Level0& level0, const par::Pattern& shared_edges) {
  const auto& mesh = level0.mesh;
  const auto& info = level0.nodes.info;
  std::vector<FacePlanes> planes(level0.n_edges());
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto slot = mesh.cell_to_cell[at(c)][f];
      if (slot >= 0) continue;
      const int patch = mesh::slot_to_patch(slot);
      const auto* surface = info.surface_of(patch);
      const auto& corner = mesh::tet::face_to_corner[f];
      const auto normal = surface != nullptr && surface->is_flat()
                              ? surface->normal(mesh.point(mesh.cell_to_node[at(c)][at(corner[0])]))
                              : unit_normal(mesh, c, f);
      for (std::size_t k = 0; k < 3; ++k) {
        auto& of_edge = planes[at(level0.edge(c, at(mesh::tet::edge_of[at(corner[k])][at(corner[(k + 1) % 3])])))];
        of_edge.add(normal);
        if (info.patches[at(patch)].kind == mesh::periodic_kind) of_edge.is_fixed = true;
      }
    }
  par::fold_shared(par::Exchange(level0.comm, shared_edges), planes,
                   [](FacePlanes& mine, const FacePlanes& theirs) { mine.add(theirs); });
  return planes;
}

/// Of edges near coarse ones that lie in no curved wall. Those in the boundary stay in the planes of its faces.
std::vector<Freedom> find_freedom(const Level0& level0, const std::vector<std::uint8_t>& is_interface,
                                  const par::Pattern& shared_edges) {
  constexpr double parallel = 1e-9;
  const auto& distance = level0.distance;
  const auto planes = find_face_planes(level0, shared_edges);
  std::vector<Freedom> freedom(level0.n_edges());
  for (std::size_t e = 0; e < freedom.size(); ++e) {
    const auto [a, b] = level0.ends(e);
    const auto& [normal, n_faces, is_fixed] = planes[e];
    if (std::min(distance[at(a)], distance[at(b)]) > n_layers || level0.movable[e] >= 0 || is_interface[e] != 0 ||
        is_fixed || n_faces > 2)
      continue;
    if (n_faces == 0) {
      freedom[e].kind = Freedom::Kind::any;
    } else if (norm(cross(normal[0], normal[1])) < parallel) {
      freedom[e] = {Freedom::Kind::in_plane, normal[0]};
    } else {
      const auto along = level0.mesh.point(b) - level0.mesh.point(a);
      freedom[e] = {Freedom::Kind::along_line, (1 / norm(along)) * along};
    }
  }
  return freedom;
}

/// The bent cells with everything but the bulges of their free edges.
struct BentCells {
  std::vector<LocalId> cell;  ///< ascending
  std::vector<mesh::Level0Cell> row;
  std::vector<std::array<LocalId, 6>> edge;  ///< in the order of the row's corners
  GlobalId n_global = 0;
};

mesh::Level0Cell make_row(const Level0& level0, const mesh::InnerPatches& patches, LocalId c,
                          std::array<LocalId, 6>& edges) {
  const auto& mesh = level0.mesh;
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  const auto points = mesh.points(c);
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t j) { return geometry::lexicographically_less(points[i], points[j]); });
  mesh::Level0Cell row;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto node = mesh.cell_to_node[at(c)][order[i]];
    row.node[i] = mesh.node_global[at(node)];
    row.corner[i] = points[order[i]];
    if (level0.is_bent[at(node)] != 0) row.bent_corners = static_cast<std::uint8_t>(row.bent_corners | 1U << i);
    const int patch = patches.of_any({c, static_cast<int>(order[i])});
    if (patch >= 0 && is_curved(level0.nodes.info.surface_of(patch))) row.face_patch[i] = patch;
  }
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = edge_to_corner[e];
    const auto there = mesh::tet::edge_of[order[at(a)]][order[at(b)]];
    edges[e] = level0.edge(c, at(there));
    row.bulge[e] = level0.bulge[at(edges[e])];
    const auto i = level0.movable[at(edges[e])];
    if (i < 0) continue;
    const auto& m = level0.nodes.movables[at(i)];
    row.edge_patch[e] = {m.patch[0], m.patch[1] < 0 ? m.patch[0] : m.patch[1]};
    row.beside[e] = m.beside;
    const auto bit = static_cast<std::uint8_t>(1U << e);
    if (m.is_sharp) row.sharp_edges = static_cast<std::uint8_t>(row.sharp_edges | bit);
    if (m.is_on_crease) row.creases = static_cast<std::uint8_t>(row.creases | bit);
  }
  return row;
}

/// Collective.
BentCells find_bent_cells(const Level0& level0) {
  const auto& mesh = level0.mesh;
  const mesh::InnerPatches patches(mesh);
  BentCells bent;
  std::vector<std::uint8_t> counts(at(mesh.n_cells()), 0);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (has_bent_node(level0, c)) counts[at(c)] = 1;
  const auto in_runs = !mesh::cell_runs(level0.comm, mesh).empty();
  const auto first = mesh::cell_offsets(level0.comm, mesh, in_runs, counts, 0);
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (counts[at(c)] == 0) continue;
    bent.cell.push_back(c);
    bent.row.push_back(make_row(level0, patches, c, bent.edge.emplace_back()));
    bent.row.back().row = first[at(c)];
  }
  bent.n_global = level0.comm.sum(std::ssize(bent.cell));
  return bent;
}

/// Bent cells whose free edges are straight. Collective.
BulgeZone make_zone(const Level0& level0, const BentCells& bent, SampledWalls walls, refine::Bend bend) {
  const auto& numbering = level0.nodes.numbering;
  std::vector<std::uint8_t> is_interface(level0.n_edges(), 0);
  for (const auto node : refine::interface_nodes(level0.comm, level0.mesh, numbering, level0.nodes.placed.shared))
    is_interface[at(node - level0.mesh.n_nodes())] = 1;
  BulgeZone zone;
  zone.bends_straight_cells = bend == refine::Bend::all;
  for (const auto& row : bent.row) zone.corner.push_back(row.corner);
  zone.walls = std::move(walls);
  zone.cell_to_edge = bent.edge;
  zone.bulge = level0.bulge;
  const auto& shared = level0.nodes.placed.shared;
  const auto n_nodes = level0.mesh.n_nodes();
  zone.shared = par::restricted(
      shared, [&](std::size_t k) { return shared.item[k] < n_nodes ? invalid_local : shared.item[k] - n_nodes; });
  zone.freedom = find_freedom(level0, is_interface, zone.shared);
  return zone;
}

bool has_bent_node_off_surface(const Level0& level0) {
  const auto* field = level0.mesh.find_node_field(mesh::off_surface_field);
  if (field == nullptr || field->holds_integers()) return false;
  for (std::size_t e = 0; e < level0.n_edges(); ++e) {
    const auto [a, b] = level0.ends(e);
    const double most = max_off_surface * norm(level0.mesh.point(b) - level0.mesh.point(a));
    for (const auto node : {a, b})
      if (level0.is_bent[at(node)] != 0 && field->real()[at(node)] > most) return true;
  }
  return false;
}

/// Keys of the nodes of bent cells, and rows of the cells. Collective: one exchange of shared nodes.
void add_fields(const Level0& level0, const BentCells& bent, mesh::DistMesh& mesh) {
  std::vector<std::uint8_t> has_key(at(mesh.n_nodes()), 0);
  std::vector<std::int64_t> rows(at(mesh.n_cells()), -1);
  for (std::size_t i = 0; i < bent.cell.size(); ++i) {
    rows[at(bent.cell[i])] = bent.row[i].row;
    for (const auto node : mesh.cell_to_node[at(bent.cell[i])]) has_key[at(node)] = 1;
  }
  par::fold_flags(par::Exchange(level0.comm, level0.borders.nodes), has_key);
  auto keys = mesh::empty_key_field();
  for (LocalId n = 0; n < mesh.n_nodes(); ++n)
    mesh::append_key(keys, has_key[at(n)] != 0 ? mesh::Level0Key::of_node(mesh.node_global[at(n)]) : mesh::Level0Key{});
  mesh.node_fields.push_back(std::move(keys));
  mesh.cell_fields.push_back({mesh::level0_cell_field, "", 1, mesh::StorageType::int64, std::move(rows)});
}

/// Whether the map folds, and where. That it does not is what is proved; that it does may be seen.
std::string trouble_of(const Level0Report& report) {
  const auto at_place = [](geometry::Vec3 p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); };
  constexpr auto cure = "pamr-convert --repair splits these cells into eight";
  const auto& [proved, place] = report.shapes.determinant;
  if (!(proved > 0))
    return fmt::format("the map of level 0 is not proved to be free of folds near {} ({})", at_place(place), cure);
  for (const auto& worst : {report.shapes.sampled, report.shapes.all_splits})
    if (!(worst.value > 0))
      return fmt::format("curved walls fold the map of level 0 near {} ({})", at_place(worst.where), cure);
  return {};
}

}  // namespace

Level0Report make_level0_map(const par::Comm& comm, mesh::DistMesh& mesh, refine::Bend bend) {
  Level0Report report;
  const auto borders = mesh::find_borders(comm, mesh);
  Level0 level0{look_at_edges(comm, mesh, borders), {}, {}};
  report.n_coarse_edges = comm.sum(std::ssize(own_coarse_edges(level0)));
  const auto because = [&](std::string_view what) {
    if (report.n_coarse_edges == 0) return std::string(what);
    return fmt::format("{} edges of level 0 are longer than 0.2 of the radius of curvature of their wall, and {}",
                       report.n_coarse_edges, what);
  };
  if (bend == refine::Bend::all)
    level0.distance.assign(at(mesh.n_nodes()), 0);
  else if (report.n_coarse_edges == 0)
    return report;
  else
    find_distances(level0);
  find_bent_nodes(level0);
  if (comm.any(has_bent_node_off_surface(level0))) {
    report.trouble = because("nodes there stay off their surfaces, so that there is no map of level 0");
    return report;
  }
  auto bent = find_bent_cells(level0);
  report.n_bent_cells = bent.n_global;
  BulgeZone zone;
  {
    const mesh::Level0Map straight_inside(bent.row, bent.n_global, level0.nodes.info);
    zone = make_zone(level0, bent, sample_walls(straight_inside), bend);
    report.smallest_before = sampled_jacobian(comm, straight_inside, zone.walls).value;
  }
  const auto found = optimize_bulges(comm, zone);
  report.iterations = found.iterations;
  for (std::size_t i = 0; i < bent.row.size(); ++i)
    for (std::size_t e = 0; e < 6; ++e) bent.row[i].bulge[e] = found.bulge[at(bent.edge[i][e])];
  mesh::drop_level0(mesh);  // fields that were left of another map
  add_fields(level0, bent, mesh);
  mesh.info = std::move(level0.nodes.info);
  mesh.info.level0 = std::make_shared<const mesh::Level0Map>(std::move(bent.row), bent.n_global, mesh.info);
  report.shapes = level0_shapes(comm, *mesh.info.level0, zone.walls);
  report.smallest = report.shapes.sampled.value;
  if (const auto trouble = trouble_of(report); !trouble.empty()) report.trouble = because(trouble);
  return report;
}

}  // namespace pamr::curved
