// SPDX-License-Identifier: GPL-3.0-or-later
/// A fine region that moves through a mesh: cells on the surface of a ball are refined, cells that it has left are
/// coarsened.
///
///     mpirun -n 2 follow_ball OUT_FOLDER
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <pamr/pamr.hpp>
#include <string>
#include <utility>
#include <vector>

namespace {

constexpr int max_level = 3;

/// Whether the sphere comes as near to the middle of the cell as one of its corners.
bool is_near(const std::array<pamr::geometry::Vec3, 4>& p, const pamr::geometry::Vec3& center, double radius) {
  const auto middle = 0.25 * (p[0] + p[1] + p[2] + p[3]);
  double reach = 0;
  for (const auto& corner : p) reach = std::max(reach, norm(corner - middle));
  return std::abs(norm(middle - center) - radius) < 0.6 * reach;
}

/// 1: split, 0: keep, -1: may be coarsened; one for each cell of this rank.
std::vector<std::int8_t> flags_of(const pamr::mesh::DistMesh& mesh, const pamr::geometry::Vec3& center) {
  std::vector<std::int8_t> flags;
  for (pamr::LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const bool wanted = is_near(mesh.points(cell), center, 0.25);
    const bool may_be_split = mesh.lineage[std::size_t(cell)].level() < max_level;
    flags.push_back(wanted ? (may_be_split ? 1 : 0) : -1);
  }
  return flags;
}

}  // namespace

int main(int argc, char** argv) {
  const pamr::par::Runtime mpi(argc, argv);
  const pamr::par::Comm comm(mpi.world());
  const std::string folder = argc > 1 ? argv[1] : ".";
  auto mesh = pamr::assemble::assemble(comm, pamr::assemble::kuhn_cube(comm, 6));
  for (int step = 0; step <= 12; ++step) {
    const double t = 0.25 + 0.5 * step / 12;
    const auto flags = flags_of(mesh, {t, t, 0.5});
    auto result = pamr::adapt::adapt(comm, std::move(mesh), flags);
    mesh = std::move(result.mesh);
    if (comm.is_first())
      std::printf("step %2d: %lld cells, %lld octets coarsened\n", step,
                  static_cast<long long>(result.report.cells_out),
                  static_cast<long long>(result.coarsening.octets_gone));
    if (step == 4 || step == 12) pamr::io::write_native(comm, folder + "/step" + std::to_string(step) + ".hdf", mesh);
  }
}
