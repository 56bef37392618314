// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/part/mesh_part.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>

#include "pamr/adapt/part/join_part.hpp"
#include "pamr/adapt/part/part_runs.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::adapt {

namespace {

class Widener {
 public:
  Widener(const par::Comm& comm, const WholeMesh& whole, const MeshPart& before, const Coverage& coverage)
      : comm_(comm), whole_(whole), before_(before), coverage_(coverage), runs_(before, coverage) {}

  MeshPart run() && {
    const auto& [mesh, borders, cells] = whole_;
    const auto& [requests, closure] = cells;
    after_.mesh.info = was_empty() ? mesh.info : before_.mesh.info;
    after_.mesh.info.cut_faces_conform = closure.cut_faces_conform;
    after_.whole_cell = cells_of_whole(runs_, before_);
    after_.requests = runs_.join<std::uint8_t>(requests, before_.requests);
    after_.mesh.lineage = runs_.join<mesh::Lineage>(mesh.lineage, before_.mesh.lineage);
    after_.mesh.cell_origin =
        runs_.join<GlobalId>(mesh.cell_origin.empty() ? mesh.cell_global : mesh.cell_origin, before_.mesh.cell_origin);
    after_.known = {runs_.join<refine::EdgeMask>(closure.marks, before_.known.marks),
                    join_plans(runs_, cells, before_)};
    find_nodes();
    join_nodes();
    join_links();
    join_borders();
    number_cells();
    join_fields();
    after_.is_cut = true;
    return std::move(after_);
  }

 private:
  bool was_empty() const { return !before_.is_cut; }

  /// The nodes of the whole mesh that are needed, and where they were and are.
  void find_nodes() {
    auto& nodes = after_.whole_node;
    const auto& old = before_.whole_node;
    std::vector<LocalId> more;
    for (const auto [first, count] : coverage_.ranges)
      for (auto c = first; c < first + count; ++c)
        for (const auto node : whole_.mesh.cell_to_node[at(c)]) more.push_back(node);
    std::sort(more.begin(), more.end());
    more.erase(std::unique(more.begin(), more.end()), more.end());
    nodes.reserve(old.size() + more.size());
    std::set_union(old.begin(), old.end(), more.begin(), more.end(), std::back_inserter(nodes));
    place_of_old_node_.reserve(old.size());
    for (LocalId place = 0; const auto node : old) {
      while (nodes[at(place)] < node) ++place;
      place_of_old_node_.push_back(place);
    }
  }

  LocalId place_of_node(bool is_of_whole, LocalId node) const {
    const auto& nodes = after_.whole_node;
    if (is_of_whole) return static_cast<LocalId>(std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin());
    const auto n_old = place_of_old_node_.size();
    return at(node) < n_old ? place_of_old_node_[at(node)] : static_cast<LocalId>(nodes.size() + at(node) - n_old);
  }

  void join_nodes() {
    const auto& mesh = whole_.mesh;
    auto& fine = after_.mesh;
    const auto n_old = before_.whole_node.size(), n_before = before_.mesh.node_position.size();
    reserve_array(fine.node_position, after_.whole_node.size() + n_before - n_old);
    reserve_array(fine.node_global, after_.whole_node.size() + n_before - n_old);
    for (const auto node : after_.whole_node) {
      fine.node_position.push_back(mesh.node_position[at(node)]);
      fine.node_global.push_back(mesh.node_global[at(node)]);
    }
    for (auto i = n_old; i < n_before; ++i) {
      fine.node_position.push_back(before_.mesh.node_position[i]);
      fine.node_global.push_back(before_.mesh.node_global[i]);
    }
    reserve_array(fine.cell_to_node, at(runs_.n_cells()));
    for (const auto& run : runs_.all())
      for (auto c = run.from; c < run.from + run.count; ++c) {
        auto corners = (run.is_of_whole ? mesh : before_.mesh).cell_to_node[at(c)];
        for (auto& node : corners) node = place_of_node(run.is_of_whole, node);
        fine.cell_to_node.push_back(corners);
      }
  }

  void join_links() {
    reserve_array(after_.mesh.cell_to_cell, at(runs_.n_cells()));
    for (const auto& run : runs_.all())
      for (auto c = run.from; c < run.from + run.count; ++c)
        after_.mesh.cell_to_cell.push_back(
            run.is_of_whole ? links_of_whole(runs_, whole_.mesh, run, whole_.mesh.cell_to_cell[at(c)])
                            : links_of_part(runs_, whole_.mesh, before_, c));
  }

  void join_borders() {
    auto& fine = after_.mesh;
    std::vector<std::uint8_t> mine;
    for (const auto face : whole_.mesh.border_face) mine.push_back(runs_.has(face.cell) ? 1 : 0);
    after_.has_face = par::Exchange(comm_, whole_.borders.faces).swap<std::uint8_t>(mine);
    for (std::size_t k = 0; k < mine.size(); ++k) after_.has_face[k] = after_.has_face[k] != 0 && mine[k] != 0 ? 1 : 0;
    auto border = join_border_faces(runs_, whole_.mesh, before_, after_.has_face);
    fine.border_rank = std::move(border.border_rank);
    fine.border_offset = std::move(border.border_offset);
    fine.border_face = std::move(border.border_face);
    for (LocalId k = 0; const auto face : fine.border_face)
      fine.cell_to_cell[at(face.cell)][at(face.slot)] = runs_.n_cells() + k++;
  }

  void number_cells() {
    auto& fine = after_.mesh;
    fine.info.n_global_cells = number_in_order(comm_, runs_, whole_.mesh, before_, fine.cell_global);
    fine.ghost_global = numbers_behind_border(comm_, fine);
  }

  void join_fields() {
    const auto& fields = was_empty() ? whole_.mesh : before_.mesh;
    for (const auto& field : fields.node_fields) {
      auto& joined = after_.mesh.node_fields.emplace_back(
          mesh::NodeField{field.name, field.unit, field.n_components, field.storage, {}});
      const auto* of_whole = whole_.mesh.find_node_field(field.name);
      if (field.holds_integers())
        joined.value = join_nodal<std::int64_t>(of_whole, was_empty() ? nullptr : &field);
      else
        joined.value = join_nodal<double>(of_whole, was_empty() ? nullptr : &field);
    }
    for (const auto& field : fields.cell_fields) {
      auto& joined = after_.mesh.cell_fields.emplace_back(
          mesh::CellField{field.name, field.unit, field.n_components, field.storage, {}});
      const auto* of_whole = whole_.mesh.find_cell_field(field.name);
      if (field.holds_integers())
        joined.value = join_cells<std::int64_t>(*of_whole, was_empty() ? nullptr : &field);
      else
        joined.value = join_cells<double>(*of_whole, was_empty() ? nullptr : &field);
    }
  }

  /// Values of the nodes, 0 where the whole mesh does not have the field.
  template <class T>
  std::vector<T> join_nodal(const mesh::NodeField* of_whole, const mesh::NodeField* of_before) const {
    const auto width = at((of_whole != nullptr ? of_whole : of_before)->n_components);
    std::vector<T> values;
    for (const auto node : after_.whole_node)
      for (std::size_t k = 0; k < width; ++k)
        values.push_back(of_whole == nullptr ? T{0} : std::get<std::vector<T>>(of_whole->value)[at(node) * width + k]);
    if (of_before == nullptr) return values;
    const auto& more = std::get<std::vector<T>>(of_before->value);
    values.insert(values.end(), more.begin() + static_cast<std::ptrdiff_t>(before_.whole_node.size() * width),
                  more.end());
    return values;
  }

  template <class T>
  std::vector<T> join_cells(const mesh::CellField& of_whole, const mesh::CellField* of_before) const {
    std::span<const T> before;
    if (of_before != nullptr) before = std::get<std::vector<T>>(of_before->value);
    return runs_.join<T>(std::get<std::vector<T>>(of_whole.value), before, at(of_whole.n_components));
  }

  const par::Comm& comm_;
  const WholeMesh& whole_;
  const MeshPart& before_;
  const Coverage& coverage_;
  PartRuns runs_;
  MeshPart after_;
  std::vector<LocalId> place_of_old_node_;  ///< of the nodes of the whole mesh in the part before
};

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

std::vector<LocalId> open_nodes(const MeshPart& part) {
  const auto open = open_slot(part.mesh.info);
  std::vector<LocalId> nodes;
  for (const auto c : open_cells(part))
    for (int face = 0; face < 4; ++face)
      if (part.mesh.cell_to_cell[at(c)][at(face)] == open)
        for (const auto corner : mesh::tet::face_to_corner[at(face)])
          nodes.push_back(part.mesh.cell_to_node[at(c)][at(corner)]);
  return nodes;
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
  auto wider = Widener(comm, whole, part, coverage).run();
  for (const auto [first, count] : coverage.ranges)
    std::fill_n(coverage.of_cell.begin() + first, count, Coverage::held);
  coverage.ranges.clear();
  return wider;
}

}  // namespace pamr::adapt
