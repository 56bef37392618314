// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_family.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace pamr::test {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// Parts of cut faces: triangles of members on a face of the parent of which one or two edges are split.
std::set<std::set<GlobalId>> parts_of_cut_faces(const ReferenceFamily& family) {
  std::set<std::set<GlobalId>> parts;
  for (std::size_t face = 0; face < 4; ++face) {
    const auto on_face = nodes_on_face(family.parent, family.middle, face);
    if (on_face.size() != 4 && on_face.size() != 5) continue;
    for (const auto& member : family.member)
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const auto triangle = nodes_on_face(member, {}, slot);
        if (std::includes(on_face.begin(), on_face.end(), triangle.begin(), triangle.end())) parts.insert(triangle);
      }
  }
  return parts;
}

}  // namespace

bool ReferenceFamily::is_hit(const std::set<Edge>& marked) const {
  return std::any_of(member.begin(), member.end(), [&](const Piece& m) { return !edges_within(m, marked).empty(); });
}

bool ReferenceFamily::has_moved(const Points& point) const {
  return std::any_of(middle.begin(), middle.end(), [&](const auto& entry) {
    const auto& [edge, m] = entry;
    return !(point[at(m)] == geometry::midpoint(point[at(edge.first)], point[at(edge.second)]));
  });
}

ReferenceFamily read_family(GlobalId first, const std::vector<Piece>& member) {
  const auto& lineage = member.front().lineage;
  ReferenceFamily family{first, member, family_patterns()[at(lineage.state())], {}, {}};
  std::array<GlobalId, 10> node{};
  node.fill(invalid_global);
  for (std::size_t child = 0; child < member.size(); ++child)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      auto& known = node[at(family.pattern.child.at(child)[slot])];
      if (known == invalid_global) known = member[child].corner[slot];
      if (known != member[child].corner[slot] || member[child].lineage.child() != static_cast<int>(child))
        throw std::logic_error("read_family: these cells are no family");
    }
  std::copy(node.begin(), node.begin() + 4, family.parent.corner.begin());
  for (const int e : family.pattern.marks) family.middle[family.parent.edge(e)] = node[at(4 + e)];
  family.parent.lineage = lineage.base();
  family.parent.row = member.front().row;
  for (std::size_t face = 0; face < 4; ++face) {
    const auto on_face = nodes_on_face(family.parent, family.middle, face);
    for (const auto& m : member)
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const auto triangle = nodes_on_face(m, {}, slot);
        if (std::includes(on_face.begin(), on_face.end(), triangle.begin(), triangle.end()))
          family.parent.patch[face] = m.patch[slot];
      }
  }
  return family;
}

std::map<GlobalId, ReferenceFamily> read_families(const std::vector<Piece>& cell) {
  std::map<GlobalId, ReferenceFamily> families;
  for (std::size_t c = 0; c < cell.size(); ++c)
    if (cell[c].lineage.is_removable() && cell[c].lineage.child() == 0) {
      const auto begin = cell.begin() + static_cast<std::ptrdiff_t>(c);
      families[static_cast<GlobalId>(c)] =
          read_family(static_cast<GlobalId>(c), {begin, begin + cell[c].lineage.family_size()});
    }
  return families;
}

std::vector<Piece> pieces_of(const mesh::BlockMesh& whole) {
  std::vector<Piece> pieces(whole.cell_to_node.size());
  for (std::size_t c = 0; c < pieces.size(); ++c) {
    pieces[c].corner = whole.cell_to_node[c];
    if (!whole.lineage.empty()) pieces[c].lineage = whole.lineage[c];
    for (std::size_t f = 0; f < 4; ++f) {
      const auto neighbor = whole.cell_to_cell[c][f];
      if (neighbor < 0) pieces[c].patch[f] = static_cast<int>(-neighbor - 1);
    }
  }
  return pieces;
}

std::vector<CornerSet> base_cells_of(const std::vector<Piece>& cell) {
  const auto families = read_families(cell);
  std::vector<CornerSet> base;
  for (std::size_t c = 0; c < cell.size(); ++c) {
    const auto family = families.find(static_cast<GlobalId>(c) - cell[c].lineage.child());
    const bool is_member = cell[c].lineage.is_removable() && family != families.end();
    base.push_back(corners_of(is_member ? family->second.parent : cell[c]));
  }
  return base;
}

std::set<GlobalId> families_to_keep(const std::vector<Piece>& cell,
                                    const std::map<GlobalId, ReferenceFamily>& families) {
  std::map<std::set<GlobalId>, int> n_cells, n_families;
  for (const auto& piece : cell)
    for (std::size_t slot = 0; slot < 4; ++slot) ++n_cells[nodes_on_face(piece, {}, slot)];
  for (const auto& [first, family] : families)
    for (const auto& part : parts_of_cut_faces(family)) ++n_families[part];
  std::set<GlobalId> kept;
  for (const auto& [first, family] : families)
    for (const auto& part : parts_of_cut_faces(family))
      if (n_cells.at(part) != n_families.at(part)) kept.insert(first);
  spread(families, kept);
  return kept;
}

void spread(const std::map<GlobalId, ReferenceFamily>& families, std::set<GlobalId>& kept) {
  for (std::size_t before = 0; before != kept.size();) {
    before = kept.size();
    std::set<std::set<GlobalId>> parts;
    for (const auto first : kept) parts.merge(parts_of_cut_faces(families.at(first)));
    for (const auto& [first, family] : families)
      for (const auto& part : parts_of_cut_faces(family))
        if (parts.count(part) != 0) kept.insert(first);
  }
}

}  // namespace pamr::test
