// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/workloads.hpp"

#include <algorithm>
#include <cmath>

#include "bench/compare/memory.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::bench {

namespace {

constexpr geometry::Vec3 middle{0.5, 0.5, 0.5};

geometry::Vec3 centroid(const mesh::DistMesh& mesh, LocalId cell) {
  const auto p = mesh.points(cell);
  return 0.25 * (p[0] + p[1] + p[2] + p[3]);
}

}  // namespace

mesh::DistMesh cube(const par::Comm& comm, int n) { return assemble::assemble(comm, assemble::kuhn_cube(comm, n)); }

void tag_planes(mesh::DistMesh& mesh, int n) {
  const int patch = static_cast<int>(mesh.info.patches.size());
  mesh.info.patches.push_back({"planes", "patch", -1});
  auto& word = mesh::make_inner_patches(mesh);
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto points = mesh.points(c);
    for (int slot = 0; slot < 4; ++slot) {
      if (mesh.cell_to_cell[at(c)][at(slot)] < 0) continue;
      const auto& corner = mesh::tet::face_to_corner[at(slot)];
      const double z = points[at(corner[0])].z;
      const auto is_in_plane = [&](int k) { return points[at(k)].z == z; };
      if (std::all_of(corner.begin(), corner.end(), is_in_plane) && std::lround(z * n) % 5 < 3)
        word[at(c)] = mesh::with_inner_patch(word[at(c)], slot, patch);
    }
  }
}

std::vector<std::uint8_t> mark_shell(const mesh::DistMesh& mesh, double radius, double width) {
  std::vector<std::uint8_t> flags(static_cast<std::size_t>(mesh.n_cells()));
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    flags[static_cast<std::size_t>(c)] = std::abs(geometry::norm(centroid(mesh, c) - middle) - radius) < width ? 1 : 0;
  return flags;
}

std::vector<std::uint8_t> mark_crossing(const mesh::DistMesh& mesh, double radius) {
  return mark_crossing(mesh, middle, radius);
}

std::vector<std::uint8_t> mark_crossing(const mesh::DistMesh& mesh, geometry::Vec3 center, double radius) {
  std::vector<std::uint8_t> flags(static_cast<std::size_t>(mesh.n_cells()));
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    double least = 1e300, greatest = 0;
    for (const auto p : mesh.points(c)) {
      const double d = geometry::norm(p - center);
      least = std::min(least, d);
      greatest = std::max(greatest, d);
    }
    flags[static_cast<std::size_t>(c)] = least < radius && radius < greatest ? 1 : 0;
  }
  return flags;
}

std::vector<std::uint8_t> mark_box(const mesh::DistMesh& mesh, geometry::Vec3 low, geometry::Vec3 high) {
  std::vector<std::uint8_t> flags(static_cast<std::size_t>(mesh.n_cells()));
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto x = centroid(mesh, c);
    flags[static_cast<std::size_t>(c)] =
        low.x <= x.x && x.x <= high.x && low.y <= x.y && x.y <= high.y && low.z <= x.z && x.z <= high.z ? 1 : 0;
  }
  return flags;
}

std::size_t resident_bytes() { return static_cast<std::size_t>(peer::status_bytes("VmRSS:")); }
std::size_t peak_bytes() { return static_cast<std::size_t>(peer::status_bytes("VmHWM:")); }
void reset_peak() { peer::restart_peak(); }

}  // namespace pamr::bench
