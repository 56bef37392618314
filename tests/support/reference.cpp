// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference.hpp"

#include <algorithm>
#include <bit>
#include <string>

#include "pamr/geometry/vec3.hpp"

namespace pamr::test {

namespace {

using Cells = std::vector<std::array<GlobalId, 4>>;

std::array<GlobalId, 3> face_nodes(const std::array<GlobalId, 4>& cell, std::size_t slot) {
  std::array<GlobalId, 3> face{};
  for (std::size_t i = 0, k = 0; i < 4; ++i)
    if (i != slot) face[k++] = cell[i];
  std::sort(face.begin(), face.end());
  return face;
}

geometry::Vec3 point(const mesh::BlockMesh& whole, GlobalId node) {
  return whole.node_position[static_cast<std::size_t>(node)];
}

std::uint64_t scramble(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

std::uint64_t chain(const std::vector<std::uint64_t>& words) {
  std::uint64_t h = words[0];
  for (std::size_t i = 1; i < words.size(); ++i) h = scramble(h ^ scramble(words[i]));
  return h;
}

std::uint64_t bits(double x) { return x == 0 ? 0 : std::bit_cast<std::uint64_t>(x); }

}  // namespace

Cells reference_neighbors(const Cells& cell_to_node) {
  std::map<std::array<GlobalId, 3>, std::vector<GlobalId>> face_to_cell;
  for (std::size_t c = 0; c < cell_to_node.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f)
      face_to_cell[face_nodes(cell_to_node[c], f)].push_back(static_cast<GlobalId>(c));
  Cells neighbors(cell_to_node.size());
  for (std::size_t c = 0; c < cell_to_node.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto& cells = face_to_cell.at(face_nodes(cell_to_node[c], f));
      neighbors[c][f] = cells.size() == 1 ? -1 : cells[0] == static_cast<GlobalId>(c) ? cells[1] : cells[0];
    }
  return neighbors;
}

std::map<std::array<GlobalId, 2>, std::set<GlobalId>> reference_edge_to_cell(const Cells& cell_to_node) {
  std::map<std::array<GlobalId, 2>, std::set<GlobalId>> edge_to_cell;
  for (std::size_t c = 0; c < cell_to_node.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const auto [a, b] = std::minmax(cell_to_node[c][i], cell_to_node[c][j]);
        edge_to_cell[{a, b}].insert(static_cast<GlobalId>(c));
      }
  return edge_to_cell;
}

double reference_volume(const mesh::BlockMesh& whole) {
  double six_times = 0;
  for (const auto& n : whole.cell_to_node) {
    const auto a = point(whole, n[0]);
    six_times += dot(cross(point(whole, n[1]) - a, point(whole, n[2]) - a), point(whole, n[3]) - a);
  }
  return six_times / 6;
}

std::vector<double> reference_patch_areas(const mesh::BlockMesh& whole) {
  std::vector<double> area(whole.info.patches.size(), 0);
  for (std::size_t c = 0; c < whole.cell_to_node.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto neighbor = whole.cell_to_cell[c][f];
      if (neighbor >= 0) continue;
      const auto face = face_nodes(whole.cell_to_node[c], f);
      const auto a = point(whole, face[0]);
      area[static_cast<std::size_t>(-neighbor - 1)] +=
          0.5 * norm(cross(point(whole, face[1]) - a, point(whole, face[2]) - a));
    }
  return area;
}

std::uint64_t reference_fingerprint(const mesh::BlockMesh& whole) {
  std::vector<std::uint64_t> patch_hash;
  for (const auto& patch : whole.info.patches) {
    std::vector<std::uint64_t> words{0};
    for (const char letter : patch.name) words.push_back(static_cast<unsigned char>(letter));
    patch_hash.push_back(chain(words));
  }
  std::uint64_t total = 0;
  for (std::size_t c = 0; c < whole.cell_to_node.size(); ++c) {
    std::uint64_t corners = 0, boundary = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto p = point(whole, whole.cell_to_node[c][i]);
      const auto h = chain({0, bits(p.x), bits(p.y), bits(p.z)});
      corners += h;
      const auto neighbor = whole.cell_to_cell[c][i];
      if (neighbor < 0) boundary += chain({h, patch_hash[static_cast<std::size_t>(-neighbor - 1)]});
    }
    const auto lineage = whole.lineage.empty() ? mesh::Lineage{} : whole.lineage[c];
    const auto state = static_cast<std::uint64_t>(lineage.kind()) + (lineage.is_broken() ? 4U : 0U) +
                       8U * static_cast<std::uint64_t>(lineage.level());
    total += chain({0, corners, boundary, state});
  }
  return total;
}

}  // namespace pamr::test
