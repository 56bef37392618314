// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_refine.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "support/reference.hpp"
#include "support/reference_close.hpp"
#include "support/reference_split.hpp"
#include "support/reference_walls.hpp"

namespace pamr::test {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// First members of the families of which a member is split while the family stays: its other members are broken.
std::set<GlobalId> broken_families(const std::vector<Piece>& cell, const ReferenceClosing& closing) {
  std::set<GlobalId> broken;
  for (std::size_t c = 0; c < cell.size(); ++c) {
    const auto first = static_cast<GlobalId>(c) - cell[c].lineage.child();
    if (cell[c].lineage.is_removable() && closing.family.count(first) == 0 &&
        !edges_within(cell[c], closing.marked).empty())
      broken.insert(first);
  }
  return broken;
}

/// A middle of the cell's edges that does not lie where the straight edge has it.
bool has_moved(const Piece& piece, const Middles& middle, const Points& point) {
  for (const int e : edges_within(piece, middle)) {
    const auto [a, b] = piece.edge(e);
    if (!(point[at(middle.at({a, b}))] == geometry::midpoint(point[at(a)], point[at(b)]))) return true;
  }
  return false;
}

/// Children of all old cells, in the old order; those of a family that is taken back in the place of its first member.
struct Offspring {
  std::vector<Piece> piece;
  std::vector<GlobalId> from;  ///< old cell, or first member
};

Offspring split_all(const std::vector<Piece>& cell, const ReferenceClosing& closing, const Points& point) {
  const auto broken = broken_families(cell, closing);
  Middles middle;  // of marked edges
  for (const auto& edge : closing.marked) middle[edge] = closing.middle.at(edge);
  Offspring offspring;
  for (std::size_t c = 0; c < cell.size(); ++c) {
    const auto id = static_cast<GlobalId>(c), first = id - cell[c].lineage.child();
    const bool is_undone = cell[c].lineage.is_removable() && closing.family.count(first) != 0;
    if (is_undone && id != first) continue;
    std::vector<Piece> children{cell[c]};
    if (is_undone)
      children = closing.children.at(first);
    else if (const auto edges = edges_within(cell[c], middle); edges == all_six)
      children = split_in_eight(cell[c], middle, point, has_moved(cell[c], middle, point));
    else if (!edges.empty())
      children = closing.children.at(id);
    if (children.size() == 1 && cell[c].lineage.is_removable() && broken.count(first) != 0)
      children.front().lineage = cell[c].lineage.broken();
    for (const auto& piece : children) {
      offspring.piece.push_back(piece);
      offspring.from.push_back(id);
    }
  }
  return offspring;
}

/// New numbers of all nodes: old ones keep theirs; new ones by the lowest old cell at their edge, then by the edge's
/// number in it.
std::vector<GlobalId> number_nodes(const std::vector<Piece>& cell, std::size_t n_old, const ReferenceClosing& closing) {
  std::vector<GlobalId> to_final(closing.point.size(), invalid_global);
  GlobalId next = 0;
  for (std::size_t i = 0; i < n_old; ++i) to_final[i] = next++;
  for (const auto& piece : cell)
    for (const int e : edges_within(piece, closing.marked)) {
      auto& number = to_final[at(closing.middle.at(piece.edge(e)))];
      if (number == invalid_global) number = next++;
    }
  if (next != static_cast<GlobalId>(to_final.size())) throw std::logic_error("a new node lies on no old cell's edge");
  return to_final;
}

/// The new nodes that the map of level 0 places.
std::map<Edge, geometry::Vec3> mapped_middles(const std::vector<Piece>& cell, const ReferenceLevel0& level0,
                                              const ReferenceClosing& closing) {
  std::map<Edge, geometry::Vec3> mapped;
  for (const auto& piece : cell)
    for (const int e : edges_within(piece, closing.marked))
      if (const auto place = level0.mapped_middle(piece.row, piece.edge(e)))
        if (!(mapped.emplace(piece.edge(e), *place).first->second == *place))
          throw std::logic_error("level 0: two cells at a node do not agree about its place");
  return mapped;
}

/// Puts new nodes where the map of level 0 wants them, others on edges in the boundary onto their surfaces. Returns the
/// largest move over its edge's length.
double project(const std::vector<Piece>& cell, const SurfaceOfPatch& surface_of_patch, const ReferenceLevel0& level0,
               const ReferenceClosing& closing, Points& point) {
  const auto faces = faces_at_edges(cell);
  auto targets = mapped_middles(cell, level0, closing);
  for (const auto& edge : closing.marked)
    if (const auto at_edge = faces.find(edge); at_edge != faces.end() && targets.count(edge) == 0)
      if (const auto target = target_in_wall(edge, at_edge->second, surface_of_patch, point))
        targets[edge] = target->point;
  double largest = 0;
  for (const auto& [edge, target] : targets) {
    auto& p = point[at(closing.middle.at(edge))];
    largest = std::max(largest, norm(target - p) / norm(point[at(edge.first)] - point[at(edge.second)]));
    p = target;
  }
  return largest;
}

/// The rows and keys of the new cells and nodes.
ReferenceLevel0 descend(const ReferenceLevel0& level0, const std::vector<Piece>& fine, const ReferenceClosing& closing,
                        const std::vector<GlobalId>& to_final) {
  if (level0.map == nullptr) return {};
  ReferenceLevel0 below{level0.map, {}, level0.key};
  for (const auto& piece : fine) below.row.push_back(piece.row);
  below.key.resize(to_final.size());
  for (const auto& edge : closing.marked)
    below.key[at(to_final[at(closing.middle.at(edge))])] =
        halfway(level0.key[at(edge.first)], level0.key[at(edge.second)]);
  return below;
}

/// Smallest barycentric coordinate of a point in a cell.
double depth_in(const geometry::TetPoints& p, geometry::Vec3 x) {
  double least = 1;
  for (std::size_t i = 0; i < 4; ++i) {
    auto q = p;
    q[i] = x;
    least = std::min(least, geometry::volume(q) / geometry::volume(p));
  }
  return least;
}

/// The old cell that holds a point of cell `from`, or of the family that began with it and is taken back: to rounding,
/// and the first of several.
GlobalId cell_with(const ReferenceClosing& closing, GlobalId from, geometry::Vec3 x) {
  const auto found = closing.family.find(from);
  if (found == closing.family.end()) return from;
  std::vector<double> depth;
  for (const auto& member : found->second.member) depth.push_back(depth_in(points_of(member, closing.point), x));
  auto holds = std::find_if(depth.begin(), depth.end(), [](double d) { return d >= -0x1p-40; });
  if (holds == depth.end()) holds = std::max_element(depth.begin(), depth.end());
  return from + (holds - depth.begin());
}

/// Neighbors by a map of faces; a face of one cell has the patch that it inherited, and no other face has one.
void link(const std::vector<Piece>& piece, mesh::BlockMesh& mesh) {
  mesh.cell_to_cell = reference_neighbors(mesh.cell_to_node);
  for (std::size_t c = 0; c < piece.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const bool is_outside = mesh.cell_to_cell[c][f] < 0;
      if (is_outside != (piece[c].patch[f] >= 0)) throw std::logic_error("a hanging node, or a patch inside the mesh");
      if (is_outside) mesh.cell_to_cell[c][f] = -(piece[c].patch[f] + 1);
    }
}

/// Where new nodes go.
struct Walls {
  const SurfaceOfPatch& surface_of_patch;
  const ReferenceLevel0& level0;
};

/// One pass: what a closing asks for.
ReferenceRefinement carry_out(const mesh::BlockMesh& whole, const std::vector<Piece>& cell,
                              const ReferenceClosing& closing, const Walls& walls) {
  Points straight = closing.point;
  for (const auto& [a, b] : closing.marked)
    straight[at(closing.middle.at({a, b}))] = midpoint(straight[at(a)], straight[at(b)]);
  auto point = straight;
  ReferenceRefinement result;
  if (!walls.surface_of_patch.empty())
    result.largest_move = project(cell, walls.surface_of_patch, walls.level0, closing, point);
  auto offspring = split_all(cell, closing, point);
  result.is_positive = all_positive(offspring.piece, point);
  result.families_rebuilt = static_cast<std::int64_t>(closing.family.size());
  result.families_kept = closing.families_kept;
  result.from = offspring.from;
  for (std::size_t c = 0; c < offspring.piece.size(); ++c) {
    const auto p = points_of(offspring.piece[c], straight);
    result.centroid.push_back(0.25 * (p[0] + p[1] + p[2] + p[3]));
    result.parent.push_back(cell_with(closing, result.from[c], result.centroid[c]));
  }

  const auto to_final = number_nodes(cell, whole.node_position.size(), closing);
  result.level0 = descend(walls.level0, offspring.piece, closing, to_final);
  auto& mesh = result.mesh;
  mesh.info = whole.info;
  mesh.node_position.resize(point.size());
  for (std::size_t i = 0; i < point.size(); ++i) mesh.node_position[at(to_final[i])] = point[i];
  for (auto& piece : offspring.piece) {
    for (auto& node : piece.corner) node = to_final[at(node)];
    mesh.cell_to_node.push_back(piece.corner);
    mesh.lineage.push_back(piece.lineage);
  }
  mesh.info.n_global_nodes = static_cast<GlobalId>(point.size());
  mesh.info.n_global_cells = static_cast<GlobalId>(mesh.cell_to_node.size());
  link(offspring.piece, mesh);
  return result;
}

/// Flags of the cells that are, or belong to, a flagged base cell.
std::vector<std::uint8_t> flag(const std::vector<Piece>& cell, const std::set<CornerSet>& flagged) {
  std::vector<std::uint8_t> flags;
  const auto base = base_cells_of(cell);
  for (std::size_t c = 0; c < cell.size(); ++c)
    flags.push_back(flagged.count(base[c]) + flagged.count(corners_of(cell[c])) != 0 ? 1 : 0);
  return flags;
}

/// After a pass: what was flagged and has not become eight is flagged again. A cell that is still there has its flag;
/// of a cell or family that has been closed, all closure cells.
std::vector<std::uint8_t> flag_again(const std::vector<Piece>& cell, const std::vector<std::uint8_t>& flags,
                                     const ReferenceClosing& closing, const std::vector<Piece>& fine,
                                     const std::vector<GlobalId>& from) {
  std::vector<std::uint8_t> again;
  for (std::size_t c = 0; c < fine.size(); ++c) {
    const auto& old = cell[at(from[c])];
    const auto n_old = closing.family.count(from[c]) != 0 ? old.lineage.family_size() : 1;
    const auto begin = flags.begin() + from[c];
    const bool was_flagged = std::any_of(begin, begin + n_old, [](auto flag) { return flag != 0; });
    again.push_back(was_flagged && fine[c].lineage.level() == old.lineage.level() ? 1 : 0);
  }
  return again;
}

/// Parents of the closure families that came of the given cells. `from`: the old (first) cell of each new one.
std::set<CornerSet> families_within(const std::vector<Piece>& fine, const std::vector<GlobalId>& from,
                                    const std::set<GlobalId>& cells) {
  std::set<CornerSet> parents;
  const auto base = base_cells_of(fine);
  for (std::size_t c = 0; c < fine.size(); ++c)
    if (fine[c].lineage.is_removable() && cells.count(from[c]) != 0) parents.insert(base[c]);
  return parents;
}

/// The second pass after the first.
ReferenceRefinement joined(const ReferenceRefinement& first, const ReferenceClosing& first_closing,
                           ReferenceRefinement second) {
  for (std::size_t c = 0; c < second.parent.size(); ++c)
    second.parent[c] = cell_with(first_closing, first.from[at(second.parent[c])], second.centroid[c]);
  second.families_rebuilt += first.families_rebuilt;
  second.families_kept += first.families_kept;
  second.early_passes += first.early_passes;
  second.largest_move = std::max(first.largest_move, second.largest_move);
  second.is_positive = first.is_positive && second.is_positive;
  return second;
}

/// Passes of `removable` until nothing is to be split early.
ReferenceRefinement refine_removable(const mesh::BlockMesh& whole, const ReferenceRequest& request, double shape_floor,
                                     const Walls& walls) {
  const auto cell = pieces_of(whole, walls.level0);
  const auto closing = close_removable(cell, whole.node_position, walls.level0, request, shape_floor);
  if (closing.early.empty()) return carry_out(whole, cell, closing, walls);

  // those alone are split first, and all that follows from them; what is early then is assessed afterwards
  const ReferenceRequest early{flag(cell, closing.early), request.assess};
  const auto early_closing = close_removable(cell, whole.node_position, walls.level0, early, shape_floor);
  if (early_closing.families_kept > 0) return carry_out(whole, cell, closing, walls);
  auto first = carry_out(whole, cell, early_closing, walls);
  ++first.early_passes;
  const auto fine = pieces_of(first.mesh);
  std::set<GlobalId> unsettled;
  for (const auto& [id, family] : early_closing.family)
    if (early_closing.early.count(corners_of(family.parent)) != 0) unsettled.insert(id);
  const ReferenceRequest left{flag_again(cell, request.flags, early_closing, fine, first.from),
                              families_within(fine, first.from, unsettled)};
  return joined(first, early_closing,
                refine_removable(first.mesh, left, shape_floor, {walls.surface_of_patch, first.level0}));
}

}  // namespace

ReferenceRefinement reference_refine(const mesh::BlockMesh& whole, const std::vector<std::uint8_t>& flags,
                                     refine::QualityControl policy, double shape_floor,
                                     const SurfaceOfPatch& surface_of_patch, const ReferenceLevel0& level0) {
  const Walls walls{surface_of_patch, level0};
  if (policy == refine::QualityControl::removable) return refine_removable(whole, {flags, {}}, shape_floor, walls);
  const auto cell = pieces_of(whole, level0);
  return carry_out(whole, cell, close_by_templates(cell, whole.node_position, flags, policy), walls);
}

}  // namespace pamr::test
