// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/mesh_part.hpp"

#include <algorithm>
#include <numeric>
#include <type_traits>
#include <utility>
#include <variant>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/cell_runs.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::adapt {

namespace {

/// Cells that follow each other, in the whole mesh or in the part before, and in the new part.
struct Run {
  bool is_of_whole = false;
  LocalId from = 0, to = 0, count = 0;
};

class Widener {
 public:
  Widener(const par::Comm& comm, const WholeMesh& whole, const MeshPart& before, std::vector<std::uint8_t> holds)
      : comm_(comm), whole_(whole), before_(before) {
    after_.holds = std::move(holds);
    find_runs();
  }

  MeshPart run() && {
    const auto& [mesh, borders, requests, closure] = whole_;
    after_.mesh.info = was_empty() ? mesh.info : before_.mesh.info;
    after_.mesh.info.cut_faces_conform = closure.cut_faces_conform;
    after_.whole_cell = cells_of_whole();
    after_.requests = join<std::uint8_t>(requests, before_.requests);
    after_.mesh.lineage = join<mesh::Lineage>(mesh.lineage, before_.mesh.lineage);
    after_.mesh.cell_origin =
        join<GlobalId>(mesh.cell_origin.empty() ? mesh.cell_global : mesh.cell_origin, before_.mesh.cell_origin);
    after_.known.marks = join<refine::EdgeMask>(closure.marks, before_.known.marks);
    join_plans();
    join_nodes();
    join_links();
    join_borders();
    number_cells();
    join_fields();
    return std::move(after_);
  }

 private:
  bool was_empty() const { return before_.holds.empty(); }
  bool held(LocalId cell) const { return !was_empty() && before_.holds[at(cell)] != 0; }

  void append(bool is_of_whole, LocalId from, LocalId count) {
    if (!runs_.empty() && runs_.back().is_of_whole == is_of_whole && runs_.back().from + runs_.back().count == from)
      runs_.back().count += count;
    else
      runs_.push_back({is_of_whole, from, n_cells_, count});
    n_cells_ += count;
  }

  void find_runs() {
    const auto n_before = static_cast<LocalId>(before_.whole_cell.size());
    place_of_before_.reserve(at(n_before));
    for (LocalId c = 0, next = 0; c < whole_.mesh.n_cells();) {
      auto end = c;
      while (end < whole_.mesh.n_cells() && after_.holds[at(end)] != 0 && !held(end)) ++end;
      if (end > c) append(true, c, end - c);
      for (c = end; c < whole_.mesh.n_cells() && (held(c) || after_.holds[at(c)] == 0); ++c)
        for (; next < n_before && before_.whole_cell[at(next)] == c; ++next) {
          place_of_before_.push_back(n_cells_);
          append(false, next, 1);
        }
    }
    PAMR_ENSURES(place_of_before_.size() == at(n_before));
  }

  /// Rows of the runs' cells, `width` items each.
  template <class T>
  std::vector<T> join(std::span<const T> of_whole, std::span<const T> of_before, std::size_t width = 1) const {
    std::vector<T> rows;
    reserve_array(rows, at(n_cells_) * width);
    for (const auto& run : runs_) {
      const auto from = (run.is_of_whole ? of_whole : of_before).subspan(at(run.from) * width, at(run.count) * width);
      rows.insert(rows.end(), from.begin(), from.end());
    }
    return rows;
  }

  std::vector<LocalId> cells_of_whole() const {
    std::vector<LocalId> cells;
    reserve_array(cells, at(n_cells_));
    for (const auto& run : runs_)
      for (auto c = run.from; c < run.from + run.count; ++c)
        cells.push_back(run.is_of_whole ? c : before_.whole_cell[at(c)]);
    return cells;
  }

  /// Where a cell of the whole mesh that the part holds is now, or its first descendant. `hint`: a run that it may be
  /// in.
  LocalId place_of(LocalId cell, const Run& hint) const {
    if (hint.is_of_whole && cell >= hint.from && cell < hint.from + hint.count) return hint.to + (cell - hint.from);
    if (held(cell)) {
      const auto& cells = before_.whole_cell;
      return place_of_before_[at(std::lower_bound(cells.begin(), cells.end(), cell) - cells.begin())];
    }
    const auto next = std::upper_bound(first_of_runs_.begin(), first_of_runs_.end(), cell);
    const auto& run = runs_[run_of_first_[at(next - first_of_runs_.begin() - 1)]];
    return run.to + (cell - run.from);
  }

  void join_plans() {
    for (std::size_t i = 0; i < runs_.size(); ++i)
      if (runs_[i].is_of_whole) {
        first_of_runs_.push_back(runs_[i].from);
        run_of_first_.push_back(i);
      }
    const auto is_earlier = [](const refine::RebuiltFamily& a, const refine::RebuiltFamily& b) {
      return a.first < b.first;
    };
    std::vector<refine::RebuiltFamily> plans;
    for (auto plan : whole_.closure.rebuilt) {
      if (after_.holds[at(plan.first)] == 0 || held(plan.first)) continue;
      plan.first = place_of(plan.first, {});
      plans.push_back(plan);
    }
    const auto middle = std::ssize(plans);
    for (auto plan : before_.known.plans) {
      plan.first = place_of_before_[at(plan.first)];
      plans.push_back(plan);
    }
    std::inplace_merge(plans.begin(), plans.begin() + middle, plans.end(), is_earlier);
    after_.known.plans = std::move(plans);
  }

  /// Numbers the nodes of the whole mesh that are needed, and after them the new ones.
  void join_nodes() {
    const auto& mesh = whole_.mesh;
    auto& nodes = after_.whole_node;
    std::vector<LocalId> place(at(mesh.n_nodes()), invalid_local);
    for (const auto node : before_.whole_node) place[at(node)] = 0;
    for (const auto& run : runs_)
      for (auto c = run.from; run.is_of_whole && c < run.from + run.count; ++c)
        for (const auto node : mesh.cell_to_node[at(c)]) place[at(node)] = 0;
    for (LocalId node = 0; node < mesh.n_nodes(); ++node) {
      if (place[at(node)] == invalid_local) continue;
      place[at(node)] = static_cast<LocalId>(nodes.size());
      nodes.push_back(node);
    }
    n_old_before_ = before_.whole_node.size();
    auto& fine = after_.mesh;
    const auto n_nodes = nodes.size() + before_.mesh.node_position.size() - n_old_before_;
    reserve_array(fine.node_position, n_nodes);
    reserve_array(fine.node_global, n_nodes);
    for (const auto node : nodes) {
      fine.node_position.push_back(mesh.node_position[at(node)]);
      fine.node_global.push_back(mesh.node_global[at(node)]);
    }
    for (auto i = n_old_before_; i < before_.mesh.node_position.size(); ++i) {
      fine.node_position.push_back(before_.mesh.node_position[i]);
      fine.node_global.push_back(before_.mesh.node_global[i]);
    }
    reserve_array(fine.cell_to_node, at(n_cells_));
    for (const auto& run : runs_)
      for (auto c = run.from; c < run.from + run.count; ++c) {
        auto corners = (run.is_of_whole ? mesh : before_.mesh).cell_to_node[at(c)];
        for (auto& node : corners) node = run.is_of_whole ? place[at(node)] : place_of_node(node, place);
        fine.cell_to_node.push_back(corners);
      }
  }

  LocalId place_of_node(LocalId node, const std::vector<LocalId>& place) const {
    if (at(node) < n_old_before_) return place[at(before_.whole_node[at(node)])];
    return static_cast<LocalId>(after_.whole_node.size() + at(node) - n_old_before_);
  }

  void join_links() {
    const auto open = patch_slot_beyond();
    reserve_array(after_.mesh.cell_to_cell, at(n_cells_));
    for (const auto& run : runs_)
      for (auto c = run.from; c < run.from + run.count; ++c) {
        auto links = (run.is_of_whole ? whole_.mesh : before_.mesh).cell_to_cell[at(c)];
        for (int face = 0; face < 4; ++face) {
          auto& slot = links[at(face)];
          if (run.is_of_whole)
            slot = link_to_whole(slot, run, open);
          else if (slot == open)
            slot = link_to_whole(whole_.mesh.cell_to_cell[at(before_.whole_cell[at(c)])][at(face)], {}, open);
          else if (slot >= 0)
            slot = before_.mesh.is_own(slot) ? place_of_before_[at(slot)] : open;
        }
        after_.mesh.cell_to_cell.push_back(links);
      }
  }

  /// Rank-border faces stay open here.
  LocalId link_to_whole(LocalId slot, const Run& hint, LocalId open) const {
    if (slot < 0) return slot;
    return whole_.mesh.is_own(slot) && after_.holds[at(slot)] != 0 ? place_of(slot, hint) : open;
  }

  LocalId patch_slot_beyond() const { return mesh::patch_to_slot(static_cast<int>(whole_.mesh.info.patches.size())); }

  /// Rank-border faces of the part before come first, then those that are new to it: the same on both sides.
  void join_borders() {
    const auto& mesh = whole_.mesh;
    auto& fine = after_.mesh;
    std::vector<std::uint8_t> mine;
    for (const auto face : mesh.border_face) mine.push_back(after_.holds[at(face.cell)]);
    after_.has_face = par::Exchange(comm_, whole_.borders.faces).swap<std::uint8_t>(mine);
    for (std::size_t k = 0; k < mine.size(); ++k) after_.has_face[k] = after_.has_face[k] != 0 && mine[k] != 0 ? 1 : 0;
    std::size_t of_before = 0;
    for (std::size_t i = 0; i < mesh.border_rank.size(); ++i) {
      if (of_before < before_.mesh.border_rank.size() && before_.mesh.border_rank[of_before] == mesh.border_rank[i]) {
        for (auto k = before_.mesh.border_offset[of_before]; k < before_.mesh.border_offset[of_before + 1]; ++k) {
          const auto [cell, slot] = before_.mesh.border_face[k];
          fine.border_face.push_back({place_of_before_[at(cell)], slot});
        }
        ++of_before;
      }
      for (auto k = mesh.border_offset[i]; k < mesh.border_offset[i + 1]; ++k)
        if (after_.has_face[k] != 0 && (was_empty() || before_.has_face[k] == 0))
          fine.border_face.push_back({place_of(mesh.border_face[k].cell, {}), mesh.border_face[k].slot});
      if (fine.border_face.size() == fine.border_offset.back()) continue;
      fine.border_rank.push_back(mesh.border_rank[i]);
      fine.border_offset.push_back(fine.border_face.size());
    }
    for (LocalId k = 0; const auto face : fine.border_face)
      fine.cell_to_cell[at(face.cell)][at(face.slot)] = n_cells_ + k++;
  }

  /// Numbers without gaps, in the order of the whole mesh.
  void number_cells() {
    auto& fine = after_.mesh;
    const auto first_id = whole_.mesh.info.first_id;
    reserve_array(fine.cell_global, at(n_cells_));
    if (!mesh::cell_runs(comm_, whole_.mesh).empty()) {
      auto next = first_id + comm_.exclusive_sum(n_cells_);
      for (LocalId c = 0; c < n_cells_; ++c) fine.cell_global.push_back(next++);
    } else {
      std::vector<LocalId> count(at(whole_.mesh.n_cells()), 0);
      for (const auto cell : after_.whole_cell) ++count[at(cell)];
      const auto all = whole_.mesh.info.cell_ids();
      const auto block = par::scatter_rows<LocalId>(comm_, all, count, 1, whole_.mesh.cell_global);
      auto next = first_id + comm_.exclusive_sum(std::accumulate(block.begin(), block.end(), std::int64_t{0}));
      std::vector<GlobalId> first;
      for (const auto n : block) {
        first.push_back(next);
        next += n;
      }
      const auto first_here = par::fetch_rows<GlobalId>(comm_, all, first, 1, whole_.mesh.cell_global);
      for (std::size_t c = 0; c < count.size(); ++c)
        for (LocalId i = 0; i < count[c]; ++i) fine.cell_global.push_back(first_here[c] + i);
    }
    fine.info.n_global_cells = comm_.sum(n_cells_);
    std::vector<GlobalId> mine;
    for (const auto face : fine.border_face) mine.push_back(fine.cell_global[at(face.cell)]);
    const par::Pattern faces{fine.border_rank, fine.border_offset, std::vector<LocalId>(fine.border_face.size(), 0)};
    fine.ghost_global = par::Exchange(comm_, faces).swap<GlobalId>(mine);
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
    reserve_array(values, after_.mesh.node_position.size() * width);
    for (const auto node : after_.whole_node)
      for (std::size_t k = 0; k < width; ++k)
        values.push_back(of_whole == nullptr ? T{0} : std::get<std::vector<T>>(of_whole->value)[at(node) * width + k]);
    if (of_before == nullptr) return values;
    const auto& more = std::get<std::vector<T>>(of_before->value);
    values.insert(values.end(), more.begin() + static_cast<std::ptrdiff_t>(n_old_before_ * width), more.end());
    return values;
  }

  template <class T>
  std::vector<T> join_cells(const mesh::CellField& of_whole, const mesh::CellField* of_before) const {
    std::span<const T> before;
    if (of_before != nullptr) before = std::get<std::vector<T>>(of_before->value);
    return join<T>(std::get<std::vector<T>>(of_whole.value), before, at(of_whole.n_components));
  }

  const par::Comm& comm_;
  const WholeMesh& whole_;
  const MeshPart& before_;
  MeshPart after_;
  std::vector<Run> runs_;
  LocalId n_cells_ = 0;
  std::size_t n_old_before_ = 0;
  std::vector<LocalId> place_of_before_;   ///< of each cell of the part before
  std::vector<LocalId> first_of_runs_;     ///< of runs of the whole mesh, ascending
  std::vector<std::size_t> run_of_first_;  ///< the runs
};

/// Cells that were reached and from which to go on.
class Spread {
 public:
  Spread(const mesh::DistMesh& mesh, std::vector<std::uint8_t>& holds) : mesh_(mesh), holds_(holds) {}

  /// `layers`: that the cell's neighbors are away from the end.
  void reach(LocalId cell, int layers) {
    const auto lineage = mesh_.lineage[at(cell)];
    const auto first = lineage.is_removable() ? cell - lineage.child() : cell;
    const auto size = lineage.is_removable() ? lineage.family_size() : 1;
    for (auto member = first; member < first + size; ++member) {
      holds_[at(member)] = 1;
      reached_.push_back({member, layers});
    }
  }
  /// Those behind the faces of what was reached last, and so on.
  void go_on() {
    for (; next_ < reached_.size(); ++next_) {
      const auto [cell, layers] = reached_[next_];
      if (layers == 0) continue;
      for (const auto slot : mesh_.cell_to_cell[at(cell)])
        if (mesh_.is_own(slot) && holds_[at(slot)] == 0) reach(slot, layers - 1);
    }
  }
  /// Of each cell how many more layers there are behind it, and one; 0 where it was not reached.
  std::vector<std::uint8_t> layers_behind() const {
    std::vector<std::uint8_t> layers(holds_.size(), 0);
    for (const auto& [cell, n] : reached_)
      layers[at(cell)] = std::max(layers[at(cell)], static_cast<std::uint8_t>(n + 1));
    return layers;
  }

 private:
  struct Reached {
    LocalId cell = 0;
    int layers = 0;
  };
  const mesh::DistMesh& mesh_;
  std::vector<std::uint8_t>& holds_;
  std::vector<Reached> reached_;
  std::size_t next_ = 0;
};

}  // namespace

std::vector<LocalId> open_cells(const MeshPart& part) {
  std::vector<LocalId> cells;
  for (LocalId c = 0; c < part.mesh.n_cells(); ++c) {
    const auto& slots = part.mesh.cell_to_cell[at(c)];
    if (std::find(slots.begin(), slots.end(), part.open_slot()) != slots.end()) cells.push_back(c);
  }
  return cells;
}

std::vector<LocalId> open_nodes(const MeshPart& part) {
  std::vector<LocalId> nodes;
  for (const auto c : open_cells(part))
    for (int face = 0; face < 4; ++face)
      if (part.mesh.cell_to_cell[at(c)][at(face)] == part.open_slot())
        for (const auto corner : mesh::tet::face_to_corner[at(face)])
          nodes.push_back(part.mesh.cell_to_node[at(c)][at(corner)]);
  return nodes;
}

void spread(const par::Comm& comm, const WholeMesh& whole, const std::vector<LocalId>& seeds, int n_layers,
            std::vector<std::uint8_t>& holds) {
  const auto& mesh = whole.mesh;
  Spread spread(mesh, holds);
  for (const auto cell : seeds) spread.reach(cell, n_layers);
  spread.go_on();
  if (comm.size() == 1) return;
  const auto layers = spread.layers_behind();
  std::vector<std::uint8_t> mine;
  for (const auto face : mesh.border_face) mine.push_back(layers[at(face.cell)]);
  const auto theirs = par::Exchange(comm, whole.borders.faces).swap<std::uint8_t>(mine);
  for (std::size_t k = 0; k < theirs.size(); ++k)
    if (const auto cell = mesh.border_face[k].cell; theirs[k] > 1 && holds[at(cell)] == 0)
      spread.reach(cell, theirs[k] - 2);
  spread.go_on();
}

MeshPart widen(const par::Comm& comm, const WholeMesh& whole, const MeshPart& part, std::vector<std::uint8_t> holds) {
  return Widener(comm, whole, part, std::move(holds)).run();
}

}  // namespace pamr::adapt
