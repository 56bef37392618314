// SPDX-License-Identifier: GPL-3.0-or-later
/// PAMR in a solver of your own: a mesh from arrays with tagged boundary triangles, three turns of "solve, mark,
/// refine", data of the solver carried along, a point found again, and a file at the end.
///
///     cmake -S PREFIX/share/pamr/examples -B build -DCMAKE_PREFIX_PATH=PREFIX && cmake --build build
///     mpirun -n 2 build/refine_loop loop.hdf
///     ctest --test-dir build    # whether the installed PAMR works
///
/// Try: another number of ranks (loop.hdf keeps its bytes), other marks, `surfaces` for the patch `wall`.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <pamr/pamr.hpp>

namespace {

using pamr::GlobalId;
using pamr::LocalId;

/// The unit cube as 6 n^3 cells. Each rank makes its share, as your mesh generator or your solver would: a run of the
/// cells with global node numbers, the canonical block of the nodes, and any triangles of the boundary.
pamr::mesh::BlockMesh make_cube(const pamr::par::Comm& comm, GlobalId n) {
  pamr::mesh::BlockMesh block;
  block.info.n_global_nodes = (n + 1) * (n + 1) * (n + 1);
  block.info.n_global_cells = 6 * n * n * n;
  block.info.length_unit = "m";
  block.info.patches = {{"wall", "wall"}, {"inlet", "patch"}};
  const auto node = [n](std::array<GlobalId, 3> p) { return p[0] + (n + 1) * (p[1] + (n + 1) * p[2]); };

  const auto cells = pamr::par::block_range(block.info.n_global_cells, comm.rank(), comm.size());
  block.first_cell = cells.begin;
  constexpr std::array<std::array<std::size_t, 3>, 6> paths{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}}};
  for (auto id = cells.begin; id < cells.end; ++id) {
    const auto cube = id / 6;
    std::array<GlobalId, 3> p{cube % n, cube / n % n, cube / (n * n)};
    std::array<GlobalId, 4> corner{node(p)};
    for (std::size_t step = 0; step < 3; ++step) {
      ++p[paths[std::size_t(id % 6)][step]];
      corner[step + 1] = node(p);
    }
    if (id % 6 >= 3) std::swap(corner[1], corner[2]);  // (p1 - p0) x (p2 - p0) . (p3 - p0) > 0
    block.cell_to_node.push_back(corner);
  }
  const auto nodes = pamr::par::block_range(block.info.n_global_nodes, comm.rank(), comm.size());
  const auto coordinate = [n](GlobalId i) { return double(i) / double(n); };
  for (auto id = nodes.begin; id < nodes.end; ++id)
    block.node_position.push_back(
        {coordinate(id % (n + 1)), coordinate(id / (n + 1) % (n + 1)), coordinate(id / ((n + 1) * (n + 1)))});

  if (comm.is_first())  // the side x = 0 is the inlet; faces without triangle would form the patch `boundary`
    for (GlobalId j = 0; j < n; ++j)
      for (GlobalId k = 0; k < n; ++k) {
        const auto a = node({0, j, k}), b = node({0, j + 1, k}), c = node({0, j + 1, k + 1}), d = node({0, j, k + 1});
        block.boundary.node.push_back({a, b, c});
        block.boundary.node.push_back({a, c, d});
        block.boundary.patch.insert(block.boundary.patch.end(), {1, 1});
      }
  return block;
}

double temperature(pamr::geometry::Vec3 p) { return std::tanh(20 * (norm(p) - 0.7)); }

/// "Solves": here a known function, on the nodes of this rank.
void solve(pamr::mesh::DistMesh& mesh) {
  pamr::mesh::NodeField field{"T", "K", 1, pamr::mesh::StorageType::float64, {}};
  for (const auto p : mesh.node_position) field.real().push_back(temperature(p));
  mesh.node_fields = {field};
}

}  // namespace

int main(int argc, char** argv) {
  const pamr::par::Runtime mpi(argc, argv);  // not where MPI is running already:
  const pamr::par::Comm comm(mpi.world());   // a Comm from any communicator is enough
  auto mesh = pamr::assemble::assemble(comm, make_cube(comm, 6));

  /// What the solver knows of each cell and is no field: here where its base cell came from.
  pamr::adapt::CellRows<GlobalId> history;
  for (const auto id : mesh.cell_global) {
    history.value.push_back(id);
    history.offset.push_back(history.value.size());
  }

  for (int turn = 0; turn < 3; ++turn) {
    solve(mesh);
    const auto error = pamr::mark::recovered_error(comm, mesh, "T");
    const auto flags = pamr::mark::marks_of(pamr::mark::bulk_of_error(comm, mesh, error, 0.5));

    const auto cells_before = mesh.info.cell_ids();
    const auto held = mesh.cell_global;
    auto result = pamr::adapt::refine(comm, std::move(mesh), flags);
    mesh = std::move(result.mesh);

    history = pamr::adapt::data_of_parents<GlobalId>(comm, cells_before, held, history, mesh);
    if (comm.is_first())
      std::printf("%lld -> %lld cells\n", static_cast<long long>(result.report.cells_in),
                  static_cast<long long>(result.report.cells_out));
  }

  const pamr::locate::Locator locator(mesh);
  const std::array<pamr::geometry::Vec3, 1> probe{{{0.7, 0.1, 0.05}}};
  const auto found = pamr::locate::locate_points(comm, mesh, locator, probe);
  if (found.rank[0] == comm.rank()) std::printf("the probe is in cell %lld\n", static_cast<long long>(found.cell[0]));

  pamr::io::write_native(comm, argc > 1 ? argv[1] : "loop.hdf", mesh);
}
