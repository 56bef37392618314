// SPDX-License-Identifier: GPL-3.0-or-later
#include <pamr/pamr.hpp>

int main(int argc, char** argv) {
  const pamr::par::Runtime mpi(argc, argv);
  const pamr::par::Comm comm(mpi.world());
  auto mesh = pamr::assemble::assemble(comm, pamr::io::read_native(comm, "cube.hdf"));
  std::vector<std::uint8_t> flags;  // one for each cell of this rank: 1 splits it
  for (pamr::LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto p = mesh.points(cell);
    flags.push_back(norm(0.25 * (p[0] + p[1] + p[2] + p[3])) < 0.5 ? 1 : 0);
  }
  // handed over, so that cells may move: the ranks get equal shares of the result, with few faces between them
  const auto result = pamr::adapt::refine(comm, std::move(mesh), flags);
  pamr::io::write_native(comm, "fine.hdf", result.mesh);
}
