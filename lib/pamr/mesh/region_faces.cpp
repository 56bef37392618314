// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/region_faces.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mesh {

const CellField* find_regions(const DistMesh& mesh) {
  const auto* field = mesh.find_cell_field(region_field);
  return field != nullptr && field->holds_integers() && field->n_components == 1 ? field : nullptr;
}

std::vector<RegionFace> faces_between_regions(const par::Comm& comm, const DistMesh& mesh) {
  const auto* field = find_regions(mesh);
  if (field == nullptr) return {};
  const auto& region = field->integer();
  const par::Pattern border{mesh.border_rank, mesh.border_offset, std::vector<LocalId>(mesh.border_face.size(), 0)};
  std::vector<std::int64_t> mine;
  for (const auto& face : mesh.border_face) mine.push_back(region[at(face.cell)]);
  const auto theirs = par::Exchange(comm, border).swap<std::int64_t>(mine);
  std::vector<RegionFace> faces;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      const auto neighbor = mesh.cell_to_cell[at(c)][at(slot)];
      if (neighbor < 0) continue;
      const auto other = mesh.is_own(neighbor) ? region[at(neighbor)] : theirs[at(neighbor - mesh.n_cells())];
      if (region[at(c)] < other) faces.push_back({{c, slot}, {region[at(c)], other}});
    }
  return faces;
}

std::string name_of_region(const MeshInfo& info, Exact<std::int64_t> number) {
  const auto found = std::find_if(info.regions.begin(), info.regions.end(),
                                  [&](const auto& region) { return region.number == number; });
  return found == info.regions.end() ? "" : found->name;
}

}  // namespace pamr::mesh
