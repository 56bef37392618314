// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/associate/patch_sample.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::meshing {

namespace {

using geometry::Vec3;
constexpr std::int64_t taken_whole = 600;  // faces

std::uint64_t hash_of(Vec3 p) {
  return pamr::combine(pamr::combine(pamr::combine(0, bits_of(p.x)), bits_of(p.y)), bits_of(p.z));
}

/// Nodes are taken whose hash is at most this.
std::uint64_t bound_of(std::int64_t n_faces) {
  constexpr auto all = std::numeric_limits<std::uint64_t>::max();
  return n_faces <= taken_whole ? all : all / static_cast<std::uint64_t>(n_faces) * taken_whole;
}

bool before(const PatchFace& a, const PatchFace& b) {
  if (a.patch != b.patch) return a.patch < b.patch;
  for (std::size_t k = 0; k < 3; ++k)
    if (a.corner[k] != b.corner[k]) return geometry::lexicographically_less(a.corner[k], b.corner[k]);
  return false;
}

/// A face as a corner sees it; its part of the normal there is that which makes normals of inscribed polyhedra of
/// spheres exact. Source: N. Max, "Weights for computing vertex normals from facet normals", J. Graphics Tools 4, 1999.
struct Corner {
  Vec3 point, normal;
};

PatchSample make_sample(std::span<const PatchFace> faces, std::uint64_t bound) {
  std::vector<Corner> corners;
  for (const auto& face : faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = face.corner[k], a = face.corner[(k + 1) % 3] - p, b = face.corner[(k + 2) % 3] - p;
      if (hash_of(p) <= bound) corners.push_back({p, (1 / (squared_norm(a) * squared_norm(b))) * cross(a, b)});
    }
  std::stable_sort(corners.begin(), corners.end(),
                   [](const auto& a, const auto& b) { return geometry::lexicographically_less(a.point, b.point); });
  PatchSample sample;
  sample.patch = faces.front().patch;
  for (std::size_t i = 0; i < corners.size();) {
    const Vec3 point = corners[i].point;
    Vec3 sum;
    for (; i < corners.size() && corners[i].point == point; ++i) sum += corners[i].normal;
    const double length = norm(sum);
    sample.point.push_back(point);
    sample.normal.push_back(length > 0 && std::isfinite(length) ? (1 / length) * sum : Vec3{});
  }
  return sample;
}

}  // namespace

std::vector<PatchFace> faces_of_patches(const mesh::DistMesh& mesh, const std::vector<bool>& is_wanted) {
  const mesh::InnerPatches patches(mesh);
  std::vector<PatchFace> faces;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const mesh::CellFace here{c, static_cast<int>(slot)};
      const int patch = patches.of_any(here);
      if (patch < 0 || !is_wanted[at(patch)] || !patches.is_first_side(here)) continue;
      PatchFace face{patch, {}};
      for (std::size_t k = 0; k < 3; ++k)
        face.corner[k] = mesh.point(mesh.cell_to_node[at(c)][at(mesh::tet::face_to_corner[slot][k])]);
      // the least corner first: the same bits however the cell has its corners
      std::rotate(face.corner.begin(),
                  std::min_element(face.corner.begin(), face.corner.end(), geometry::lexicographically_less),
                  face.corner.end());
      faces.push_back(face);
    }
  return faces;
}

std::vector<PatchSample> sample_patches(const par::Comm& comm, const std::vector<PatchFace>& faces,
                                        const std::vector<std::int64_t>& n_faces) {
  par::Mailbox<PatchFace> box(comm);
  for (const auto& face : faces) {
    const auto bound = bound_of(n_faces[at(face.patch)]);
    if (std::any_of(face.corner.begin(), face.corner.end(), [&](Vec3 p) { return hash_of(p) <= bound; }))
      box.add(face.patch % comm.size(), face);
  }
  auto mine = box.send().item;
  std::sort(mine.begin(), mine.end(), before);
  std::vector<PatchSample> samples;
  for (std::size_t i = 0; i < mine.size();) {
    std::size_t end = i;
    while (end < mine.size() && mine[end].patch == mine[i].patch) ++end;
    samples.push_back(make_sample(std::span(mine).subspan(i, end - i), bound_of(n_faces[at(mine[i].patch)])));
    i = end;
  }
  return samples;
}

}  // namespace pamr::meshing
