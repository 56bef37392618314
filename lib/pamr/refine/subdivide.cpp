// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/subdivide.hpp"

#include <algorithm>
#include <bit>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/refine/diagonal.hpp"
#include "pamr/refine/family.hpp"

namespace pamr::refine {

namespace {

using geometry::Vec3;

class Splitter {
 public:
  Splitter(const NumberedMesh& old, const std::vector<Vec3>& position)
      : mesh_(old.mesh), closure_(old.closure), numbering_(old.numbering), position_(position) {
    const auto n = at(numbering_.first_child.back());
    reserve_array(children_.cell_to_node, n);
    reserve_array(children_.lineage, n);
    reserve_array(children_.cell_global, n);
    assign_array(children_.state, at(mesh_.n_cells()), SplitState{0});
  }

  Children run() && {
    auto family = closure_.rebuilt.begin();
    bool family_is_broken = false;
    for (LocalId c = 0; c < mesh_.n_cells(); ++c) {
      const auto lineage = mesh_.lineage[at(c)];
      if (closure_.action[at(c)] == Action::rebuild) split_family(*family++);
      if (closure_.action[at(c)] != Action::split) continue;
      if (lineage.is_removable() && lineage.child() == 0)
        family_is_broken = any_member_splits(c, lineage.family_size());
      if (closure_.marks[at(c)] == 0)
        append_unsplit(c, lineage.is_removable() && family_is_broken ? lineage.broken() : lineage);
      else
        split(c);
    }
    return std::move(children_);
  }

 private:
  bool any_member_splits(LocalId first, int size) const {
    return std::any_of(closure_.marks.begin() + first, closure_.marks.begin() + first + size,
                       [](EdgeMask m) { return m != 0; });
  }

  /// Children come in ascending order, so they are simply appended.
  void append(GlobalId global, const mesh::CellNodes& nodes, mesh::Lineage lineage) {
    children_.cell_to_node.push_back(nodes);
    children_.lineage.push_back(lineage);
    children_.cell_global.push_back(global);
  }

  void append_unsplit(LocalId c, mesh::Lineage lineage) {
    append(numbering_.first_child_global[at(c)], mesh_.cell_to_node[at(c)], lineage);
  }

  /// Of a child of a base cell that is split by that state.
  static mesh::Lineage lineage_of(int state, int child, mesh::Lineage base) {
    if (!is_regular_split(state)) return base.closed(state, child);
    PAMR_EXPECTS(base.level() < mesh::max_level);
    return base.red_child(child);
  }

  void split(LocalId c) {
    const auto marks = closure_.marks[at(c)];
    const auto& corner = mesh_.cell_to_node[at(c)];
    std::array<LocalId, 10> node{};
    SplitPoints points;
    for (int i = 0; i < 4; ++i) {
      node[at(i)] = corner[at(i)];
      points[at(i)] = position_[at(corner[at(i)])];
    }
    const auto& midpoints = numbering_.edge_to_node[at(numbering_.row[at(c)])];
    for (int e = 0; e < 6; ++e) {
      if ((marks >> e & 1) == 0) continue;
      node[at(4 + e)] = midpoints[at(e)];
      points[at(4 + e)] = position_[at(midpoints[at(e)])];
    }
    int state = closure_.state[at(c)];
    if (is_regular_split(state)) state += choose_diagonal(points, is_straight(points));
    children_.state[at(c)] = static_cast<SplitState>(state);

    const auto& pattern = split_pattern[at(state)];
    const auto first = numbering_.first_child[at(c)];
    const auto global = numbering_.first_child_global[at(c)];
    const auto base = mesh_.lineage[at(c)].base_for_split();
    for (int child = 0; child < pattern.n_children; ++child) {
      const auto& code = pattern.child_to_node[at(child)];
      append(global + child, {node[at(code[0])], node[at(code[1])], node[at(code[2])], node[at(code[3])]},
             lineage_of(state, child, base));
    }
    if (!is_far_from_flat(points))
      for (int child = 0; child < pattern.n_children; ++child) children_.suspects.push_back(first + child);
  }

  /// Nodes of a rebuilt family: those of the parent by code, and those in the middle of the parts of its split edges
  /// and face.
  struct FamilyNodes {
    std::array<LocalId, 10> parent{};
    std::array<std::array<LocalId, 10>, 10> part{};
  };

  FamilyNodes gather(const RebuiltFamily& family) const {
    const auto view = view_family(mesh_, closure_.marks, family.first);
    FamilyNodes nodes;
    nodes.parent = view.node;
    const auto& pattern = split_pattern[at(view.state)];
    for (int member = 0; member < pattern.n_children; ++member)
      for (unsigned marks = closure_.marks[at(family.first + member)]; marks != 0; marks &= marks - 1) {
        const int e = std::countr_zero(marks);
        const auto edge = family_table[at(view.state)].edge[at(member)][at(e)];
        const auto node = numbering_.midpoint(family.first + member, e);
        const auto& code = pattern.child_to_node[at(member)];
        const auto [p, q] = mesh::tet::edge_to_corner[at(e)];
        if (edge.role == EdgeRole::parent)
          nodes.parent[at(4 + edge.parent_edge)] = node;
        else
          nodes.part[at(code[at(p)])][at(code[at(q)])] = nodes.part[at(code[at(q)])][at(code[at(p)])] = node;
      }
    return nodes;
  }

  void split_family(const RebuiltFamily& family) {
    const auto nodes = gather(family);
    const auto base = mesh_.lineage[at(family.first)].base();
    const auto first = numbering_.first_child[at(family.first)];
    const auto global = numbering_.first_child_global[at(family.first)];
    int n = 0;
    for_each_grandchild(family, [&](int child, int state, int grandchild) {
      const auto& parent_code = split_pattern[family.state].child_to_node[at(child)];
      const auto& code = split_pattern[at(state)].child_to_node[at(grandchild)];
      mesh::CellNodes cell{};
      for (int slot = 0; slot < 4; ++slot) {
        const int c = code[at(slot)];
        if (c < 4) {
          cell[at(slot)] = nodes.parent[at(parent_code[at(c)])];
        } else {
          const auto [p, q] = mesh::tet::edge_to_corner[at(c - 4)];
          cell[at(slot)] = nodes.part[at(parent_code[at(p)])][at(parent_code[at(q)])];
        }
      }
      const auto made = lineage_of(family.state, child, base);
      append(global + n, cell, state == 0 ? made : lineage_of(state, grandchild, made));
      if (!family.is_safe) children_.suspects.push_back(first + n);
      ++n;
    });
    PAMR_ENSURES(n == family.n_children);
  }

  const mesh::DistMesh& mesh_;
  const Closure& closure_;
  const Numbering& numbering_;
  const std::vector<Vec3>& position_;
  Children children_;
};

}  // namespace

Children subdivide(const NumberedMesh& old, const std::vector<geometry::Vec3>& node_position) {
  PAMR_EXPECTS(node_position.size() == at(old.mesh.n_nodes()) + old.numbering.n_new_nodes());
  return Splitter(old, node_position).run();
}

}  // namespace pamr::refine
