// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/close.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/refine/family.hpp"
#include "pamr/refine/propagation.hpp"

namespace pamr::refine {

namespace {

/// Settles this rank, tells the neighbors which border edges are marked, and so on until nobody has news. Returns the
/// number of exchanges.
int settle_all(const par::Comm& comm, const mesh::Borders& borders, Propagation& propagation) {
  const par::Exchange exchange(comm, borders.edges);
  std::vector<std::uint8_t> mine(borders.edges.n_slots());
  std::vector<std::uint8_t> is_marked(borders.n_edges(), 0);
  int rounds = 0;
  for (bool news = true; news;) {
    propagation.settle();
    for (std::size_t i = 0; i < borders.n_edges(); ++i)
      for (const auto arc : borders.arcs(i))
        if (propagation.is_marked(arc.cell, arc.edge)) is_marked[i] = 1;
    for (std::size_t k = 0; k < mine.size(); ++k) mine[k] = is_marked[at(borders.edges.item[k])];
    const auto theirs = exchange.swap<std::uint8_t>(mine);
    ++rounds;
    for (std::size_t k = 0; k < theirs.size(); ++k)
      if (theirs[k] != 0) is_marked[at(borders.edges.item[k])] = 1;
    bool changed = false;
    for (std::size_t i = 0; i < borders.n_edges(); ++i)
      for (const auto arc : borders.arcs(i))
        if (is_marked[i] != 0 && !propagation.is_marked(arc.cell, arc.edge)) {
          propagation.mark(arc.cell, arc.edge);
          changed = true;
        }
    news = comm.any(changed);
  }
  return rounds;
}

/// Knows the half faces: faces of members of whole families that are half of a face of the parent. Such a face has to
/// be kept or taken back on both sides.
class Halves {
 public:
  explicit Halves(const mesh::DistMesh& mesh) : mesh_(mesh) {
    for (std::uint32_t bits = 0; bits < slots_.size(); ++bits)
      if (const mesh::Lineage lineage(bits); mesh::is_well_formed(lineage) && lineage.is_closure())
        for (int slot = 0; slot < 4; ++slot)
          if (is_bisected_face(lineage, slot)) slots_[bits] = static_cast<std::uint8_t>(slots_[bits] | 1U << slot);
  }

  /// Bit i: the face in slot i.
  unsigned slots(LocalId cell) const {
    const auto lineage = mesh_.lineage[at(cell)];
    return lineage.is_broken() ? 0U : static_cast<unsigned>(slots_[lineage.bits() & 0x7fU]);
  }
  bool is_half(mesh::CellFace face) const { return (slots(face.cell) >> face.slot & 1U) != 0; }
  /// The same of the face as the own cell `next` behind it has it.
  bool is_half_behind(LocalId cell, LocalId next) const {
    return is_half({next, mesh::slot_of(mesh_.cell_to_cell[at(next)], cell)});
  }

 private:
  static bool is_bisected_face(mesh::Lineage lineage, int slot) {
    const auto& pattern = split_pattern[at(state_of_family(lineage))];
    const int link = pattern.child_to_child[at(lineage.child())][at(slot)];
    return link < 0 && outer_place(link) != whole &&
           std::popcount(static_cast<unsigned>(pattern.mask & mesh::tet::face_edge_mask[at(outer_face(link))])) == 1;
  }

  const mesh::DistMesh& mesh_;
  std::array<std::uint8_t, 128> slots_{};  ///< by the lineage's kind, template and child
};

/// True when a family cannot be taken back because the own cell behind one of its half faces needs it: that cell is of
/// no whole family that has this half. So it is where families were split, under a policy that lets that happen or
/// because they were kept.
bool lacks_partner(const mesh::DistMesh& mesh, const Halves& halves, LocalId first) {
  for (LocalId c = first; c < first + mesh.lineage[at(first)].family_size(); ++c)
    for (unsigned slots = halves.slots(c); slots != 0; slots &= slots - 1) {
      const auto next = mesh.cell_to_cell[at(c)][at(std::countr_zero(slots))];
      if (mesh.is_own(next) && !halves.is_half_behind(c, next)) return true;
    }
  return false;
}

/// Members of such families whose half face lies on the rank border. Collective: one exchange of a byte a border face.
std::vector<LocalId> without_partner_on_border(const par::Comm& comm, const mesh::DistMesh& mesh,
                                               const mesh::Borders& borders, const Halves& halves) {
  std::vector<std::uint8_t> mine;
  for (const auto face : mesh.border_face) mine.push_back(halves.is_half(face) ? 1 : 0);
  const auto theirs = par::Exchange(comm, borders.faces).swap<std::uint8_t>(mine);
  std::vector<LocalId> members;
  for (std::size_t k = 0; k < theirs.size(); ++k)
    if (mine[k] != 0 && theirs[k] == 0) members.push_back(mesh.border_face[k].cell);
  return members;
}

/// Adds the first members of all families of this rank that lack a partner inside it.
void add_without_partner_inside(const mesh::DistMesh& mesh, const Halves& halves, std::vector<LocalId>& members) {
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (mesh.lineage[at(c)].is_removable() && mesh.lineage[at(c)].child() == 0 && lacks_partner(mesh, halves, c))
      members.push_back(c);
}

void keep_family(const mesh::DistMesh& mesh, LocalId cell, std::vector<std::uint8_t>& kept,
                 std::vector<LocalId>& fresh) {
  const auto lineage = mesh.lineage[at(cell)];
  const auto first = cell - lineage.child();
  if (!lineage.is_removable() || kept[at(first)] != 0) return;
  for (int child = 0; child < lineage.family_size(); ++child) {
    kept[at(first + child)] = 1;
    fresh.push_back(first + child);
  }
}

/// Families that cannot be taken back stay; so do, one after another, those that share a half face with them.
void keep_families(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                   const Halves& halves, const std::vector<LocalId>& stuck, std::vector<std::uint8_t>& kept) {
  kept.resize(at(mesh.n_cells()), 0);
  std::vector<LocalId> fresh;
  for (const auto member : stuck) keep_family(mesh, member, kept, fresh);
  const par::Exchange exchange(comm, borders.faces);
  for (bool news = true; news;) {
    while (!fresh.empty()) {
      const auto cell = fresh.back();
      fresh.pop_back();
      for (unsigned slots = halves.slots(cell); slots != 0; slots &= slots - 1) {
        const auto next = mesh.cell_to_cell[at(cell)][at(std::countr_zero(slots))];
        if (mesh.is_own(next) && halves.is_half_behind(cell, next)) keep_family(mesh, next, kept, fresh);
      }
    }
    std::vector<std::uint8_t> mine;
    for (const auto face : mesh.border_face) mine.push_back(kept[at(face.cell)] != 0 && halves.is_half(face) ? 1 : 0);
    const auto theirs = exchange.swap<std::uint8_t>(mine);
    for (std::size_t k = 0; k < theirs.size(); ++k)
      if (theirs[k] != 0 && halves.is_half(mesh.border_face[k]))
        keep_family(mesh, mesh.border_face[k].cell, kept, fresh);
    news = comm.any(!fresh.empty());
  }
}

/// Plans how families are split anew, ascending. Returns those that cannot be.
std::vector<LocalId> plan_families(const mesh::DistMesh& mesh, const std::vector<EdgeMask>& marks,
                                   const std::vector<LocalId>& hit, std::vector<RebuiltFamily>& rebuilt) {
  constexpr std::size_t ahead = 8;
  std::vector<LocalId> stuck;
  reserve_array(rebuilt, hit.size());
  for (std::size_t i = 0; i < hit.size(); ++i) {
    if (i + 2 * ahead < hit.size()) prefetch(&mesh.cell_to_node[at(hit[i + 2 * ahead])]);
    if (i + ahead < hit.size())  // two members have all nodes but one
      for (int member = 0; member < 2; ++member)
        for (const auto node : mesh.cell_to_node[at(hit[i + ahead] + member)]) prefetch(&mesh.node_position[at(node)]);
    const auto plan = plan_family(mesh, view_family(mesh, marks, hit[i]));
    if (plan.state < 0)
      stuck.push_back(hit[i]);
    else
      rebuilt.push_back(plan);
  }
  return stuck;
}

std::int64_t count_kept_and_hit(const mesh::DistMesh& mesh, const std::vector<std::uint8_t>& kept,
                                const std::vector<EdgeMask>& marks) {
  std::int64_t n = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (!kept.empty() && kept[at(c)] != 0 && mesh.lineage[at(c)].child() == 0) {
      unsigned any = 0;
      for (int child = 0; child < mesh.lineage[at(c)].family_size(); ++child) any |= marks[at(c + child)];
      n += any != 0 ? 1 : 0;
    }
  return n;
}

}  // namespace

Closure close(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
              std::span<const std::uint8_t> flags, QualityControl policy) {
  PAMR_EXPECTS(flags.size() == at(mesh.n_cells()));
  Closure closure;
  std::vector<std::uint8_t> kept;
  const Halves halves(mesh);
  // All families without partner are kept before anything is marked, those that nobody will hit as well: they keep
  // families beside them, and which of these are met first would depend on the partition.
  if (policy == QualityControl::removable && !mesh.info.halves_are_paired) {
    auto alone = without_partner_on_border(comm, mesh, borders, halves);
    add_without_partner_inside(mesh, halves, alone);
    if (comm.any(!alone.empty())) keep_families(comm, mesh, borders, halves, alone, kept);
  }
  for (;;) {
    Propagation propagation(mesh, flags, kept, policy);
    closure.report.rounds += settle_all(comm, borders, propagation);
    const auto hit = propagation.hit_families();
    closure.marks = std::move(propagation).take_marks();
    closure.rebuilt.clear();
    const auto stuck = plan_families(mesh, closure.marks, hit, closure.rebuilt);
    if (!comm.any(!stuck.empty())) break;
    keep_families(comm, mesh, borders, halves, stuck, kept);
  }
  // With no family kept none is split while it is whole; what is made at a halved face is a whole family on both sides.
  closure.halves_are_paired = policy == QualityControl::removable && kept.empty();
  std::array<std::int64_t, 3> sum{std::count_if(flags.begin(), flags.end(), [](auto flag) { return flag != 0; }),
                                  count_kept_and_hit(mesh, kept, closure.marks),
                                  static_cast<std::int64_t>(closure.rebuilt.size())};
  comm.sum_in_place(sum);
  closure.report.n_marked = sum[0];
  closure.report.families_kept = sum[1];
  closure.report.families_rebuilt = sum[2];
  assign_array(closure.action, at(mesh.n_cells()), Action::split);
  for (const auto& family : closure.rebuilt) {
    closure.action[at(family.first)] = Action::rebuild;
    for (int child = 1; child < mesh.lineage[at(family.first)].family_size(); ++child)
      closure.action[at(family.first + child)] = Action::absorbed;
  }
  return closure;
}

}  // namespace pamr::refine
