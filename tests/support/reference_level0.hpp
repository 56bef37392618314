// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "support/reference_split.hpp"

/// The map of level 0 of `reference_refine`, from docs/level0-map.md. Of the library only the rows are used.
namespace pamr::test {

/// Where a node lies in the straight level 0: its positive barycentric coordinates, exact, by level-0 number. Empty: it
/// has no key.
using Barycentric = std::map<GlobalId, double>;
Barycentric halfway(const Barycentric& a, const Barycentric& b);

/// Puts places in level 0 where they belong in the domain. A row is an index into `cells`.
class ReferenceMap {
 public:
  /// `surface_of_patch`: one for each patch, null where there is none; has to live as long.
  ReferenceMap(std::vector<mesh::Level0Cell> cells, std::vector<const geometry::Surface*> surface_of_patch)
      : cells_(std::move(cells)), surface_of_patch_(std::move(surface_of_patch)) {}

  const std::vector<mesh::Level0Cell>& cells() const { return cells_; }
  /// Nothing where the support is not bent.
  std::optional<geometry::Vec3> place(int row, const Barycentric& key) const;

 private:
  using Weights = std::array<double, 4>;
  using Corners = std::set<int>;

  geometry::Vec3 quadratic(const mesh::Level0Cell& cell, const Weights& w) const;
  std::optional<geometry::Vec3> rest(const mesh::Level0Cell& cell, const Weights& w) const;
  bool is_in_wall(const mesh::Level0Cell& cell, const Corners& support) const;
  geometry::Vec3 onto_wall(const mesh::Level0Cell& cell, const Corners& support, const Weights& w) const;
  /// An edge of a wall between two patches or on a sharp edge.
  static bool is_on_curve(const mesh::Level0Cell& cell, int edge);
  geometry::Vec3 onto_edge(const mesh::Level0Cell& cell, int edge, geometry::Vec3 from) const;

  std::vector<mesh::Level0Cell> cells_;
  std::vector<const geometry::Surface*> surface_of_patch_;
};

/// The rows and keys of the cells and nodes of a mesh.
struct ReferenceLevel0 {
  const ReferenceMap* map = nullptr;  ///< null: there is none, and nothing else is here
  std::vector<int> row;               ///< of each cell: that of the bent cell that it descends from, -1: none
  std::vector<Barycentric> key;       ///< of each node

  /// Where the map puts a new node in the middle of an edge of a cell; nothing if it does not.
  std::optional<geometry::Vec3> mapped_middle(int row_of_cell, const Edge& edge) const;
  /// The same, or the middle of its ends.
  geometry::Vec3 middle(int row_of_cell, const Edge& edge, const Points& point) const;
  /// The middle of an edge as a further node.
  void add_middle(const Edge& edge);
  /// Of all edges of a cell that descends from a bent one; nothing for other cells.
  std::optional<std::array<geometry::Vec3, 6>> middles(const Piece& piece, const Points& point) const;
};

/// Of a mesh of level 0.
ReferenceLevel0 look_at_level0(const mesh::BlockMesh& whole, const ReferenceMap& map);

/// The cells of a whole mesh with their rows.
std::vector<Piece> pieces_of(const mesh::BlockMesh& whole, const ReferenceLevel0& level0);

}  // namespace pamr::test
