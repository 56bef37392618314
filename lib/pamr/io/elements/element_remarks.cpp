// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/element_remarks.hpp"

#include <fmt/format.h>

#include "pamr/mesh/periodic_patches.hpp"

namespace pamr::io {

std::vector<std::string> remarks_of(const ElementMesh& read) {
  std::vector<std::string> remarks;
  for (const auto& overlap : read.overlaps)
    remarks.push_back(fmt::format(
        "{} {} are in the group '{}' and in '{}': they stay in '{}', which has the smaller number", overlap.n_elements,
        overlap.dimension == 2 ? "triangles" : "tetrahedra", overlap.kept, overlap.other, overlap.kept));
  for (const auto& [group, n] : read.inner_faces)
    remarks.push_back(
        fmt::format("{} triangles of '{}' lie between two regions and are no patch: the field 'region' has what lies "
                    "on either side, new nodes stay on these triangles, and pamr-convert --interfaces writes them to a "
                    ".msh or .mesh",
                    n, group));
  if (read.n_turned > 0) remarks.push_back(fmt::format("{} inverted cells were turned over", read.n_turned));
  if (read.n_dropped_nodes > 0)
    remarks.push_back(fmt::format("{} nodes of no cell were left out", read.n_dropped_nodes));
  if (read.n_untagged_faces > 0)
    remarks.push_back(fmt::format("{} boundary faces without tag are in the patch 'boundary'", read.n_untagged_faces));
  if (auto warning = mesh::warning_of_periodic(read.mesh.info.patches); !warning.empty())
    remarks.push_back(std::move(warning));
  return remarks;
}

}  // namespace pamr::io
