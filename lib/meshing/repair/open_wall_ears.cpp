// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "meshing/repair/wall_ears.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/gather_few.hpp"

namespace pamr::meshing {

namespace {

using geometry::TetPoints;
using geometry::Vec3;
constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }
constexpr int inside = -1;           ///< patch of a face that is not in the boundary
constexpr double least_worst = 0.2;  ///< mean ratio that no cell at a moved node gets below, unless it begins below
constexpr double good_enough = 0.3;  ///< mean ratio from which on nodes of the old mesh stay where they are
constexpr int max_sweeps = 8;
constexpr const char* ledger_field = "off_surface";

/// A cell to be split or at a node that moves, or a part of one.
struct Piece {
  GlobalId cell = 0;             ///< of the old mesh
  std::array<GlobalId, 4> node;  ///< new ones: from the end of the old ones on
  TetPoints point;
  std::array<int, 4> patch;  ///< of the face opposite each node
};

/// One split: of an edge (the third node is -1) or of a face, by a new node.
struct Split {
  std::array<GlobalId, 3> node;
  double squared_length = 0;
  Vec3 point;

  std::size_t n_nodes() const { return node[2] < 0 ? 2 : 3; }
};

std::size_t slot_of(const Piece& piece, GlobalId node) {
  return at(std::find(piece.node.begin(), piece.node.end(), node) - piece.node.begin());
}
bool contains(const Piece& piece, const Split& split) {
  return std::all_of(split.node.begin(), split.node.begin() + static_cast<std::ptrdiff_t>(split.n_nodes()),
                     [&](GlobalId node) { return slot_of(piece, node) < 4; });
}

/// The entries of `splits` by their first nodes.
std::map<GlobalId, std::vector<std::size_t>> by_first_node(const std::vector<Split>& splits) {
  std::map<GlobalId, std::vector<std::size_t>> rows;
  for (std::size_t s = 0; s < splits.size(); ++s) rows[splits[s].node[0]].push_back(s);
  return rows;
}

Piece piece_of(const mesh::DistMesh& mesh, LocalId c) {
  Piece piece{mesh.cell_global[at(c)], {}, mesh.points(c), {}};
  for (std::size_t k = 0; k < 4; ++k) {
    piece.node[k] = mesh.node_global[at(mesh.cell_to_node[at(c)][k])];
    const auto next = mesh.cell_to_cell[at(c)][k];
    piece.patch[k] = next < 0 ? mesh::slot_to_patch(next) : inside;
  }
  return piece;
}

/// The cells of all ranks at nodes of `wanted` (ascending) for which `is_wanted(piece)`. Collective.
template <class Wanted>
std::vector<Piece> gather_cells(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<GlobalId>& wanted,
                                Wanted&& is_wanted) {
  std::vector<std::uint8_t> is_at(at(mesh.n_nodes()), 0);
  for (std::size_t n = 0; n < is_at.size(); ++n)
    is_at[n] = std::binary_search(wanted.begin(), wanted.end(), mesh.node_global[n]) ? 1 : 0;
  std::vector<Piece> pieces;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto& nodes = mesh.cell_to_node[at(c)];
    if (std::none_of(nodes.begin(), nodes.end(), [&](LocalId n) { return is_at[at(n)] != 0; })) continue;
    if (const auto piece = piece_of(mesh, c); is_wanted(piece)) pieces.push_back(piece);
  }
  return gather_few(comm, std::move(pieces));
}

/// The cells that hold an edge or a face to be split. Collective.
std::vector<Piece> cells_to_split(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<Split>& splits) {
  const auto first = by_first_node(splits);
  std::vector<GlobalId> wanted;
  for (const auto& [node, rows] : first) wanted.push_back(node);
  return gather_cells(comm, mesh, wanted, [&](const Piece& piece) {
    return std::any_of(piece.node.begin(), piece.node.end(), [&](GlobalId node) {
      const auto rows = first.find(node);
      return rows != first.end() && std::any_of(rows->second.begin(), rows->second.end(),
                                                [&](std::size_t row) { return contains(piece, splits[row]); });
    });
  });
}

/// Nodes of the pieces that are not in the boundary, ascending. Collective.
std::vector<GlobalId> inner_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<Piece>& pieces) {
  std::vector<GlobalId> nodes;
  for (const auto& piece : pieces) nodes.insert(nodes.end(), piece.node.begin(), piece.node.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  std::vector<std::int64_t> n_faces(nodes.size(), 0);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      if (mesh.cell_to_cell[at(c)][slot] >= 0) continue;
      for (const auto corner : mesh::tet::face_to_corner[slot]) {
        const auto id = mesh.node_global[at(mesh.cell_to_node[at(c)][at(corner)])];
        const auto found = std::lower_bound(nodes.begin(), nodes.end(), id);
        if (found != nodes.end() && *found == id) ++n_faces[at(found - nodes.begin())];
      }
    }
  comm.sum_in_place(n_faces);
  std::vector<GlobalId> inner;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (n_faces[i] == 0) inner.push_back(nodes[i]);
  return inner;
}

/// The children of a piece: in each one node of the split edge or face gives way to the new node.
void apply(const Split& split, GlobalId new_node, std::vector<Piece>& pieces) {
  std::vector<Piece> result;
  for (const auto& piece : pieces) {
    if (!contains(piece, split)) {
      result.push_back(piece);
      continue;
    }
    for (std::size_t k = 0; k < split.n_nodes(); ++k) {
      auto child = piece;
      for (std::size_t other = 0; other < split.n_nodes(); ++other)
        if (other != k) child.patch[slot_of(piece, split.node[other])] = inside;  // between the children
      const auto slot = slot_of(piece, split.node[k]);
      child.node[slot] = new_node;
      child.point[slot] = split.point;
      result.push_back(child);
    }
  }
  pieces = std::move(result);
}

/// Where the ends lie fixes the length, and so the order; without positions here a split is completed from the pieces.
void place_and_order(const std::vector<Piece>& pieces, std::vector<Split>& splits) {
  std::map<GlobalId, Vec3> point;
  for (const auto& piece : pieces)
    for (std::size_t k = 0; k < 4; ++k) point[piece.node[k]] = piece.point[k];
  for (auto& split : splits) {
    const Vec3 a = point.at(split.node[0]), b = point.at(split.node[1]);
    split.point = geometry::midpoint(a, b);
    split.squared_length = geometry::squared_norm(b - a);
    if (split.n_nodes() == 3) split.point = split.point + (1.0 / 3) * (point.at(split.node[2]) - split.point);
  }
  std::stable_sort(splits.begin(), splits.end(), [](const Split& p, const Split& q) {  // edges before faces
    return p.n_nodes() != q.n_nodes() ? p.n_nodes() < q.n_nodes() : p.squared_length > q.squared_length;
  });
}

/// The children of all cells to be split, by cell.
std::map<GlobalId, std::vector<Piece>> split_all(const std::vector<Piece>& parents, const std::vector<Split>& splits,
                                                 GlobalId first_new) {
  const auto first = by_first_node(splits);
  std::map<GlobalId, std::vector<Piece>> children;
  for (const auto& parent : parents) {
    std::vector<std::size_t> rows;
    for (const auto node : parent.node)
      if (const auto found = first.find(node); found != first.end())
        rows.insert(rows.end(), found->second.begin(), found->second.end());
    std::sort(rows.begin(), rows.end());
    auto& pieces = children[parent.cell] = {parent};
    for (const auto s : rows) apply(splits[s], first_new + static_cast<GlobalId>(s), pieces);
  }
  return children;
}

/// A node that moves. Those of the old mesh do so only where cells at them are poor.
struct Mover {
  GlobalId node = 0;
  Vec3 point;
  bool is_new = true;
};

/// A corner on the wall of a cell with a face on it, as it will be after many levels: the edges along the wall in its
/// tangent plane. The corner opposite the face is left as it is.
struct Limit {
  std::size_t apex = 0;
  TetPoints point;
};

/// Moves nodes inside to where the cells at them are best.
class Improver {
 public:
  Improver(const mesh::MeshInfo& info, std::vector<Mover>& movers, std::vector<Piece> pieces)
      : movers_(movers), pieces_(std::move(pieces)), pieces_of_(movers.size()), limits_of_(movers.size()) {
    std::map<GlobalId, std::size_t> mover_of;
    for (std::size_t n = 0; n < movers.size(); ++n) mover_of[movers[n].node] = n;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const auto mover = mover_of.find(pieces_[i].node[slot]);
        if (mover == mover_of.end()) continue;
        pieces_of_[mover->second].push_back(i);
        if (pieces_[i].patch[slot] == inside) continue;
        const auto* surface = info.surface_of(pieces_[i].patch[slot]);
        if (surface != nullptr && !surface->is_flat()) add_limits(*surface, i, slot, limits_of_[mover->second]);
      }
  }

  /// Sweeps over the nodes, one after another, until none moves.
  void run() {
    bool has_moved = true;
    for (int sweep = 0; sweep < max_sweeps && has_moved; ++sweep) {
      has_moved = false;
      for (std::size_t n = 0; n < movers_.size(); ++n) has_moved = move(n) || has_moved;
    }
  }

 private:
  void add_limits(const geometry::Surface& surface, std::size_t piece, std::size_t apex, std::vector<Limit>& limits) {
    const auto& p = pieces_[piece].point;
    for (const auto corner : mesh::tet::face_to_corner[apex]) {
      const Vec3 a = p[at(corner)], normal = surface.normal(a);
      Limit limit{apex, p};
      for (const auto other : mesh::tet::face_to_corner[apex]) {
        const Vec3 along = p[at(other)] - a;
        limit.point[at(other)] = a + (along - geometry::dot(along, normal) * normal);
      }
      limits.push_back(limit);
    }
  }

  void put(std::size_t n, Vec3 p) {
    for (const auto i : pieces_of_[n]) pieces_[i].point[slot_of(pieces_[i], movers_[n].node)] = p;
    for (auto& limit : limits_of_[n]) limit.point[limit.apex] = p;
  }

  double worst_cell(std::size_t n) const {
    double worst = std::numeric_limits<double>::infinity();
    for (const auto i : pieces_of_[n]) worst = std::min(worst, geometry::mean_ratio(pieces_[i].point));
    return worst;
  }
  double worst_limit(std::size_t n) const {
    double worst = std::numeric_limits<double>::infinity();
    for (const auto& limit : limits_of_[n]) worst = std::min(worst, geometry::mean_ratio(limit.point));
    return worst;
  }

  double shortest_edge(std::size_t n, Vec3 p) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (const auto i : pieces_of_[n])
      for (std::size_t k = 0; k < 4; ++k)
        if (pieces_[i].node[k] != movers_[n].node)
          shortest = std::min(shortest, geometry::norm(pieces_[i].point[k] - p));
    return shortest;
  }

  bool move(std::size_t n) {
    auto& p = movers_[n].point;
    const Vec3 start = p;
    const double worst = worst_cell(n), least = std::min(least_worst, worst), length = shortest_edge(n, p);
    double best = std::min(worst, worst_limit(n));
    if (!movers_[n].is_new && best >= good_enough) return false;
    for (double step = 0.2; step > 0.01; step *= 0.5) {
      const Vec3 center = p;
      for (int direction = 0; direction < 27; ++direction) {
        if (direction == 13) continue;
        const Vec3 d{direction % 3 - 1.0, direction / 3 % 3 - 1.0, direction / 9 - 1.0};
        const Vec3 there = center + (step * length / geometry::norm(d)) * d;
        put(n, there);
        const double cells = worst_cell(n), value = std::min(cells, worst_limit(n));
        if (cells < least || !(value > best) || !all_positive(n)) continue;
        best = value;
        p = there;
      }
    }
    put(n, p);
    return !(p == start);
  }

  bool all_positive(std::size_t n) const {
    return std::all_of(pieces_of_[n].begin(), pieces_of_[n].end(), [&](std::size_t i) {
      const auto& p = pieces_[i].point;
      return geometry::is_positive(p[0], p[1], p[2], p[3]);
    });
  }

  std::vector<Mover>& movers_;
  std::vector<Piece> pieces_;
  std::vector<std::vector<std::size_t>> pieces_of_;
  std::vector<std::vector<Limit>> limits_of_;
};

/// The blocks of the mesh with `splits` applied; `children` of the old cells in their order. `patch`: of the faces of
/// this rank's new cells, in their order. Collective.
mesh::BlockMesh to_block(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<Split>& splits,
                         const std::map<GlobalId, std::vector<Piece>>& children,
                         std::vector<std::array<int, 4>>& patch) {
  mesh::BlockMesh block;
  block.info = mesh.info;
  block.info.n_global_nodes += static_cast<GlobalId>(splits.size());
  std::vector<LocalId> parent;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto found = children.find(mesh.cell_global[at(c)]);
    if (found != children.end()) {
      for (const auto& child : found->second) {
        parent.push_back(c);
        block.cell_to_node.push_back(child.node);
        patch.push_back(child.patch);
      }
      continue;
    }
    parent.push_back(c);
    auto& node = block.cell_to_node.emplace_back();
    auto& patches = patch.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) {
      node[k] = mesh.node_global[at(mesh.cell_to_node[at(c)][k])];
      const auto next = mesh.cell_to_cell[at(c)][k];
      patches[k] = next < 0 ? mesh::slot_to_patch(next) : inside;
    }
  }
  const auto n_cells = static_cast<std::int64_t>(parent.size());
  block.info.n_global_cells = comm.sum(n_cells);
  block.first_cell = mesh.info.first_id + comm.exclusive_sum(n_cells);
  for (const auto& field : mesh.cell_fields) {
    auto& copy = block.cell_fields.emplace_back(field);
    std::visit(
        [&](auto& values) {
          const auto old = values;
          values.clear();
          for (const auto c : parent)
            for (int k = 0; k < field.n_components; ++k) values.push_back(old[at(c * field.n_components + k)]);
        },
        copy.value);
  }
  return block;
}

/// Positions and node fields in canonical blocks; new nodes get the mean of the nodes that they lie between, of
/// integers that of the first one. Collective.
void scatter_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<Split>& splits,
                   mesh::BlockMesh& block) {
  std::map<GlobalId, LocalId> local;
  for (const auto& split : splits)
    for (std::size_t k = 0; k < split.n_nodes(); ++k) local[split.node[k]] = -1;
  for (LocalId n = 0; n < mesh.n_nodes(); ++n)
    if (const auto entry = local.find(mesh.node_global[at(n)]); entry != local.end()) entry->second = n;
  auto ids = mesh.node_global;
  auto position = mesh.node_position;
  std::vector<std::size_t> known;  // splits whose nodes this rank holds
  for (std::size_t s = 0; s < splits.size(); ++s) {
    bool has_all = true;
    for (std::size_t k = 0; k < splits[s].n_nodes(); ++k) has_all = has_all && local.at(splits[s].node[k]) >= 0;
    if (!has_all) continue;
    known.push_back(s);
    ids.push_back(mesh.info.node_ids().end() + static_cast<GlobalId>(s));
    position.push_back(splits[s].point);
  }
  block.node_position = par::scatter_rows<Vec3>(comm, block.info.node_ids(), position, 1, ids);
  for (const auto& field : mesh.node_fields) {
    auto& copy = block.node_fields.emplace_back(field);
    std::visit(
        [&]<class T>(std::vector<T>& values) {
          const auto width = at(field.n_components);
          for (const auto s : known) {
            const auto& split = splits[s];
            for (std::size_t k = 0; k < width; ++k) {
              T sum{};
              for (std::size_t i = 0; i < split.n_nodes(); ++i)
                sum += values[at(local.at(split.node[i])) * width + k] / static_cast<T>(split.n_nodes());
              if (field.holds_integers()) sum = values[at(local.at(split.node[0])) * width + k];
              if (field.name == ledger_field) sum = T{};  // not a node of the wall
              values.push_back(sum);
            }
          }
          values = par::scatter_rows<T>(comm, block.info.node_ids(), values, width, ids);
        },
        copy.value);
  }
}

/// Gives boundary faces their patches; neighbors were built without them.
void name_patches(const std::vector<std::array<int, 4>>& patch, mesh::DistMesh& mesh) {
  PAMR_ENSURES(patch.size() == mesh.cell_to_cell.size());
  for (std::size_t c = 0; c < patch.size(); ++c)
    for (std::size_t k = 0; k < 4; ++k) {
      auto& next = mesh.cell_to_cell[c][k];
      PAMR_ENSURES((next < 0) == (patch[c][k] != inside));
      if (next < 0) next = mesh::patch_to_slot(patch[c][k]);
    }
}

/// True when no field would have to follow nodes that move.
bool has_no_values(const mesh::DistMesh& mesh) {
  return std::all_of(mesh.node_fields.begin(), mesh.node_fields.end(),
                     [](const auto& field) { return field.name == ledger_field; });
}

/// Moves the new nodes, and those of `inner` (ascending) near poor cells.
void improve(mesh::DistMesh& mesh, const std::map<GlobalId, std::vector<Piece>>& children,
             const std::vector<GlobalId>& inner, GlobalId first_new, std::vector<Split>& splits) {
  std::vector<Piece> pieces;
  for (const auto& [cell, parts] : children) pieces.insert(pieces.end(), parts.begin(), parts.end());
  std::map<GlobalId, Vec3> point;
  for (const auto& piece : pieces)
    for (std::size_t k = 0; k < 4; ++k) point[piece.node[k]] = piece.point[k];
  std::vector<Mover> movers;
  for (std::size_t s = 0; s < splits.size(); ++s)
    movers.push_back({first_new + static_cast<GlobalId>(s), splits[s].point, true});
  for (const auto node : inner) movers.push_back({node, point.at(node), false});
  Improver(mesh.info, movers, std::move(pieces)).run();

  for (std::size_t s = 0; s < splits.size(); ++s) splits[s].point = movers[s].point;
  for (std::size_t n = 0; n < mesh.node_position.size(); ++n) {
    const auto found = std::lower_bound(inner.begin(), inner.end(), mesh.node_global[n]);
    if (found != inner.end() && *found == mesh.node_global[n])
      mesh.node_position[n] = movers[splits.size() + at(found - inner.begin())].point;
  }
}

}  // namespace

mesh::DistMesh open_wall_ears(const par::Comm& comm, mesh::DistMesh mesh, const WallEars& ears) {
  if (ears.count == 0) return mesh;
  std::vector<Split> splits;
  for (const auto& edge : ears.edge) splits.push_back({{edge[0], edge[1], -1}, 0, {}});
  for (const auto& face : ears.face) splits.push_back({face, 0, {}});
  auto cells = cells_to_split(comm, mesh, splits);
  place_and_order(cells, splits);
  std::vector<GlobalId> inner;
  if (has_no_values(mesh)) inner = inner_nodes(comm, mesh, cells);
  auto round_about = gather_cells(comm, mesh, inner, [](const Piece&) { return true; });
  cells.insert(cells.end(), round_about.begin(), round_about.end());
  const GlobalId first_new = mesh.info.node_ids().end();
  const auto children = split_all(cells, splits, first_new);
  improve(mesh, children, inner, first_new, splits);

  std::vector<std::array<int, 4>> patch;
  auto block = to_block(comm, mesh, splits, children, patch);
  scatter_nodes(comm, mesh, splits, block);
  mesh = {};
  mesh = assemble::assemble(comm, std::move(block));
  name_patches(patch, mesh);
  return mesh;
}

}  // namespace pamr::meshing
