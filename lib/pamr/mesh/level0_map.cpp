// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/level0_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/geometry/plane.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mesh {

namespace {

using geometry::Vec3;
using tet::edge_to_corner;

constexpr unsigned all_corners = 0xf;
constexpr double max_off_face = 1e-10;  ///< of its edge, what a node may seem to be off a face that it lies in

constexpr unsigned corners_of_edge(std::size_t e) { return 1U << edge_to_corner[e][0] | 1U << edge_to_corner[e][1]; }
constexpr unsigned corners_of_face(std::size_t f) { return all_corners & ~(1U << f); }

/// Bits of the edges and faces that a set of corners holds.
struct Within {
  unsigned edges = 0, faces = 0;
};
constexpr auto make_within() {
  std::array<Within, 16> within{};
  for (unsigned set = 0; set < within.size(); ++set) {
    for (std::size_t e = 0; e < 6; ++e) within[set].edges |= (corners_of_edge(e) & ~set) == 0 ? 1U << e : 0;
    for (std::size_t f = 0; f < 4; ++f) within[set].faces |= (corners_of_face(f) & ~set) == 0 ? 1U << f : 0;
  }
  return within;
}
constexpr auto within = make_within();

/// Barycentric coordinates, and the corners where they are not 0.
struct Place {
  std::array<double, 4> weight{};
  unsigned support = 0;
};

Place place_of(const std::array<double, 4>& weight) {
  Place place{weight, 0};
  for (std::size_t i = 0; i < 4; ++i) place.support |= weight[i] != 0 ? 1U << i : 0U;
  return place;
}

/// The part of a place on some of the corners, and their share of the weights.
struct Part {
  Place place;
  double share = 0;
};

Part part_of(const Place& whole, unsigned corners) {
  Part part;
  part.place.support = whole.support & corners;
  for (std::size_t i = 0; i < 4; ++i)
    if ((part.place.support >> i & 1U) != 0) part.share += whole.weight[i];
  for (std::size_t i = 0; i < 4; ++i)
    if ((part.place.support >> i & 1U) != 0) part.place.weight[i] = whole.weight[i] / part.share;
  return part;
}

/// `bulges`: bits of the cell's edges that have one. Pre: the support is not empty.
Vec3 quadratic(const Level0Cell& cell, unsigned bulges, const Place& at_place) {
  const auto& [w, support] = at_place;
  auto rest = support;
  const auto first = at(std::countr_zero(rest));
  auto point = w[first] * cell.corner[first];
  for (rest &= rest - 1; rest != 0; rest &= rest - 1) {
    const auto i = at(std::countr_zero(rest));
    point = point + w[i] * cell.corner[i];
  }
  for (rest = bulges & within[support].edges; rest != 0; rest &= rest - 1) {
    const auto e = at(std::countr_zero(rest));
    const auto [a, b] = edge_to_corner[e];
    point = point + (4 * w[at(a)] * w[at(b)]) * cell.bulge[e];
  }
  return point;
}

PatchList list_of(const std::array<std::int32_t, 2>& patch) {
  return {patch[0], patch[1] == patch[0] ? -1 : patch[1], -1, -1};
}

}  // namespace

bool is_end_of_patch(const Level0Cell& cell, std::size_t edge) {
  return cell.edge_patch[edge][0] != cell.edge_patch[edge][1] || ((cell.creases | cell.sharp_edges) >> edge & 1U) != 0;
}

namespace {

bool ends_somewhere(const MeshInfo& info, const Level0Cell& cell) {
  const auto ends = [&](std::int32_t patch) {
    const auto* surface = patch < 0 ? nullptr : info.surface_of(patch);
    return surface != nullptr && surface->creases() != nullptr;
  };
  for (std::size_t e = 0; e < 6; ++e)
    if (is_end_of_patch(cell, e) || ends(cell.edge_patch[e][0])) return true;
  return false;
}

}  // namespace

Level0Map::Level0Map(std::vector<Level0Cell> cells, GlobalId n_global_cells, const MeshInfo& info)
    : cells_(std::move(cells)), keep_(info.surfaces), n_global_cells_(n_global_cells) {
  std::map<PatchList, std::size_t> known;
  std::vector<std::array<std::size_t, 10>> which;
  constexpr auto none = static_cast<std::size_t>(-1);
  const auto find_or_add = [&](const PatchList& patch) {
    const auto [entry, is_new] = known.try_emplace(patch, surfaces_.size());
    if (is_new) surfaces_.push_back(surfaces_of_node(info, *keep_, patch));
    return entry->second;
  };
  for (const auto& cell : cells_) {
    auto& entry = which.emplace_back();
    entry.fill(none);
    for (std::size_t f = 0; f < 4; ++f)
      if (cell.face_patch[f] >= 0) entry[f] = find_or_add({cell.face_patch[f], -1, -1, -1});
    for (std::size_t e = 0; e < 6; ++e)
      if (cell.edge_patch[e][0] >= 0) entry[4 + e] = find_or_add(list_of(cell.edge_patch[e]));
  }
  const auto wall = [&](std::size_t entry) {
    return entry == none || surfaces_[entry].surface.empty() ? nullptr : &surfaces_[entry];
  };
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    auto& walls = walls_.emplace_back();
    walls.may_end = ends_somewhere(info, cells_[c]);
    for (std::size_t f = 0; f < 4; ++f) {
      walls.face[f] = wall(which[c][f]);
      walls.faces |= walls.face[f] != nullptr ? 1U << f : 0;
    }
    for (std::size_t e = 0; e < 6; ++e) {
      walls.edge[e] = wall(which[c][4 + e]);
      walls.edges |= walls.edge[e] != nullptr ? 1U << e : 0;
      walls.ends |= walls.edge[e] != nullptr && is_end_of_patch(cells_[c], e) ? 1U << e : 0;
      walls.bulges |= cells_[c].bulge[e] == Vec3{} ? 0 : 1U << e;
    }
  }
}

LocalId Level0Map::find(GlobalId row) const {
  if (cells_.empty()) return -1;
  const auto ahead = row - cells_.front().row;  // rows are most often without gaps
  if (ahead >= 0 && ahead < std::ssize(cells_) && cells_[at(ahead)].row == row) return static_cast<LocalId>(ahead);
  const auto found = std::lower_bound(cells_.begin(), cells_.end(), row,
                                      [](const Level0Cell& cell, GlobalId wanted) { return cell.row < wanted; });
  return found == cells_.end() || found->row != row ? -1 : static_cast<LocalId>(found - cells_.begin());
}

CornerWeights Level0Map::weights(LocalId cell, const Level0Key& key) const {
  const auto& node = cells_[at(cell)].node;
  CornerWeights weight{};
  int n_known = 0, n_found = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    n_known += key.node[k] >= 0 ? 1 : 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const bool is_here = key.node[k] == node[i];
      weight[i] += is_here ? key.weight[k] : 0;
      n_found += is_here ? 1 : 0;
    }
  }
  return n_found == n_known ? weight : CornerWeights{};
}

bool Level0Map::is_bent(LocalId cell, const CornerWeights& weight) const {
  const unsigned bent = cells_[at(cell)].bent_corners;
  for (std::size_t i = 0; i < 4; ++i)
    if (weight[i] != 0 && (bent >> i & 1U) != 0) return true;
  return false;
}

Mapped Level0Map::onto_face(LocalId cell, int face, const std::array<double, 4>& weight, Vec3 from,
                            KnownSteps* known) const {
  const auto projected = walls_[at(cell)].face[at(face)]->place(from + bounds_residual(cell, face, weight, known));
  Mapped mapped{projected.converged ? projected.point : from};
  mapped.patch[0] = cells_[at(cell)].face_patch[at(face)];
  mapped.is_reachable = projected.converged;
  return mapped;
}

/// As for the new nodes of any edge: see `refine::project`.
Mapped Level0Map::onto_edge(LocalId cell, int edge, Vec3 from) const {
  const auto& row = cells_[at(cell)];
  const auto& on = *walls_[at(cell)].edge[at(edge)];
  Mapped mapped{from};
  mapped.patch = list_of(row.edge_patch[at(edge)]);
  if ((row.creases >> edge & 1U) != 0) {
    mapped.point = on.surface.front()->project_to_seam(from);
    mapped.is_on_crease = true;
    return mapped;
  }
  const auto normal = row.beside[at(edge)];
  const auto corner = row.corner[at(edge_to_corner[at(edge)][0])];
  if ((row.sharp_edges >> edge & 1U) != 0) {
    const geometry::Plane of_face(corner, normal);
    const std::array<const geometry::Surface*, 2> both{&of_face, on.surface.front()};
    const auto projected = geometry::project_onto_all(both, from);
    mapped.is_reachable = projected.converged;
    if (projected.converged) mapped.point = projected.point;
    return mapped;
  }
  const auto projected = on.place(from);
  mapped.is_reachable = projected.converged;
  if (projected.converged) mapped.point = projected.point;
  if (!(normal == Vec3{})) {
    const double off = std::abs(dot(mapped.point - corner, normal)) / norm(normal);
    if (off > max_off_face * norm(row.corner[at(edge_to_corner[at(edge)][1])] - corner)) mapped.off_facets = off;
  }
  return mapped;
}

Vec3 Level0Map::edge_step(LocalId cell, int edge, const std::array<double, 4>& weight, KnownSteps* known) const {
  const auto find = [&] {
    const auto from = quadratic(cells_[at(cell)], walls_[at(cell)].bulges, place_of(weight));
    return onto_edge(cell, edge, from).point - from;
  };
  const auto [a, b] = edge_to_corner[at(edge)];
  return known == nullptr ? find() : known->of(edge, {weight[at(a)], weight[at(b)]}, find);
}

Vec3 Level0Map::bounds_residual(LocalId cell, int face, const std::array<double, 4>& weight, KnownSteps* known) const {
  const auto& walls = walls_[at(cell)];
  Vec3 wanted{};
  if (walls.ends == 0) return wanted;
  const Place here = place_of(weight);
  for (auto rest = walls.ends & within[here.support & corners_of_face(at(face))].edges; rest != 0; rest &= rest - 1) {
    const int e = std::countr_zero(rest);
    const auto part = part_of(here, corners_of_edge(at(e)));
    if (!(part.share > 0)) continue;
    wanted = wanted + (part.share * part.share) * edge_step(cell, e, part.place.weight, known);
  }
  return wanted;
}

Vec3 Level0Map::wall_residual(LocalId cell, const std::array<double, 4>& weight, KnownSteps* known) const {
  const auto& row = cells_[at(cell)];
  const auto& walls = walls_[at(cell)];
  if ((walls.faces | walls.edges) == 0) return {};
  const Place here = place_of(weight);
  Vec3 wanted{};
  const auto add = [&](double factor, Vec3 step) { wanted = wanted + factor * step; };
  const auto faces = walls.faces & within[here.support].faces;
  for (std::size_t k = 4; k-- > 0;) {  // in the order of their corners: 012, 013, 023, 123
    if ((faces >> k & 1U) == 0) continue;
    const auto part = part_of(here, corners_of_face(k));
    if (!(part.share > 0)) continue;  // only outside of the cell
    const auto from = quadratic(row, walls.bulges, part.place);
    add(part.share * part.share, onto_face(cell, static_cast<int>(k), part.place.weight, from, known).point - from);
  }
  for (auto rest = walls.edges & within[here.support].edges; rest != 0; rest &= rest - 1) {
    const int e = std::countr_zero(rest);
    const auto [a, b] = edge_to_corner[at(tet::opposite_edge(e))];  // opposite the faces at the edge
    const auto n_faces = static_cast<int>((faces >> a & 1U) + (faces >> b & 1U));
    if (n_faces == 1) continue;
    const auto part = part_of(here, corners_of_edge(at(e)));
    if (!(part.share > 0)) continue;
    add((1 - n_faces) * (part.share * part.share), edge_step(cell, e, part.place.weight, known));
  }
  return wanted;
}

std::optional<Mapped> Level0Map::place(LocalId cell, const CornerWeights& weight, KnownSteps* known) const {
  constexpr double unit = 1.0 / (std::int64_t{1} << Level0Key::one);
  const auto& row = cells_[at(cell)];
  const auto& walls = walls_[at(cell)];
  Place here;
  int n_corners = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (weight[i] == 0) continue;
    here.weight[i] = unit * static_cast<double>(weight[i]);
    here.support |= 1U << i;
    ++n_corners;
  }
  if ((here.support & row.bent_corners) == 0) return {};
  const auto point = quadratic(row, walls.bulges, here);
  if (const auto edge = walls.edges & within[here.support].edges; n_corners == 2 && edge != 0)
    return onto_edge(cell, std::countr_zero(edge), point);
  if (const auto face = walls.faces & within[here.support].faces; n_corners == 3 && face != 0)
    return onto_face(cell, std::countr_zero(face), here.weight, point, known);
  return Mapped{point + wall_residual(cell, here.weight, known)};
}

void send_level0_rows(const par::Comm& comm, DistMesh& mesh) {
  if (!has_level0(mesh)) return;
  const auto map = mesh.info.level0;
  const IdRange all{map->n_global_cells(), 0};
  std::vector<GlobalId> held, wanted;
  for (const auto& cell : map->cells()) held.push_back(cell.row);
  for (const auto row : mesh.find_cell_field(level0_cell_field)->integer())
    if (all.contains(row)) wanted.push_back(row);
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  const auto block = par::scatter_rows<Level0Cell>(comm, all, map->cells(), 1, held);
  auto cells = par::fetch_rows<Level0Cell>(comm, all, block, 1, wanted);
  mesh.info.level0 = std::make_shared<const Level0Map>(std::move(cells), map->n_global_cells(), mesh.info);
}

bool has_level0(const DistMesh& mesh) {
  const auto holds = [](const Field* field, int n_components) {
    return field != nullptr && field->holds_integers() && field->n_components == n_components;
  };
  return mesh.info.level0 != nullptr && holds(mesh.find_cell_field(level0_cell_field), 1) &&
         holds(mesh.find_node_field(level0_key_field), n_key_words);
}

void drop_level0(DistMesh& mesh) {
  mesh.info.level0 = nullptr;
  std::erase_if(mesh.node_fields, [](const NodeField& field) { return field.name == level0_key_field; });
  std::erase_if(mesh.cell_fields, [](const CellField& field) { return field.name == level0_cell_field; });
}

Level0View::Level0View(const DistMesh& mesh) {
  if (!has_level0(mesh)) return;
  rows_ = mesh.find_cell_field(level0_cell_field);
  keys_ = mesh.find_node_field(level0_key_field);
  map_ = mesh.info.level0.get();
}

CornerWeights Level0View::weights(LocalId row, LocalId node) const { return map_->weights(row, key_of(keys_, node)); }

LocalId Level0View::row_of(LocalId cell) const {
  const auto row = map_ == nullptr ? -1 : rows_->integer()[at(cell)];
  return row < 0 ? -1 : map_->find(row);
}

}  // namespace pamr::mesh
