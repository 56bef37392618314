// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_close.hpp"

#include <algorithm>
#include <stdexcept>

#include "support/reference_floor.hpp"

namespace pamr::test {

namespace {

/// What the rules are about: a cell, or the parent of a family that may be taken back.
struct Base {
  GlobalId first = 0;  ///< the cell, or the family's first member
  Piece piece;
  const ReferenceFamily* family = nullptr;
  bool is_flagged = false, is_assessed = false;
  ReferenceFloor floor;
  EdgeSet done;  ///< marks for which the floor has been seen to
};

class FixedPoint {
 public:
  FixedPoint(std::vector<Base> base, Points point, ReferenceLevel0 level0, double shape_floor)
      : base_(std::move(base)),
        level0_(std::move(level0)),
        shape_floor_(shape_floor),
        n_old_(static_cast<GlobalId>(point.size())) {
    closing_.gone_back = point;
    closing_.point = std::move(point);
    for (const auto& b : base_)
      if (b.family != nullptr) closing_.middle.insert(b.family->middle.begin(), b.family->middle.end());
  }

  ReferenceClosing run() {
    for (std::size_t before = closing_.marked.size() + 1; before != closing_.marked.size();) {
      before = closing_.marked.size();
      for (auto& b : base_) apply_rules(b);
    }
    for (const auto& b : base_) make_children(b);
    return closing_;
  }

 private:
  void mark(const Piece& piece, int e) {
    const auto edge = piece.edge(e);
    if (closing_.middle.count(edge) != 0) return;
    if (edge.first >= n_old_ || edge.second >= n_old_)
      throw std::logic_error("close: a mark on an edge that is not yet");
    closing_.middle[edge] = static_cast<GlobalId>(closing_.point.size());
    closing_.point.push_back(level0_.middle(piece.row, edge, closing_.point));
    const auto& [a, b] = edge;
    closing_.gone_back.push_back(midpoint(closing_.gone_back[at(a)], closing_.gone_back[at(b)]));
    level0_.add_middle(edge);
    closing_.marked.insert(edge);
  }

  EdgeSet old_marks(const Base& b) const { return b.family == nullptr ? EdgeSet{} : b.family->pattern.marks; }

  void apply_rules(Base& b) {
    auto marks = edges_within(b.piece, closing_.middle);
    if (b.is_flagged || (b.family != nullptr && is_part_marked(*b.family))) marks = all_six;
    // cells that no mark has reached stay as they are, whatever their shape; closure cells without family have no floor
    const bool has_floor = b.family != nullptr || !b.piece.lineage.is_closure();
    if (has_floor && (marks != old_marks(b) || b.is_assessed) && marks != b.done)
      marks = b.done = b.floor.enlarge(marks);
    for (const int e : marks) mark(b.piece, e);
    if (marks == all_six && b.family != nullptr && is_part_marked(*b.family)) apply_rules_to_children(b);
  }

  /// What the marks of the children imply on edges that exist: halves of edges, and lines on faces, between old nodes.
  void apply_rules_to_children(const Base& b) {
    const auto children = split_in_eight(b.piece, closing_.middle, closing_.point, true);
    if (!positive_in_both(children)) return;
    for (const auto& child : children)
      for (const int e : added_to(child))
        if (exists(b.piece, child.edge(e))) mark(child, e);
  }

  bool positive_in_both(const std::vector<Piece>& children) const {
    return all_positive(children, closing_.point) && all_positive(children, closing_.gone_back);
  }

  /// Of a child of a parent; remembered by its corners in their order.
  ReferenceFloor& floor_of(const Piece& child) {
    const auto known = floor_of_child_.find(child.corner);
    if (known != floor_of_child_.end()) return known->second;
    const auto& point = closing_.point;
    const ReferenceFloor floor(points_of(child, point), shape_floor_, nullptr, level0_.middles(child, point));
    return floor_of_child_.emplace(child.corner, floor).first->second;
  }

  EdgeSet added_to(const Piece& child) {
    const auto marks = edges_within(child, closing_.middle);
    auto added = floor_of(child).enlarge(marks);
    for (const int e : marks) added.erase(e);
    return added;
  }

  /// An edge of a child of a parent that is one in the parent's closure, too.
  bool exists(const Piece& parent, const Edge& edge) const {
    if (edge.first >= n_old_ || edge.second >= n_old_) return false;
    bool lies_on_a_face = false;
    for (std::size_t face = 0; face < 4; ++face) {
      const auto nodes = nodes_on_face(parent, closing_.middle, face);
      lies_on_a_face = lies_on_a_face || (nodes.count(edge.first) != 0 && nodes.count(edge.second) != 0);
    }
    return lies_on_a_face;
  }

  /// A half of a split edge of the parent, or a line between two midpoints of a face.
  bool is_part_marked(const ReferenceFamily& family) const {
    const auto& marked = closing_.marked;
    for (const auto& [edge, m] : family.middle) {
      if (marked.count(edge_between(edge.first, m)) != 0 || marked.count(edge_between(edge.second, m)) != 0)
        return true;
      for (const auto& [other, n] : family.middle)
        if (m < n && marked.count(edge_between(m, n)) != 0) return true;
    }
    return false;
  }

  void make_children(const Base& b) {
    const auto marks = edges_within(b.piece, closing_.middle);
    const bool is_family = b.family != nullptr;
    if (is_family && marks == b.family->pattern.marks && !is_part_marked(*b.family)) {
      if (b.family->is_hit(closing_.marked)) throw std::logic_error("close: a mark inside a family that stays");
      return;
    }
    if (is_family) closing_.family[b.first] = *b.family;
    if (marks != all_six) {
      const bool has_moved = is_family && b.family->has_moved(closing_.point);
      const auto children = closed(b.piece, b.floor, has_moved);
      if (is_family && (children.empty() || !positive_in_both(children))) closing_.inverted.insert(b.first);
      closing_.children[b.first] = children;
    } else if (is_family) {
      closing_.children[b.first] = closed_eight(b);
    }
  }

  /// By its marks; nothing where no triangulation is positive.
  std::vector<Piece> closed(const Piece& piece, const ReferenceFloor& floor, bool has_moved) const {
    const auto marks = edges_within(piece, closing_.middle);
    const auto pattern = best_pattern(piece, closing_.middle, floor.cuts_of(marks), closing_.point,
                                      has_moved ? &closing_.gone_back : nullptr);
    if (!pattern && !has_moved) throw std::logic_error("close: cuts without triangulation");
    return pattern ? split_as(piece, closing_.middle, *pattern) : std::vector<Piece>{};
  }

  /// The eight children of a parent, closed in their turn; the parent is to be split early if that does not do.
  std::vector<Piece> closed_eight(const Base& b) {
    std::vector<Piece> pieces;
    const auto children = split_in_eight(b.piece, closing_.middle, closing_.point, true);
    if (!positive_in_both(children)) closing_.inverted.insert(b.first);
    for (const auto& child : children) {
      const auto marks = edges_within(child, closing_.middle);
      if (!added_to(child).empty()) closing_.early.insert(corners_of(b.piece));
      const auto parts = marks == all_six ? split_in_eight(child, closing_.middle, closing_.point, true)
                                          : closed(child, floor_of(child), false);
      pieces.insert(pieces.end(), parts.begin(), parts.end());
    }
    return pieces;
  }

  std::vector<Base> base_;
  ReferenceLevel0 level0_;  // with the new nodes
  double shape_floor_;
  GlobalId n_old_;
  ReferenceClosing closing_;
  std::map<std::array<GlobalId, 4>, ReferenceFloor> floor_of_child_;
};

/// Of the families in `kept` each member is a base cell of its own.
std::vector<Base> base_cells(const std::vector<Piece>& cell, const Points& point, const ReferenceLevel0& level0,
                             const std::map<GlobalId, ReferenceFamily>& families, const std::set<GlobalId>& kept,
                             const ReferenceRequest& request, double shape_floor) {
  std::vector<Base> base;
  for (std::size_t c = 0; c < cell.size(); ++c) {
    const auto id = static_cast<GlobalId>(c), first = id - cell[c].lineage.child();
    const bool is_member = cell[c].lineage.is_removable() && kept.count(first) == 0;
    const bool is_flagged = request.flags[c] != 0;
    if (is_member && id != first) {
      base.back().is_flagged = base.back().is_flagged || is_flagged;
      continue;
    }
    const auto* family = is_member ? &families.at(first) : nullptr;
    const auto& piece = is_member ? family->parent : cell[c];
    const bool is_assessed = is_member && request.assess.count(corners_of(piece)) != 0;
    const ReferenceFloor floor(points_of(piece, point), shape_floor, family, level0.middles(piece, point));
    base.push_back({id, piece, family, is_flagged, is_assessed, floor, {}});
  }
  return base;
}

}  // namespace

ReferenceClosing close_removable(const std::vector<Piece>& cell, const Points& point, const ReferenceLevel0& level0,
                                 const ReferenceRequest& request, double shape_floor) {
  const auto families = read_families(cell);
  auto kept = families_to_keep(cell, families);
  for (;;) {
    const auto base = base_cells(cell, point, level0, families, kept, request, shape_floor);
    auto closing = FixedPoint(base, point, level0, shape_floor).run();
    const auto n_kept = kept.size();
    kept.insert(closing.inverted.begin(), closing.inverted.end());
    if (kept.size() == n_kept) {
      for (const auto first : kept) closing.families_kept += families.at(first).is_hit(closing.marked) ? 1 : 0;
      return closing;
    }
    spread(families, kept);
  }
}

}  // namespace pamr::test
