// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/certify.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/refine/project.hpp"

namespace pamr::refine {

namespace {

constexpr std::uint8_t not_at_all = 10;  ///< backing-off step at which a node stays where it was

geometry::Vec3 place(const Movable& m, std::uint8_t step) {
  if (step == 0) return m.target;
  if (step >= not_at_all) return m.base;
  return m.base + std::ldexp(1.0, -static_cast<int>(step)) * (m.target - m.base);
}

bool is_positive(const mesh::DistMesh& mesh, LocalId cell) {
  const auto p = mesh.points(cell);
  return geometry::is_positive(p[0], p[1], p[2], p[3]);
}

/// Cells of both lists, each once; `moved` ascends.
std::vector<LocalId> join(const std::vector<LocalId>& moved, std::span<const LocalId> suspects) {
  std::vector<LocalId> cells(moved);
  cells.insert(cells.end(), suspects.begin(), suspects.end());
  const auto middle = cells.begin() + static_cast<std::ptrdiff_t>(moved.size());
  std::sort(middle, cells.end());
  std::inplace_merge(cells.begin(), middle, cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

std::string describe(const mesh::DistMesh& mesh, LocalId cell) {
  return "refine: expected children of positive volume, found one that rounding turns over in the new cell " +
         std::to_string(mesh.cell_global[at(cell)]) + ": the cell it comes from is too flat to be split";
}

/// Takes the movement of one set of nodes back step by step.
class BackOff {
 public:
  BackOff(const par::Comm& comm, mesh::DistMesh& fine, const par::Pattern& shared, const std::vector<Movable>& movables,
          bool any_moves)
      : comm_(comm), fine_(fine), exchange_(comm, shared), movables_(movables), step_(movables.size(), 0) {
    if (!any_moves) return;
    movable_of_.assign(at(fine.n_nodes()), -1);
    for (std::size_t i = 0; i < movables.size(); ++i) {
      movable_of_[at(movables[i].node)] = static_cast<LocalId>(i);
      fine.node_position[at(movables[i].node)] = movables[i].target;
    }
  }

  const std::vector<LocalId>& movable_of() const { return movable_of_; }
  std::uint8_t step(std::size_t movable) const { return step_[movable]; }

  /// One round; true when every rank found its cells positive.
  bool settle(std::span<const LocalId> cells) {
    std::vector<std::uint8_t> wanted = step_;
    bool all_positive = true;
    std::string trouble;
    for (const auto c : cells) {
      if (is_positive(fine_, c)) continue;
      all_positive = false;
      bool can_yield = false;
      if (!movable_of_.empty())
        for (const auto node : fine_.cell_to_node[at(c)]) {
          const auto i = movable_of_[at(node)];
          if (i < 0 || step_[at(i)] >= not_at_all) continue;
          can_yield = true;
          wanted[at(i)] = static_cast<std::uint8_t>(step_[at(i)] + 1);
        }
      if (!can_yield && trouble.empty()) trouble = describe(fine_, c);
    }
    if (!comm_.any(!all_positive)) return true;
    par::agree(comm_, [&] {
      if (!trouble.empty()) throw Error(trouble);
    });
    share(wanted);
    for (std::size_t i = 0; i < step_.size(); ++i)
      if (wanted[i] != step_[i]) {
        step_[i] = wanted[i];
        fine_.node_position[at(movables_[i].node)] = place(movables_[i], step_[i]);
      }
    return false;
  }

 private:
  void share(std::vector<std::uint8_t>& wanted) const {
    std::vector<std::uint8_t> mine;
    for (const auto node : exchange_.pattern().item)
      mine.push_back(movable_of_[at(node)] < 0 ? std::uint8_t{0} : wanted[at(movable_of_[at(node)])]);
    const auto theirs = exchange_.swap<std::uint8_t>(mine);
    for (std::size_t k = 0; k < theirs.size(); ++k) {
      const auto i = movable_of_[at(exchange_.pattern().item[k])];
      if (i >= 0) wanted[at(i)] = std::max(wanted[at(i)], theirs[k]);
    }
  }

  const par::Comm& comm_;
  mesh::DistMesh& fine_;
  par::Exchange exchange_;
  const std::vector<Movable>& movables_;
  std::vector<std::uint8_t> step_;
  std::vector<LocalId> movable_of_;
};

}  // namespace

std::vector<LocalId> cells_with_moved_nodes(const mesh::DistMesh& fine, const std::vector<Movable>& movables) {
  std::vector<LocalId> cells;
  if (movables.empty()) return cells;
  std::vector<std::uint8_t> moves(at(fine.n_nodes()), 0);
  for (const auto& m : movables) moves[at(m.node)] = 1;
  for (LocalId c = 0; c < fine.n_cells(); ++c) {
    const auto& nodes = fine.cell_to_node[at(c)];
    if ((moves[at(nodes[0])] | moves[at(nodes[1])] | moves[at(nodes[2])] | moves[at(nodes[3])]) != 0)
      cells.push_back(c);
  }
  return cells;
}

Certificate certify(const par::Comm& comm, mesh::DistMesh& fine, const par::Pattern& shared,
                    const geometry::SurfaceSet& surfaces, const std::vector<Movable>& movables, bool any_moves,
                    const std::vector<LocalId>& moved_cells, std::span<const LocalId> suspects) {
  BackOff back_off(comm, fine, shared, movables, any_moves);
  const auto cells = join(moved_cells, suspects);
  Certificate certificate;
  while (!back_off.settle(cells)) ++certificate.rounds;
  if (!any_moves) return certificate;

  std::vector<std::uint8_t> is_mine(at(fine.n_nodes()), 1);  // the lowest rank that holds a node counts it
  for (std::size_t i = 0; i < shared.rank.size(); ++i)
    for (auto k = shared.offset[i]; k < shared.offset[i + 1]; ++k)
      if (shared.rank[i] < comm.rank()) is_mine[at(shared.item[k])] = 0;
  std::int64_t n_off = 0, n_moved = 0;
  for (std::size_t i = 0; i < movables.size(); ++i) {
    const auto& m = movables[i];
    if (!(fine.point(m.node) == m.base)) n_moved += is_mine[at(m.node)];
    if (m.patch[0] < 0 || (back_off.step(i) == 0 && m.is_reachable)) continue;
    const auto on = surfaces_of_node(fine.info, surfaces, m.patch);
    certificate.ledger.push_back({m.node, geometry::distance_from_all(on.surface, fine.point(m.node))});
    n_off += is_mine[at(m.node)];
  }
  std::sort(certificate.ledger.begin(), certificate.ledger.end(),
            [](const OffSurface& a, const OffSurface& b) { return a.node < b.node; });
  std::array<std::int64_t, 3> sum{n_off, n_moved, static_cast<std::int64_t>(cells.size())};
  comm.sum_in_place(sum);
  certificate.n_off_surface = sum[0];
  certificate.n_moved = sum[1];
  certificate.n_cells_checked = sum[2];
  return certificate;
}

}  // namespace pamr::refine
