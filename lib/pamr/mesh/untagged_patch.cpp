// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/untagged_patch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace pamr::mesh {

std::size_t find_untagged(const std::vector<Patch>& patches) {
  return static_cast<std::size_t>(std::find_if(patches.begin(), patches.end(), is_untagged) - patches.begin());
}

std::int64_t count_faces_of(const par::Comm& comm, const DistMesh& mesh, int patch) {
  const auto slot = patch_to_slot(patch);
  std::int64_t n = 0;
  for (const auto& neighbors : mesh.cell_to_cell) n += std::count(neighbors.begin(), neighbors.end(), slot);
  return comm.sum(n);
}

std::int64_t count_untagged_faces(const par::Comm& comm, const DistMesh& mesh) {
  return count_faces_of(comm, mesh, static_cast<int>(find_untagged(mesh.info.patches)));
}

Patch untagged_patch(const std::vector<Patch>& others) {
  const std::string usual = "boundary";
  auto name = usual;
  const auto is_taken = [&] {
    return std::any_of(others.begin(), others.end(), [&](const Patch& patch) { return patch.name == name; });
  };
  for (int i = 2; is_taken(); ++i) name = fmt::format("{}_{}", usual, i);
  return {.name = name, .kind = untagged_kind};
}

}  // namespace pamr::mesh
