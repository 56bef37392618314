// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/part/mesh_part.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>
#include <variant>

#include "pamr/adapt/part/join_part.hpp"
#include "pamr/adapt/part/part_runs.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::adapt {

namespace {

/// The nodes of a part that is widened: those of the whole mesh that it needs, and after them the new ones that the
/// part before had.
struct PartNodes {
  std::vector<LocalId> of_whole;         ///< ascending
  std::vector<LocalId> place_of_before;  ///< of the nodes of the whole mesh in the part before
  std::size_t n_before = 0;              ///< nodes of the part before

  std::size_t size() const { return of_whole.size() + n_before - place_of_before.size(); }
  LocalId place(bool is_of_whole, LocalId node) const {
    if (is_of_whole)
      return static_cast<LocalId>(std::lower_bound(of_whole.begin(), of_whole.end(), node) - of_whole.begin());
    const auto n_old = place_of_before.size();
    return at(node) < n_old ? place_of_before[at(node)] : static_cast<LocalId>(of_whole.size() + at(node) - n_old);
  }
  /// Rows of the nodes, `width` items each; zeros where there are none of the whole mesh.
  template <class T>
  std::vector<T> join(std::span<const T> whole, std::span<const T> before, std::size_t width = 1) const {
    std::vector<T> rows;
    reserve_array(rows, size() * width);
    for (const auto node : of_whole)
      for (std::size_t k = 0; k < width; ++k) rows.push_back(whole.empty() ? T{} : whole[at(node) * width + k]);
    if (before.empty()) return rows;
    const auto made = before.subspan(place_of_before.size() * width);
    rows.insert(rows.end(), made.begin(), made.end());
    return rows;
  }
};

PartNodes find_nodes(const mesh::DistMesh& mesh, const MeshPart& before, const Coverage& coverage) {
  const auto& old = before.whole_node;
  PartNodes nodes;
  nodes.n_before = before.mesh.node_position.size();
  std::vector<LocalId> more;
  for (const auto [first, count] : coverage.ranges)
    for (auto c = first; c < first + count; ++c)
      for (const auto node : mesh.cell_to_node[at(c)]) more.push_back(node);
  std::sort(more.begin(), more.end());
  more.erase(std::unique(more.begin(), more.end()), more.end());
  nodes.of_whole.reserve(old.size() + more.size());
  std::set_union(old.begin(), old.end(), more.begin(), more.end(), std::back_inserter(nodes.of_whole));
  nodes.place_of_before.reserve(old.size());
  for (LocalId place = 0; const auto node : old) {
    while (nodes.of_whole[at(place)] < node) ++place;
    nodes.place_of_before.push_back(place);
  }
  return nodes;
}

std::vector<mesh::CellNodes> join_corners(const PartRuns& runs, const PartNodes& nodes, const mesh::DistMesh& whole,
                                          const mesh::DistMesh& before) {
  std::vector<mesh::CellNodes> cells;
  reserve_array(cells, at(runs.n_cells()));
  for (const auto& run : runs.all())
    for (auto c = run.from; c < run.from + run.count; ++c) {
      auto& corners = cells.emplace_back((run.is_of_whole ? whole : before).cell_to_node[at(c)]);
      for (auto& node : corners) node = nodes.place(run.is_of_whole, node);
    }
  return cells;
}

std::vector<mesh::CellNeighbors> join_links(const PartRuns& runs, const mesh::DistMesh& whole, const MeshPart& before) {
  std::vector<mesh::CellNeighbors> links;
  reserve_array(links, at(runs.n_cells()));
  for (const auto& run : runs.all())
    for (auto c = run.from; c < run.from + run.count; ++c)
      links.push_back(run.is_of_whole ? links_of_whole(runs, whole, run, whole.cell_to_cell[at(c)])
                                      : links_of_part(runs, whole, before, c));
  return links;
}

/// `MeshPart::has_face`. Collective: one exchange.
std::vector<std::uint8_t> held_on_both_sides(const par::Comm& comm, const WholeMesh& whole, const PartRuns& runs) {
  std::vector<std::uint8_t> mine;
  for (const auto face : whole.mesh.border_face) mine.push_back(runs.has(face.cell) ? 1 : 0);
  auto both = par::Exchange(comm, whole.borders.faces).swap<std::uint8_t>(mine);
  for (std::size_t k = 0; k < mine.size(); ++k) both[k] = both[k] != 0 && mine[k] != 0 ? 1 : 0;
  return both;
}

/// The field with rows joined by `runs_or_nodes` of those of the whole mesh, null if it has none, and of the part
/// before, null if that was empty.
template <class Rows>
mesh::Field join_field(const Rows& runs_or_nodes, const mesh::Field* of_whole, const mesh::Field* of_before) {
  const auto& field = of_before != nullptr ? *of_before : *of_whole;
  mesh::Field joined{field.name, field.unit, field.n_components, field.storage, {}};
  std::visit(
      [&]<class T>(const std::vector<T>&) {
        std::span<const T> whole, before;
        if (of_whole != nullptr) whole = std::get<std::vector<T>>(of_whole->value);
        if (of_before != nullptr) before = std::get<std::vector<T>>(of_before->value);
        joined.value = runs_or_nodes.template join<T>(whole, before, at(field.n_components));
      },
      field.value);
  return joined;
}

/// Cells that were reached and from which to go on.
class Spread {
 public:
  Spread(const mesh::DistMesh& mesh, Coverage& coverage) : mesh_(mesh), coverage_(coverage) {}

  /// `layers`: that the cell's neighbors are away from the end.
  void reach(LocalId cell, int layers) {
    const auto lineage = mesh_.lineage[at(cell)];
    const auto first = lineage.is_removable() ? cell - lineage.child() : cell;
    const auto size = lineage.is_removable() ? lineage.family_size() : 1;
    for (auto member = first; member < first + size; ++member) {
      reached_.push_back({member, layers});
      auto& state = coverage_.of_cell[at(member)];
      if (state != Coverage::outside) continue;
      state = Coverage::added;
      added_.push_back(member);
    }
  }
  bool is_outside(LocalId cell) const { return coverage_.of_cell[at(cell)] == Coverage::outside; }
  /// Those behind the faces of what was reached last, and so on.
  void go_on() {
    for (; next_ < reached_.size(); ++next_) {
      const auto [cell, layers] = reached_[next_];
      if (layers == 0) continue;
      for (const auto slot : mesh_.cell_to_cell[at(cell)])
        if (mesh_.is_own(slot) && is_outside(slot)) reach(slot, layers - 1);
    }
  }
  /// Of each rank-border face how many more layers there are behind its cell, and one; 0 where it was not reached.
  std::vector<std::uint8_t> layers_at_border() const {
    std::vector<std::uint8_t> layers(at(mesh_.n_cells()), 0), at_border;
    for (const auto& [cell, n] : reached_)
      layers[at(cell)] = std::max(layers[at(cell)], static_cast<std::uint8_t>(n + 1));
    for (const auto face : mesh_.border_face) at_border.push_back(layers[at(face.cell)]);
    return at_border;
  }
  void note_ranges() {
    std::sort(added_.begin(), added_.end());
    auto& ranges = coverage_.ranges;
    for (const auto cell : added_)
      if (!ranges.empty() && ranges.back().first + ranges.back().count == cell)
        ++ranges.back().count;
      else
        ranges.push_back({cell, 1});
  }

 private:
  struct Reached {
    LocalId cell = 0;
    int layers = 0;
  };
  const mesh::DistMesh& mesh_;
  Coverage& coverage_;
  std::vector<Reached> reached_;
  std::vector<LocalId> added_;
  std::size_t next_ = 0;
};

}  // namespace

LocalId open_slot(const mesh::MeshInfo& info) { return mesh::patch_to_slot(static_cast<int>(info.patches.size())); }

std::vector<LocalId> open_cells(const MeshPart& part) {
  const auto open = open_slot(part.mesh.info);
  std::vector<LocalId> cells;
  for (LocalId c = 0; c < part.mesh.n_cells(); ++c) {
    const auto& slots = part.mesh.cell_to_cell[at(c)];
    if (std::find(slots.begin(), slots.end(), open) != slots.end()) cells.push_back(c);
  }
  return cells;
}

void spread(const par::Comm& comm, const WholeMesh& whole, const std::vector<LocalId>& seeds, int n_layers,
            Coverage& coverage) {
  const auto& mesh = whole.mesh;
  Spread spread(mesh, coverage);
  for (const auto cell : seeds) spread.reach(cell, n_layers);
  spread.go_on();
  if (comm.size() > 1) {
    const auto theirs = par::Exchange(comm, whole.borders.faces).swap<std::uint8_t>(spread.layers_at_border());
    for (std::size_t k = 0; k < theirs.size(); ++k)
      if (const auto cell = mesh.border_face[k].cell; theirs[k] > 1 && spread.is_outside(cell))
        spread.reach(cell, theirs[k] - 2);
    spread.go_on();
  }
  spread.note_ranges();
}

void cover_all(Coverage& coverage) {
  const auto n = static_cast<LocalId>(coverage.of_cell.size());
  const auto is_outside = [&](LocalId c) { return coverage.of_cell[at(c)] == Coverage::outside; };
  for (LocalId c = 0; c < n;) {
    const auto first = c;
    for (; c < n && is_outside(c); ++c) coverage.of_cell[at(c)] = Coverage::added;
    if (c > first) coverage.ranges.push_back({first, c - first});
    while (c < n && !is_outside(c)) ++c;
  }
}

Coverage held_of(const Coverage& coverage) {
  Coverage held{std::vector<Coverage::State>(coverage.of_cell.size(), Coverage::outside), {}};
  for (LocalId c = 0; c < static_cast<LocalId>(coverage.of_cell.size()); ++c) {
    if (coverage.of_cell[at(c)] != Coverage::held) continue;
    held.of_cell[at(c)] = Coverage::added;
    if (!held.ranges.empty() && held.ranges.back().first + held.ranges.back().count == c)
      ++held.ranges.back().count;
    else
      held.ranges.push_back({c, 1});
  }
  return held;
}

MeshPart widen(const par::Comm& comm, const WholeMesh& whole, const MeshPart& part, Coverage& coverage) {
  const auto& [mesh, borders, cells] = whole;
  const PartRuns runs(part, coverage);
  auto nodes = find_nodes(mesh, part, coverage);
  const bool was_empty = !part.is_cut;
  MeshPart wider;
  auto& fine = wider.mesh;
  wider.is_cut = true;
  wider.whole_cell = cells_of_whole(runs, part);
  wider.requests = runs.join<std::uint8_t>(cells.requests, part.requests);
  wider.known = {runs.join<refine::EdgeMask>(cells.closure.marks, part.known.marks), join_plans(runs, cells, part)};

  fine.info = (was_empty ? mesh : part.mesh).info;
  fine.info.cut_faces_conform = cells.closure.cut_faces_conform;
  fine.lineage = runs.join<mesh::Lineage>(mesh.lineage, part.mesh.lineage);
  fine.cell_origin =
      runs.join<GlobalId>(mesh.cell_origin.empty() ? mesh.cell_global : mesh.cell_origin, part.mesh.cell_origin);
  fine.node_position = nodes.join<geometry::Vec3>(mesh.node_position, part.mesh.node_position);
  fine.node_global = nodes.join<GlobalId>(mesh.node_global, part.mesh.node_global);
  fine.cell_to_node = join_corners(runs, nodes, mesh, part.mesh);
  fine.cell_to_cell = join_links(runs, mesh, part);

  wider.has_face = held_on_both_sides(comm, whole, runs);
  auto border = join_border_faces(runs, mesh, part, wider.has_face);
  fine.border_rank = std::move(border.border_rank);
  fine.border_offset = std::move(border.border_offset);
  fine.border_face = std::move(border.border_face);
  for (LocalId k = 0; const auto face : fine.border_face)
    fine.cell_to_cell[at(face.cell)][at(face.slot)] = runs.n_cells() + k++;
  fine.info.n_global_cells = number_in_order(comm, runs, mesh, part, fine.cell_global);
  fine.ghost_global = numbers_behind_border(comm, fine);

  for (const auto& field : (was_empty ? mesh : part.mesh).node_fields)
    fine.node_fields.push_back(join_field(nodes, mesh.find_node_field(field.name), was_empty ? nullptr : &field));
  for (const auto& field : (was_empty ? mesh : part.mesh).cell_fields)
    fine.cell_fields.push_back(join_field(runs, mesh.find_cell_field(field.name), was_empty ? nullptr : &field));
  wider.whole_node = std::move(nodes.of_whole);

  for (const auto [first, count] : coverage.ranges)
    std::fill_n(coverage.of_cell.begin() + first, count, Coverage::held);
  coverage.ranges.clear();
  return wider;
}

}  // namespace pamr::adapt
