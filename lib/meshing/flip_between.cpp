// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/flip_between.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "meshing/ears.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::meshing {

namespace {

using Cell = std::array<std::int32_t, 4>;

constexpr double flat = 0.1;          // mean ratio of cells that are flipped away
constexpr double min_flipped = 0.05;  // mean ratio of cells that `improve` can make something of
constexpr std::size_t max_ring = 12;  // cells around an edge

double quality_of(const RawMesh& mesh, const Cell& cell) {
  const geometry::TetPoints p{mesh.position(cell[0]), mesh.position(cell[1]), mesh.position(cell[2]),
                              mesh.position(cell[3])};
  return geometry::is_positive(p[0], p[1], p[2], p[3]) ? geometry::mean_ratio(p) : 0;
}

/// The cells around an edge, in whose place others come that have the same faces outside and no such edge.
class Ring {
 public:
  /// Nothing where the cells do not close around the edge. `cells` are those with both of its nodes.
  static std::optional<Ring> of(const RawMesh& mesh, LocalEdge edge, const std::vector<std::int32_t>& cells) {
    if (cells.size() < 3 || cells.size() > max_ring) return std::nullopt;
    std::map<std::int32_t, std::int32_t> next;
    for (const auto c : cells) {
      const auto [x, y] = around(mesh.cell[at(c)], edge);
      if (!next.emplace(x, y).second) return std::nullopt;
    }
    Ring ring;
    ring.edge_ = edge;
    for (auto node = next.begin()->first; ring.node_.size() < cells.size();) {
      ring.node_.push_back(node);
      const auto found = next.find(node);
      if (found == next.end()) return std::nullopt;
      node = found->second;
      if (node == ring.node_.front() && ring.node_.size() < cells.size()) return std::nullopt;
    }
    return next.at(ring.node_.back()) == ring.node_.front() ? std::optional(std::move(ring)) : std::nullopt;
  }

  /// The new cells of which the poorest is best, and its mean ratio. Every triangulation of the ring's nodes gives
  /// some: two cells for each triangle.
  std::pair<double, std::vector<Cell>> best(const RawMesh& mesh) const {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const auto n = node_.size();
    std::array<std::array<double, max_ring>, max_ring> ratio{};
    std::array<std::array<std::size_t, max_ring>, max_ring> split{};
    for (std::size_t i = 0; i + 1 < n; ++i) ratio[i][i + 1] = infinite;
    for (std::size_t width = 2; width < n; ++width)
      for (std::size_t i = 0; i + width < n; ++i)
        for (std::size_t k = i + 1, j = i + width; k < j; ++k) {
          const auto cells = over(i, k, j);
          const double here =
              std::min({ratio[i][k], ratio[k][j], quality_of(mesh, cells[0]), quality_of(mesh, cells[1])});
          if (split[i][j] != 0 && !(here > ratio[i][j])) continue;
          ratio[i][j] = here;
          split[i][j] = k;
        }
    std::vector<Cell> cells;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, n - 1}};
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      if (j - i < 2) continue;
      const auto k = split[i][j];
      for (const auto& cell : over(i, k, j)) cells.push_back(cell);
      open.emplace_back(i, k);
      open.emplace_back(k, j);
    }
    return {ratio[0][n - 1], std::move(cells)};
  }

 private:
  /// The corners of a cell that are not on the edge, such that the edge and these, in order, are positive.
  static std::array<std::int32_t, 2> around(const Cell& cell, LocalEdge edge) {
    const auto corner_of = [&cell](std::int32_t node) {
      return static_cast<std::size_t>(std::find(cell.begin(), cell.end(), node) - cell.begin());
    };
    const auto first = corner_of(edge.first);
    // a corner and those of the face opposite it, in order, are positive
    const auto& face = mesh::tet::face_to_corner[first];
    std::size_t k = 0;
    while (at(face[k]) != corner_of(edge.second)) ++k;
    const auto after = cell[at(face[(k + 1) % 3])], before = cell[at(face[(k + 2) % 3])];
    return {after, before};
  }

  std::array<Cell, 2> over(std::size_t i, std::size_t k, std::size_t j) const {
    return {{{node_[i], node_[k], node_[j], edge_.second}, {node_[i], node_[j], node_[k], edge_.first}}};
  }

  LocalEdge edge_;
  std::vector<std::int32_t> node_;  ///< around the edge
};

/// One pass over the cells between regions.
class Pass {
 public:
  Pass(const Domain& domain, RawMesh& mesh) : domain_(domain), mesh_(mesh), gone_(mesh.cell.size(), false) {
    for (const auto& face : mesh.face) tag(face_of(mesh, face.cell, face.slot), {face.piece, false});
    for (const auto& face : mesh.between) tag(face_of(mesh, face.cell, face.slot), {face.piece, true});
  }

  int run() {
    auto ears = find_ears(mesh_, sides());
    find_stars(ears);
    int n_mended = 0;
    for (const auto& ear : ears) n_mended += mend(ear) ? 1 : 0;
    if (n_mended > 0) rebuild();
    return n_mended;
  }

 private:
  struct Tag {
    int piece;
    bool is_between;
  };

  void tag(const LocalFace& face, Tag with) {
    if (face_.insert_or_assign(face, with).second)
      for (const auto& edge : edges_of(face)) ++n_faces_[edge];
  }
  void untag(const LocalFace& face) {
    face_.erase(face);
    for (const auto& edge : edges_of(face)) --n_faces_[edge];
  }
  int n_faces(LocalEdge edge) const {
    const auto found = n_faces_.find(edge);
    return found == n_faces_.end() ? 0 : found->second;
  }

  /// The faces between regions, of the cells with all corners in the boundary or between regions, from both sides.
  std::vector<BoundaryFace> sides() const {
    std::vector<BoundaryFace> result;
    for (std::size_t c = 0; c < mesh_.cell.size(); ++c) {
      const auto is_bound = [&](auto node) { return mesh_.binding[at(node)].freedom != Freedom::space; };
      if (!std::all_of(mesh_.cell[c].begin(), mesh_.cell[c].end(), is_bound)) continue;
      const auto cell = static_cast<std::int32_t>(c);
      for (int slot = 0; slot < 4; ++slot)
        if (const auto found = face_.find(face_of(mesh_, cell, slot)); found != face_.end() && found->second.is_between)
          result.push_back({cell, slot, found->second.piece});
    }
    return result;
  }

  /// The cells at the nodes of `ears`.
  void find_stars(const std::vector<Ear>& ears) {
    for (const auto& ear : ears)
      for (const auto node : mesh_.cell[at(ear.cell)]) star_[node];
    for (std::size_t c = 0; c < mesh_.cell.size(); ++c)
      for (const auto node : mesh_.cell[c])
        if (const auto found = star_.find(node); found != star_.end())
          found->second.push_back(static_cast<std::int32_t>(c));
  }

  bool mend(const Ear& ear) {
    if (gone_[at(ear.cell)] || n_faces(ear.inner) != 0 || n_faces(ear.outer) != 2) return false;
    for (const int slot : ear.shown)  // flipped meanwhile
      if (!face_.contains(face_of(mesh_, ear.cell, slot))) return false;
    const double ratio = quality_of(mesh_, mesh_.cell[at(ear.cell)]);
    if (ratio >= flat) {
      if (!lies_behind(ear)) return false;
      give_away(ear);
      return true;
    }
    const auto here = replacement(ear.inner);
    give_away(ear);
    const auto there = replacement(ear.outer);
    if (here.ratio >= there.ratio) take_back(ear);
    return replace(here.ratio >= there.ratio ? here : there);
  }

  int other_region(const Ear& ear) const {
    const auto& [first, second] = domain_.pieces[at(ear.piece)].region;
    return mesh_.region[at(ear.cell)] == first ? second : first;
  }

  /// True when the piece at the middle of the inner edge lies still further into the cell's region than that edge does.
  bool lies_behind(const Ear& ear) const {
    const auto outer = middle_of(mesh_, ear.outer), inner = middle_of(mesh_, ear.inner);
    if (Domain::region_of(domain_.label(inner)) != other_region(ear)) return false;
    return geometry::dot(domain_.pieces[at(ear.piece)].nearest(inner) - inner, inner - outer) > 0;
  }

  /// The cell becomes one of the region behind it.
  void give_away(const Ear& ear) {
    mesh_.region[at(ear.cell)] = other_region(ear);
    for (const int slot : ear.shown) untag(face_of(mesh_, ear.cell, slot));
    for (const int slot : ear.hidden) tag(face_of(mesh_, ear.cell, slot), {ear.piece, true});
  }
  void take_back(Ear ear) {
    std::swap(ear.shown, ear.hidden);
    give_away(ear);
  }

  /// Cells and others that may come in their place; the smallest mean ratio of these, 0: nothing is to be done.
  struct Replacement {
    double ratio = 0;
    std::vector<std::int32_t> old;
    std::vector<Cell> made;
  };

  /// For the cells around an edge inside a region. Nothing where they do not get better, or some went meanwhile.
  Replacement replacement(LocalEdge edge) const {
    Replacement result;
    double worst = std::numeric_limits<double>::infinity();
    for (const auto c : star_.at(edge.first)) {
      const auto& cell = mesh_.cell[at(c)];
      if (std::find(cell.begin(), cell.end(), edge.second) == cell.end()) continue;
      if (gone_[at(c)]) return {};
      result.old.push_back(c);
      worst = std::min(worst, quality_of(mesh_, cell));
    }
    const auto ring = Ring::of(mesh_, edge, result.old);
    if (!ring) return {};
    std::tie(result.ratio, result.made) = ring->best(mesh_);
    return result.ratio > worst && result.ratio >= min_flipped ? result : Replacement{};
  }

  bool replace(const Replacement& by) {
    if (by.made.empty()) return false;
    const int region = mesh_.region[at(by.old.front())];
    for (const auto c : by.old) gone_[at(c)] = true;
    for (const auto& cell : by.made) {
      mesh_.cell.push_back(cell);
      mesh_.region.push_back(region);
      gone_.push_back(false);
    }
    return true;
  }

  /// Takes the cells away that went, and finds the faces again.
  void rebuild() {
    std::size_t n = 0;
    for (std::size_t c = 0; c < mesh_.cell.size(); ++c) {
      if (gone_[c]) continue;
      mesh_.cell[n] = mesh_.cell[c];
      mesh_.region[n++] = mesh_.region[c];
    }
    mesh_.cell.resize(n);
    mesh_.region.resize(n);
    mesh_.face.clear();
    mesh_.between.clear();
    for (std::size_t c = 0; c < n; ++c)
      for (int slot = 0; slot < 4; ++slot) {
        const auto cell = static_cast<std::int32_t>(c);
        const auto found = face_.find(face_of(mesh_, cell, slot));
        if (found == face_.end()) continue;
        const auto [piece, is_between] = found->second;
        if (!is_between)
          mesh_.face.push_back({cell, slot, piece});
        else if (mesh_.region[c] == domain_.pieces[at(piece)].region[0])
          mesh_.between.push_back({cell, slot, piece});
      }
  }

  const Domain& domain_;
  RawMesh& mesh_;
  std::vector<bool> gone_;                                  ///< by cell
  std::map<LocalFace, Tag> face_;                           ///< in the boundary and between regions
  std::map<LocalEdge, int> n_faces_;                        ///< of those, at an edge
  std::map<std::int32_t, std::vector<std::int32_t>> star_;  ///< cells at the nodes of ears
};

}  // namespace

int flip_between(const Domain& domain, RawMesh& mesh) {
  if (mesh.between.empty()) return 0;
  constexpr int max_passes = 20;
  int total = 0;
  for (int i = 0; i < max_passes; ++i) {
    const int n = Pass(domain, mesh).run();
    if (n == 0) break;
    total += n;
  }
  return total;
}

}  // namespace pamr::meshing
