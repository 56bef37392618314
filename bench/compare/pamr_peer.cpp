// SPDX-License-Identifier: GPL-3.0-or-later
// PAMR in the harness of the other codes, so that both sides of a comparison do the same work on the same clock. The
// mesh that is refined is handed over. Command line and output: workload.py.
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include "bench/compare/workload.hpp"
#include "bench/workloads.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/heap.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/io/gmsh/read_gmsh.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/par/runtime.hpp"

#ifndef PAMR_PEER_NAME
#define PAMR_PEER_NAME "PAMR"
#endif

namespace {

using namespace pamr;

class Pamr {
 public:
  explicit Pamr(const std::string& mesh_name) : comm_(MPI_COMM_WORLD), mesh_(start(comm_, mesh_name)) {}

  std::string name() const { return PAMR_PEER_NAME; }
  std::size_t n_cells() const { return at(mesh_.n_cells()); }

  template <class Visit>
  void corners(Visit&& visit) const {
    for (LocalId c = 0; c < mesh_.n_cells(); ++c) {
      peer::Corners corners{};
      const auto p = mesh_.points(c);
      for (std::size_t i = 0; i < 4; ++i) corners[i] = {p[i].x, p[i].y, p[i].z};
      visit(corners);
    }
  }

  void mark(const std::vector<std::int8_t>& flags) {
    flags_ = flags.empty() ? std::vector<std::int8_t>(n_cells(), 1) : flags;
  }

  void refine() {
    adapt::Options options;
    options.refinement.parent_field = false;
    mesh_ = adapt::adapt(comm_, std::move(mesh_), flags_, options).mesh;
  }
  bool mark_more() { return false; }
  static int coarsening_calls() { return 1; }
  bool relate() { return false; }

 private:
  static mesh::DistMesh start(const par::Comm& comm, const std::string& name) {
    if (name.starts_with("kuhn:")) return bench::cube(comm, std::stoi(name.substr(5)));
    if (name.ends_with(".msh")) return io::read_gmsh(comm, name).mesh;
    return assemble::assemble(comm, io::read_native(comm, name));
  }

  par::Comm comm_;
  mesh::DistMesh mesh_;
  std::vector<std::int8_t> flags_;
};

/// Reading a Gmsh file, as read_peer.py does with the other codes; on any number of ranks, whose seconds and bytes are
/// added.
void read(const std::string& file) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto before = bench::resident_bytes();
  bench::reset_peak();
  comm.barrier();
  const double cpu = cpu_seconds(), wall = wall_seconds();
  const auto cells = io::read_gmsh(comm, file).mesh.info.n_global_cells;
  const double elapsed = comm.max(wall_seconds() - wall);
  const auto nanoseconds = comm.sum(static_cast<std::int64_t>(1e9 * (cpu_seconds() - cpu)));
  const auto peak = comm.sum(static_cast<std::int64_t>(bench::peak_bytes() - before));
  if (comm.is_first())
    std::printf("{\"peer\": \"%s\", \"cells\": %ld, \"cpu\": %.6f, \"wall\": %.6f, \"peak\": %ld}\n", PAMR_PEER_NAME,
                static_cast<long>(cells), 1e-9 * static_cast<double>(nanoseconds), elapsed, static_cast<long>(peak));
}

}  // namespace

int main(int argc, char** argv) {
  set_up_heap();
  const par::Runtime runtime(argc, argv);
  if (argc == 3 && std::string(argv[1]) == "read") {
    read(argv[2]);
    return 0;
  }
  return peer::main_of<Pamr>(argc, argv);
}
