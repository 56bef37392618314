// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_close.hpp"

#include <algorithm>
#include <stdexcept>

namespace pamr::test {

namespace {

using mesh::tet::edge_to_corner;
using refine::QualityControl;

constexpr double rounding = 1 + 0x1p-40;
constexpr double worst_closure = 0.3;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// The smallest legal set that holds the given edges: two on a face become three, anything else six.
std::set<int> make_legal(const std::set<int>& edges) {
  if (edges.size() <= 1) return edges;
  for (int face = 0; face < 4; ++face) {
    const auto whole = edges_of_face(face);
    if (std::includes(whole.begin(), whole.end(), edges.begin(), edges.end())) return whole;
  }
  return all_six;
}

/// Closing one of the edges, or the face, would make a poor cell, and 1:8 would not make one as poor.
bool closes_badly(const geometry::TetPoints& corner, const std::set<int>& legal) {
  double worst = legal.size() == 3 ? worst_child_if_halved(corner, legal) : 1;
  for (const int e : legal) worst = std::min(worst, worst_child_if_halved(corner, {e}));
  return worst < worst_closure && worst_child_if_halved(corner, all_six) > worst;
}

/// Half of an edge of the parent: joins the corner that the child keeps with the middle of an edge there.
bool is_short(mesh::Lineage lineage, int edge) {
  if (lineage.kind() == mesh::FamilyKind::edge) return edge == lineage.index();
  if (lineage.child() == 3) return false;
  int kept = lineage.child();
  if (kept >= lineage.index()) ++kept;  // corners of the face in ascending order
  const auto [a, b] = edge_to_corner[at(edge)];
  return (a == kept || b == kept) && a != lineage.index() && b != lineage.index();
}

/// Of the two faces at an edge the one whose four children have the larger smallest mean ratio; among equals the one
/// whose third corner comes first.
std::set<int> better_face(const geometry::TetPoints& corner, int edge) {
  const auto [p, q] = edge_to_corner[at(5 - edge)];
  const double p_worst = worst_child_if_halved(corner, edges_of_face(p));
  const double q_worst = worst_child_if_halved(corner, edges_of_face(q));
  const bool tied = p_worst <= q_worst * rounding && q_worst <= p_worst * rounding;
  // q is the third corner of the face opposite p
  const bool take_p = tied ? geometry::lexicographically_less(corner[at(q)], corner[at(p)]) : p_worst > q_worst;
  return edges_of_face(take_p ? p : q);
}

/// What is split by one pattern: a cell, or the parent of a family that may be taken back.
struct Base {
  Piece piece;
  const ReferenceFamily* family = nullptr;
};

class FixedPoint {
 public:
  FixedPoint(std::vector<Base> base, Points point, QualityControl policy)
      : base_(std::move(base)), policy_(policy), n_old_(static_cast<GlobalId>(point.size())), point_(std::move(point)) {
    for (const auto& b : base_)
      if (b.family != nullptr) middle_.insert(b.family->middle.begin(), b.family->middle.end());
  }

  void mark(const Edge& edge) {
    if (middle_.count(edge) != 0) return;
    if (edge.first >= n_old_ || edge.second >= n_old_)
      throw std::logic_error("close: a mark on an edge that is not yet");
    middle_[edge] = static_cast<GlobalId>(point_.size());
    point_.push_back(geometry::midpoint(point_[at(edge.first)], point_[at(edge.second)]));
    marked_.insert(edge);
  }
  void mark(const Piece& piece, const std::set<int>& edges) {
    for (const int e : edges) mark(piece.edge(e));
  }

  void run() {
    for (std::size_t before = marked_.size() + 1; before != marked_.size();) {
      before = marked_.size();
      for (std::size_t b = 0; b < base_.size(); ++b) apply_rules(b);
    }
  }

  const std::set<Edge>& marked() const { return marked_; }
  const Middles& middle() const { return middle_; }
  const Points& point() const { return point_; }

 private:
  void apply_rules(std::size_t b) {
    const auto& [piece, family] = base_[b];
    const bool part_is_marked = family != nullptr && is_part_marked(*family);
    mark(piece, part_is_marked ? all_six : required(b));
    if (family == nullptr || edges_within(piece, middle_) != all_six) return;
    // the children of a red parent are cells too
    for (const auto& child : split(piece, middle_, point_, true)) mark(child, make_legal(edges_within(child, marked_)));
  }

  std::set<int> required(std::size_t b) {
    const auto& [piece, family] = base_[b];
    auto edges = edges_within(piece, middle_);
    const bool is_new = edges != (family == nullptr ? std::set<int>{} : edges_within(piece, family->middle));
    if (!is_new || edges == all_six) return edges;
    const auto corner = points_of(piece, point_);
    if (piece.lineage.is_closure() && policy_ == QualityControl::isotropic) return all_six;
    if (piece.lineage.is_closure() && policy_ == QualityControl::short_edge)
      for (const int e : std::set<int>(edges))
        if (is_short(piece.lineage, e)) edges.merge(better_face(corner, e));
    edges = make_legal(edges);
    if (policy_ != QualityControl::removable || piece.lineage.is_closure()) return edges;
    auto known = is_bad_.find({b, edges});
    if (known == is_bad_.end()) known = is_bad_.emplace(std::pair{b, edges}, closes_badly(corner, edges)).first;
    return known->second ? all_six : edges;
  }

  /// A half of a split edge of the parent, or a side of the triangle inside its split face.
  bool is_part_marked(const ReferenceFamily& family) const {
    for (const auto& [edge, m] : family.middle) {
      if (marked_.count(edge_between(edge.first, m)) != 0 || marked_.count(edge_between(edge.second, m)) != 0)
        return true;
      for (const auto& [other, n] : family.middle)
        if (m < n && marked_.count(edge_between(m, n)) != 0) return true;
    }
    return false;
  }

  std::vector<Base> base_;
  QualityControl policy_;
  GlobalId n_old_;
  Points point_;
  Middles middle_;
  std::set<Edge> marked_;
  std::map<std::pair<std::size_t, std::set<int>>, bool> is_bad_;
};

/// Halves of faces: triangles of members, on a face of the parent of which one edge is split.
std::set<std::set<GlobalId>> half_faces(const ReferenceFamily& family) {
  std::set<std::set<GlobalId>> halves;
  for (std::size_t face = 0; face < 4; ++face) {
    const auto on_face = nodes_on_face(family.parent, family.middle, face);
    if (on_face.size() != 4) continue;
    for (const auto& member : family.member)
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const auto triangle = nodes_on_face(member, {}, slot);
        if (std::includes(on_face.begin(), on_face.end(), triangle.begin(), triangle.end())) halves.insert(triangle);
      }
  }
  return halves;
}

/// Families of which a half face is the face of a cell too that is no member of a whole family with that half face: it
/// needs the half, so the family cannot be taken back.
std::set<GlobalId> families_without_partners(const std::vector<Piece>& cell,
                                             const std::map<GlobalId, ReferenceFamily>& families) {
  std::map<std::set<GlobalId>, int> n_cells, n_families;
  for (const auto& piece : cell)
    for (std::size_t slot = 0; slot < 4; ++slot) ++n_cells[nodes_on_face(piece, {}, slot)];
  for (const auto& [first, family] : families)
    for (const auto& half : half_faces(family)) ++n_families[half];
  std::set<GlobalId> alone;
  for (const auto& [first, family] : families)
    for (const auto& half : half_faces(family))
      if (n_cells.at(half) != n_families.at(half)) alone.insert(first);
  return alone;
}

/// Adds the families that share a half face with one that is kept, until there are no more.
void spread(const std::map<GlobalId, ReferenceFamily>& families, std::set<GlobalId>& kept) {
  for (std::size_t before = 0; before != kept.size();) {
    before = kept.size();
    std::set<std::set<GlobalId>> halves;
    for (const auto first : kept) halves.merge(half_faces(families.at(first)));
    for (const auto& [first, family] : families)
      for (const auto& half : half_faces(family))
        if (halves.count(half) != 0) kept.insert(first);
  }
}

}  // namespace

bool ReferenceFamily::is_hit(const std::set<Edge>& marked) const {
  return std::any_of(member.begin(), member.end(), [&](const Piece& m) { return !edges_within(m, marked).empty(); });
}

ReferenceFamily read_family(GlobalId first, const std::vector<Piece>& member) {
  ReferenceFamily family{first, member, {}, {}};
  // a corner of the parent stands in one place only; a middle stands in the place of either end of its edge
  std::map<GlobalId, std::set<std::size_t>> places;
  for (const auto& m : member)
    for (std::size_t slot = 0; slot < 4; ++slot) places[m.corner[slot]].insert(slot);
  family.parent.corner.fill(invalid_global);
  for (const auto& [node, slots] : places)
    if (slots.size() == 1) family.parent.corner[*slots.begin()] = node;
  for (const auto& m : member) {
    const auto is_middle = [&](std::size_t slot) { return places[m.corner[slot]].size() > 1; };
    for (std::size_t slot = 0; slot < 4; ++slot)
      for (std::size_t other = 0; other < 4; ++other) {
        // seen from a member that keeps one end (not from the one on the triangle of the middles)
        const bool keeps_end = !is_middle(other) && places[m.corner[slot]].count(other) != 0;
        if (is_middle(slot) && keeps_end)
          family.middle[edge_between(m.corner[other], family.parent.corner[slot])] = m.corner[slot];
      }
  }
  const auto& lineage = member.front().lineage;
  family.parent.lineage = mesh::Lineage(mesh::FamilyKind::regular, 0, 0, lineage.level());
  for (std::size_t face = 0; face < 4; ++face) {
    const auto on_face = nodes_on_face(family.parent, family.middle, face);
    for (const auto& m : member)
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const auto triangle = nodes_on_face(m, {}, slot);
        if (std::includes(on_face.begin(), on_face.end(), triangle.begin(), triangle.end()))
          family.parent.patch[face] = m.patch[slot];
      }
  }
  if (family.middle.size() != (lineage.kind() == mesh::FamilyKind::edge ? 1 : 3))
    throw std::logic_error("read_family: these cells are no family");
  return family;
}

ReferenceClosing reference_close(const std::vector<Piece>& cell, const Points& point,
                                 const std::vector<std::uint8_t>& flags, QualityControl policy) {
  std::map<GlobalId, ReferenceFamily> families;
  if (policy == QualityControl::removable)
    for (std::size_t c = 0; c < cell.size(); ++c)
      if (cell[c].lineage.is_removable() && cell[c].lineage.child() == 0) {
        const auto begin = cell.begin() + static_cast<std::ptrdiff_t>(c);
        families[static_cast<GlobalId>(c)] =
            read_family(static_cast<GlobalId>(c), {begin, begin + cell[c].lineage.family_size()});
      }

  auto kept = families_without_partners(cell, families);
  spread(families, kept);
  for (;;) {
    std::vector<Base> base;
    std::vector<Piece> red;
    for (std::size_t c = 0; c < cell.size(); ++c) {
      const auto first = static_cast<GlobalId>(c) - cell[c].lineage.child();
      const bool is_member = cell[c].lineage.is_removable() && families.count(first) != 0 && kept.count(first) == 0;
      const auto* family = is_member ? &families.at(first) : nullptr;
      if (family == nullptr) base.push_back({cell[c], nullptr});
      if (family != nullptr && static_cast<GlobalId>(c) == first) base.push_back({family->parent, family});
      if (flags[c] != 0) red.push_back(is_member ? family->parent : cell[c]);
    }
    FixedPoint fixed_point(std::move(base), point, policy);
    for (const auto& piece : red) fixed_point.mark(piece, all_six);
    fixed_point.run();

    ReferenceClosing closing{fixed_point.marked(), fixed_point.middle(), fixed_point.point(), {}, {}, 0};
    const auto n_kept = kept.size();
    for (const auto& [first, family] : families) {
      if (!family.is_hit(closing.marked)) continue;
      if (kept.count(first) != 0) {
        ++closing.families_kept;
        continue;
      }
      closing.family[first] = family;
      closing.children[first] = split(family.parent, closing.middle, closing.point, true);
      if (!all_positive(closing.children[first], closing.point)) kept.insert(first);
    }
    if (kept.size() == n_kept) return closing;
    spread(families, kept);
  }
}

}  // namespace pamr::test
