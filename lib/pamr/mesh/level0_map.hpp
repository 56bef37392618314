// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/mesh/patch_list.hpp"
#include "pamr/mesh/surfaces_of_node.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// A cell of level 0 that is bent, as files and messages have it. Corners in the order of their coordinates; edges and
/// faces by the numbering of `mesh/tet.hpp` for this order. Plain bytes.
struct Level0Cell {
  GlobalId row = 0;                                        ///< rows are numbered from 0
  std::array<GlobalId, 4> node{};                          ///< numbers in level 0
  std::array<geometry::Vec3, 4> corner{};                  ///< length unit
  std::array<geometry::Vec3, 6> bulge{};                   ///< from the middle of each edge to where it belongs
  std::array<std::int32_t, 4> face_patch{-1, -1, -1, -1};  ///< of faces in a curved wall
  /// The two patches at edges in a curved wall, the smaller first.
  std::array<std::array<std::int32_t, 2>, 6> edge_patch{{{-1, -1}, {-1, -1}, {-1, -1}, {-1, -1}, {-1, -1}, {-1, -1}}};
  std::array<geometry::Vec3, 6> beside{};  ///< normal of the face of a patch without surface at such an edge, else 0
  std::uint8_t sharp_edges = 0;            ///< bits: edges where that face meets the wall in a sharp edge
  std::uint8_t creases = 0;                ///< bits: edges along a sharp edge inside a surface
  std::uint8_t bent_corners = 0;           ///< bits
};

/// Whether an edge lies in a curved wall and between two patches, or on a sharp edge: nodes there keep to a curve.
bool is_end_of_patch(const Level0Cell& cell, std::size_t edge);

/// Where the map of level 0 puts a node.
struct Mapped {
  geometry::Vec3 point;
  PatchList patch{-1, -1, -1, -1};  ///< the patches that the node is on if they are curved walls
  bool is_reachable = true;  ///< false: no common point of its surfaces near by; `point` is the place without them
  bool is_on_crease = false;
  double off_facets = 0;  ///< how far it leaves the faces of a patch without a surface
};

/// A place in a bent cell: the weights of a key by the corners of its row. All 0: not known, or not in that cell.
using CornerWeights = std::array<std::int64_t, 4>;

/// As `middle` of two keys.
constexpr CornerWeights middle(const CornerWeights& a, const CornerWeights& b) {
  CornerWeights mid{};
  std::int64_t is_odd = 0, any_a = 0, any_b = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    any_a |= a[i];
    any_b |= b[i];
    is_odd |= (a[i] ^ b[i]) & 1;
    mid[i] = a[i] / 2 + b[i] / 2 + (a[i] & b[i] & 1);  // their sum may not fit
  }
  return any_a == 0 || any_b == 0 || is_odd != 0 ? CornerWeights{} : mid;
}

/// Steps onto the curved edges of one cell, as they were found: many places in a cell lie beside the same place of an
/// edge. Another cell, or other bulges, take a new one.
class KnownSteps {
 public:
  /// The step at these weights of the edge's corners; what `find` returns becomes it where it is not known.
  template <class Find>
  geometry::Vec3 of(int edge, const std::array<double, 2>& weight, const Find& find) {
    auto& steps = steps_[at(edge)];
    for (const auto& step : steps)
      if (step.weight == weight) return step.length;
    steps.push_back({weight, find()});
    return steps.back().length;
  }

 private:
  struct Step {
    std::array<double, 2> weight;
    geometry::Vec3 length;
  };
  std::array<std::vector<Step>, 6> steps_;
};

/// A map of level 0 that puts new nodes near coarse curved walls: the rows of the level-0 cells that this rank's cells
/// descend from, with the surfaces that they name. Shared unchanged. Source: docs/level0-map.md, which states the
/// formulas and the order of all sums.
class Level0Map {
 public:
  /// `cells`: ascending by row. `info`: has the patches and surfaces that they name. Where the surfaces were not made
  /// (`io::ReadOptions::build_surfaces`), the map only keeps the cells: it takes no node onto a wall.
  Level0Map(std::vector<Level0Cell> cells, GlobalId n_global_cells, const MeshInfo& info);
  ~Level0Map() = default;
  Level0Map(const Level0Map&) = delete;
  Level0Map& operator=(const Level0Map&) = delete;
  Level0Map(Level0Map&&) = delete;
  Level0Map& operator=(Level0Map&&) = delete;

  std::span<const Level0Cell> cells() const { return cells_; }
  GlobalId n_global_cells() const { return n_global_cells_; }
  /// Index of a row, -1 if it is not here.
  LocalId find(GlobalId row) const;
  CornerWeights weights(LocalId cell, const Level0Key& key) const;
  /// Whether one of the level-0 nodes of a place is bent.
  bool is_bent(LocalId cell, const CornerWeights& weight) const;
  /// Where a node belongs that is no node of level 0. Nothing where the map changes nothing: its support is not bent.
  /// `known`: of this cell, if many places of it are asked for.
  std::optional<Mapped> place(LocalId cell, const CornerWeights& weight, KnownSteps* known = nullptr) const;
  /// The displacement by the curved walls of a cell beyond the quadratic map at these barycentric coordinates: R in the page.
  geometry::Vec3 wall_residual(LocalId cell, const std::array<double, 4>& weight, KnownSteps* known = nullptr) const;
  /// Whether a wall may end at an edge of the cell: there the residual has derivatives to one side only.
  bool has_wall_that_ends(LocalId cell) const { return walls_[at(cell)].may_end; }

 private:
  struct Walls {
    std::array<const SurfacesOfNode*, 4> face{};
    std::array<const SurfacesOfNode*, 6> edge{};
    /// Bits: faces and edges in a curved wall, those of the edges at which a patch ends, edges with a bulge.
    unsigned faces = 0, edges = 0, ends = 0, bulges = 0;
    bool may_end = false;  ///< `has_wall_that_ends`
  };
  Mapped onto_edge(LocalId cell, int edge, geometry::Vec3 from) const;
  /// `from`: the quadratic map at these barycentric coordinates.
  Mapped onto_face(LocalId cell, int face, const std::array<double, 4>& weight, geometry::Vec3 from,
                   KnownSteps* known) const;
  /// The displacement by the curves that bound a face in a wall, beyond the quadratic map: C in the page.
  geometry::Vec3 bounds_residual(LocalId cell, int face, const std::array<double, 4>& weight, KnownSteps* known) const;
  /// From the quadratic map to the curve, at weights of the edge's two corners.
  geometry::Vec3 edge_step(LocalId cell, int edge, const std::array<double, 4>& weight, KnownSteps* known) const;

  std::vector<Level0Cell> cells_;
  std::vector<Walls> walls_;
  std::vector<SurfacesOfNode> surfaces_;
  geometry::SharedSurfaces keep_;
  GlobalId n_global_cells_ = 0;
};

/// Has the rows on the ranks whose cells name them in the field `level0_cell`: to be called when cells have moved.
/// Nothing if the mesh has no map. Collective: four sparse exchanges.
void send_level0_rows(const par::Comm& comm, DistMesh& mesh);

/// Whether a mesh has a map with both of its fields. The same on every rank.
bool has_level0(const DistMesh& mesh);

/// Takes the map and its fields away. Local.
void drop_level0(DistMesh& mesh);

/// The map as seen from the cells of a mesh. Only references: the mesh must live longer, and its fields stay.
class Level0View {
 public:
  explicit Level0View(const DistMesh& mesh);

  bool is_empty() const { return map_ == nullptr; }
  /// The cell's row in the map, -1: none.
  LocalId row_of(LocalId cell) const;
  /// Of a node of the mesh in the level-0 cell of a row.
  CornerWeights weights(LocalId row, LocalId node) const;
  /// Has what `weights` reads fetched from memory.
  void prefetch_key(LocalId node) const {
    if (keys_ != nullptr) prefetch(keys_->integer().data() + at(node) * n_key_words);
  }
  bool is_bent(LocalId row, const CornerWeights& weight) const { return map_->is_bent(row, weight); }
  std::optional<Mapped> place(LocalId row, const CornerWeights& weight) const { return map_->place(row, weight); }

 private:
  const Level0Map* map_ = nullptr;
  const CellField* rows_ = nullptr;
  const NodeField* keys_ = nullptr;
};

}  // namespace pamr::mesh
