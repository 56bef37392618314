// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/fingerprint.hpp"

#include <vector>

#include "pamr/base/hash.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/par/sum_modulo.hpp"

namespace pamr::mesh {

namespace {

std::uint64_t hash_of(geometry::Vec3 p) {
  return combine(combine(combine(0, bits_of(p.x)), bits_of(p.y)), bits_of(p.z));
}

std::uint64_t hash_of(const std::string& name) {
  std::uint64_t h = 0;
  for (const char byte : name) h = combine(h, static_cast<unsigned char>(byte));
  return h;
}

std::uint64_t state_of(Lineage lineage) {
  return static_cast<std::uint64_t>(lineage.kind()) + (lineage.is_broken() ? 4U : 0U) +
         8U * static_cast<std::uint64_t>(lineage.level());
}

}  // namespace

std::uint64_t fingerprint(const par::Comm& comm, const DistMesh& mesh) {
  std::vector<std::uint64_t> node_hash;
  node_hash.reserve(mesh.node_position.size());
  for (const auto p : mesh.node_position) node_hash.push_back(hash_of(p));
  std::vector<std::uint64_t> patch_hash;
  for (const auto& patch : mesh.info.patches) patch_hash.push_back(hash_of(patch.name));

  const InnerPatches patches(mesh);
  std::uint64_t sum = 0;
  for (std::size_t c = 0; c < mesh.cell_to_node.size(); ++c) {
    std::uint64_t corners = 0, boundary = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto corner = node_hash[static_cast<std::size_t>(mesh.cell_to_node[c][i])];
      corners += corner;
      const int patch = patches.of_any({static_cast<LocalId>(c), static_cast<int>(i)});
      if (patch >= 0) boundary += combine(corner, patch_hash[static_cast<std::size_t>(patch)]);
    }
    sum += combine(combine(combine(0, corners), boundary), state_of(mesh.lineage[c]));
  }
  return par::sum_modulo(comm, sum);
}

}  // namespace pamr::mesh
