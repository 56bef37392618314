// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/inner_faces.hpp"

#include <algorithm>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/inner_patches.hpp"

namespace pamr::refine {

namespace {

/// Calls `visit(face, child, slot)` for each part of each face of a parent.
template <class Visit>
void for_each_part(const SplitPattern& pattern, Visit&& visit) {
  for (int face = 0; face < 4; ++face)
    for (int place = 0; place < n_places; ++place)
      if (const int child = pattern.face_to_child[at(face)][at(place)]; child >= 0)
        visit(face, child, static_cast<int>(pattern.face_to_slot[at(face)][at(place)]));
}

/// The patches of a family's parent, from those of its members.
std::int64_t patches_of_parent(const std::vector<std::int64_t>& word, const mesh::DistMesh& mesh, LocalId first) {
  std::int64_t parent = 0;
  for_each_part(split_pattern[at(mesh.lineage[at(first)].state())], [&](int face, int child, int slot) {
    if (const int patch = mesh::inner_patch(word[at(first + child)], slot); patch >= 0)
      parent = mesh::with_inner_patch(parent, face, patch);
  });
  return parent;
}

}  // namespace

std::array<std::int64_t, max_children> inner_patches_of_children(std::int64_t parent, const SplitPattern& pattern) {
  std::array<std::int64_t, max_children> child_word{};
  if (parent == 0) return child_word;
  for_each_part(pattern, [&](int face, int child, int slot) {
    if (const int patch = mesh::inner_patch(parent, face); patch >= 0)
      child_word[at(child)] = mesh::with_inner_patch(child_word[at(child)], slot, patch);
  });
  return child_word;
}

std::optional<mesh::CellField> inner_patches_of_children(const NumberedMesh& old, const Children& children) {
  const auto& [mesh, closure, numbering] = old;
  const auto* field = mesh.find_cell_field(mesh::inner_patch_field);
  if (field == nullptr) return {};
  const auto& word = field->integer();
  std::vector<std::int64_t> of_children;
  assign_array(of_children, children.cell_to_node.size(), std::int64_t{0});
  const auto put = [&of_children](std::int64_t parent, const SplitPattern& pattern, LocalId first) {
    if (parent == 0) return;  // most cells
    const auto words = inner_patches_of_children(parent, pattern);
    std::copy_n(words.begin(), pattern.n_children, of_children.begin() + first);
  };
  auto family = closure.rebuilt.begin();
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    auto first = numbering.first_child[at(c)];
    if (closure.action[at(c)] == Action::split) put(word[at(c)], split_pattern[children.state[at(c)]], first);
    if (closure.action[at(c)] != Action::rebuild) continue;
    const auto& pattern = split_pattern[family->state];
    const auto words = inner_patches_of_children(patches_of_parent(word, mesh, c), pattern);
    for (int child = 0; child < pattern.n_children; ++child) {
      const auto& of_child = split_pattern[family->child_state[at(child)]];
      put(words[at(child)], of_child, first);
      first += of_child.n_children;
    }
    ++family;
  }
  return mesh::CellField{field->name, "", 1, mesh::StorageType::int64, std::move(of_children)};
}

}  // namespace pamr::refine
