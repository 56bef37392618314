// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/interfaces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pamr/base/index.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/par/gather_few.hpp"

namespace pamr::io {

namespace {

using Pair = std::array<std::int64_t, 2>;

/// A name for the faces between two regions that nothing else has.
std::string interface_name(const mesh::MeshInfo& info, const Pair& pair, const std::vector<std::string>& taken) {
  std::string name;
  for (const auto number : pair) {
    const auto region = mesh::name_of_region(info, number);
    name += (name.empty() ? "" : "_") + (region.empty() ? fmt::format("region_{}", number) : region);
  }
  auto free_name = name;
  for (int i = 2; std::find(taken.begin(), taken.end(), free_name) != taken.end(); ++i)
    free_name = fmt::format("{}_{}", name, i);
  return free_name;
}

/// All pairs of regions that have a face in common, ascending. Collective.
std::vector<Pair> neighboring_regions(const par::Comm& comm, const std::vector<mesh::RegionFace>& faces) {
  std::set<Pair> here;
  for (const auto& face : faces) here.insert(face.region);
  return par::gather_distinct(comm, here);
}

}  // namespace

TriangleGroups group_triangles(const par::Comm& comm, const mesh::DistMesh& mesh, Interfaces interfaces) {
  TriangleGroups groups;
  for (const auto& patch : mesh.info.patches) {
    groups.name.push_back(patch.name);
    groups.number.push_back(patch.number);
  }
  groups.of_face.resize(mesh.cell_to_cell.size());
  for (std::size_t c = 0; c < groups.of_face.size(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const auto neighbor = mesh.cell_to_cell[c][slot];
      groups.of_face[c][slot] = neighbor < 0 ? mesh::slot_to_patch(neighbor) : -1;
    }
  if (interfaces == Interfaces::none) return groups;
  const mesh::InnerPatches inner(mesh);
  inner.for_each([&](mesh::CellFace face, int patch) {
    if (inner.is_first_side(face)) groups.of_face[at(face.cell)][at(face.slot)] = patch;
  });
  if (interfaces == Interfaces::patches) return groups;
  auto faces = mesh::faces_between_regions(comm, mesh);
  std::erase_if(faces, [&inner](const mesh::RegionFace& one) { return inner.of(one.face) >= 0; });
  const auto pairs = neighboring_regions(comm, faces);
  for (const auto& pair : pairs) groups.name.push_back(interface_name(mesh.info, pair, groups.name));
  for (const auto& [face, region] : faces) {
    const auto pair = std::lower_bound(pairs.begin(), pairs.end(), region) - pairs.begin();
    groups.of_face[at(face.cell)][at(face.slot)] = static_cast<std::int32_t>(mesh.info.patches.size() + at(pair));
  }
  return groups;
}

}  // namespace pamr::io
