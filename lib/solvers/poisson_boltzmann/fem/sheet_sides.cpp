// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/sheet_sides.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/mesh/tet.hpp"
#include "solvers/poisson_boltzmann/fem/fem_domain.hpp"

namespace pamr::poisson_boltzmann {

namespace {

constexpr GlobalId no_side = -1;

/// Names each side at each node of a sheet by the lowest number of a cell there.
class SideFinder {
 public:
  explicit SideFinder(const Domain& domain)
      : domain_(domain),
        mesh_(*domain.mesh),
        is_on_sheet_(domain.point.size(), 0),
        is_sheet_(domain.mesh->cell_to_node.size()),
        name_(domain.mesh->cell_to_node.size()) {
    for (auto& of_cell : name_) of_cell.fill(no_side);
  }

  void find(const par::Comm& comm) {
    for (const auto& face : domain_.faces) {
      if (!face.is_inside) continue;
      for (const auto node : face.node) is_on_sheet_[at(node)] = 1;
      const auto& corner = mesh_.cell_to_node[at(face.cell)];
      for (std::size_t slot = 0; slot < 4; ++slot)
        if (std::find(face.node.begin(), face.node.end(), corner[slot]) == face.node.end())
          is_sheet_[at(face.cell)][slot] = true;
    }
    par::fold_flags(par::Exchange(comm, domain_.nodes.shared()), is_on_sheet_);
    for (std::size_t c = 0; c < name_.size(); ++c)
      for (std::size_t k = 0; k < 4; ++k)
        if (is_on_sheet_[at(mesh_.cell_to_node[c][k])] != 0) {
          name_[c][k] = mesh_.cell_global[c];
          if (cells_.empty() || cells_.back() != static_cast<LocalId>(c)) cells_.push_back(static_cast<LocalId>(c));
        }
    do {
      while (spread_here()) {
      }
    } while (comm.any(spread_over_borders(comm)));
  }

  bool is_on_sheet(std::size_t node) const { return is_on_sheet_[node] != 0; }
  const std::vector<LocalId>& cells() const { return cells_; }
  GlobalId name(LocalId cell, std::size_t corner) const { return name_[at(cell)][corner]; }

  /// For each patch whether a node of its sheets has one side only. Collective: two exchanges, one reduction.
  std::vector<std::int64_t> rims(const par::Comm& comm) const {
    std::vector<GlobalId> low(is_on_sheet_.size(), std::numeric_limits<GlobalId>::max()), high(low.size(), no_side);
    for (const auto c : cells_)
      for (std::size_t k = 0; k < 4; ++k) {
        if (name(c, k) == no_side) continue;
        const auto node = at(mesh_.cell_to_node[at(c)][k]);
        low[node] = std::min(low[node], name(c, k));
        high[node] = std::max(high[node], name(c, k));
      }
    const par::Exchange exchange(comm, domain_.nodes.shared());
    par::fold_shared(exchange, low, [](GlobalId& mine, GlobalId theirs) { mine = std::min(mine, theirs); });
    par::fold_shared(exchange, high, [](GlobalId& mine, GlobalId theirs) { mine = std::max(mine, theirs); });
    std::vector<std::int64_t> result(domain_.patches.size(), 0);
    for (std::size_t i = 0; i < low.size(); ++i)
      for (std::size_t p = 0; p < result.size() && low[i] == high[i]; ++p)
        if ((domain_.node_patches[i] >> p & 1U) != 0) result[p] = 1;
    comm.max_in_place(result);
    return result;
  }

 private:
  /// Gives cells on both sides of each face that is no sheet the lower of their names. Returns whether one changed.
  bool spread_here() {
    bool any = false;
    for (const auto c : cells_)
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const auto next = mesh_.cell_to_cell[at(c)][slot];
        if (!mesh_.is_own(next) || is_sheet_[at(c)][slot]) continue;
        for (const auto corner : mesh::tet::face_to_corner[slot]) {
          auto& mine = name_[at(c)][at(corner)];
          if (mine == no_side) continue;
          const auto node = mesh_.cell_to_node[at(c)][at(corner)];
          auto& theirs = name_[at(next)][at(mesh::slot_of(mesh_.cell_to_node[at(next)], node))];
          any = any || mine != theirs;
          mine = theirs = std::min(mine, theirs);
        }
      }
    return any;
  }

  /// The same for the faces between two ranks. Collective: an exchange.
  bool spread_over_borders(const par::Comm& comm) {
    par::Pattern pattern;
    std::vector<GlobalId*> place;
    std::vector<GlobalId> name;
    pattern.rank = mesh_.border_rank;
    for (const auto offset : mesh_.border_offset) pattern.offset.push_back(3 * offset);
    pattern.offset.erase(pattern.offset.begin());
    for (const auto [cell, slot] : mesh_.border_face) {
      std::array<std::pair<GlobalId, std::size_t>, 3> corner;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto of_cell = at(mesh::tet::face_to_corner[at(slot)][k]);
        corner[k] = {mesh_.node_global[at(mesh_.cell_to_node[at(cell)][of_cell])], of_cell};
      }
      std::sort(corner.begin(), corner.end());
      for (const auto& [node, of_cell] : corner) {
        pattern.item.push_back(static_cast<LocalId>(place.size()));
        place.push_back(&name_[at(cell)][of_cell]);
        name.push_back(is_sheet_[at(cell)][at(slot)] ? no_side : *place.back());
      }
    }
    par::fold_shared(par::Exchange(comm, pattern), name, [](GlobalId& mine, GlobalId theirs) {
      if (mine != no_side && theirs != no_side) mine = std::min(mine, theirs);
    });
    bool any = false;
    for (std::size_t i = 0; i < place.size(); ++i) {
      if (name[i] == no_side || name[i] >= *place[i]) continue;
      *place[i] = name[i];
      any = true;
    }
    return any;
  }

  const Domain& domain_;
  const mesh::DistMesh& mesh_;
  std::vector<std::uint8_t> is_on_sheet_;      ///< n_nodes
  std::vector<std::array<bool, 4>> is_sheet_;  ///< n_cells: the faces of a cell that are sheets
  std::vector<std::array<GlobalId, 4>> name_;  ///< n_cells: sides at the corners of a cell
  std::vector<LocalId> cells_;                 ///< those with a corner on a sheet
};

}  // namespace

void add_sheet_sides(const par::Comm& comm, Domain& domain) {
  if (!comm.any(
          std::any_of(domain.faces.begin(), domain.faces.end(), [](const BoundaryFace& f) { return f.is_inside; })))
    return;
  const auto& mesh = *domain.mesh;
  SideFinder finder(domain);
  finder.find(comm);
  const auto rims = finder.rims(comm);
  for (std::size_t p = 0; p < rims.size(); ++p)
    domain.patches[p].has_rim = domain.patches[p].has_inside && rims[p] != 0;

  std::vector<par::SharedKey> key;
  for (const auto c : finder.cells())
    for (std::size_t k = 0; k < 4; ++k)
      if (finder.name(c, k) != no_side)
        key.push_back({mesh.node_global[at(mesh.cell_to_node[at(c)][k])], finder.name(c, k), -1});
  std::sort(key.begin(), key.end());
  key.erase(std::unique(key.begin(), key.end()), key.end());
  SheetSides sides{mesh.cell_to_node, key.size(), par::find_shared(comm, key)};
  for (const auto c : finder.cells())
    for (std::size_t k = 0; k < 4; ++k) {
      if (finder.name(c, k) == no_side) continue;
      auto& node = sides.cell_to_node[at(c)][k];
      const par::SharedKey own{mesh.node_global[at(node)], finder.name(c, k), -1};
      node = mesh.n_nodes() + static_cast<LocalId>(std::lower_bound(key.begin(), key.end(), own) - key.begin());
    }
  domain.sides = std::make_shared<const SheetSides>(std::move(sides));
}

}  // namespace pamr::poisson_boltzmann
