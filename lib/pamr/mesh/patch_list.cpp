// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/patch_list.hpp"

#include <algorithm>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mesh {

void add_patch(PatchList& list, int patch) {
  if (patch < 0 || std::find(list.begin(), list.end(), patch) != list.end()) return;
  const auto free = std::find(list.begin(), list.end(), -1);
  if (free == list.end()) return;
  *free = patch;
  std::sort(list.begin(), free + 1);
}

void add_patches_of_nodes(const par::Comm& comm, const DistMesh& mesh, const Borders& borders,
                          std::map<LocalId, PatchList>& patches) {
  const InnerPatches inner(mesh);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const int patch = inner.of_any({c, f});
      if (patch < 0 || (mesh.cell_to_cell[at(c)][at(f)] >= 0 && mesh.info.patches[at(patch)].surface < 0)) continue;
      for (const auto corner : tet::face_to_corner[at(f)]) {
        const auto entry = patches.find(mesh.cell_to_node[at(c)][at(corner)]);
        if (entry != patches.end()) add_patch(entry->second, patch);
      }
    }
  par::fold_shared(
      par::Exchange(comm, borders.nodes),
      [&](LocalId node) {
        const auto entry = patches.find(node);
        return entry == patches.end() ? PatchList{-1, -1, -1, -1} : entry->second;
      },
      [&](LocalId node, const PatchList& theirs) {
        const auto entry = patches.find(node);
        if (entry == patches.end()) return;
        for (const auto patch : theirs) add_patch(entry->second, patch);
      });
}

}  // namespace pamr::mesh
