// SPDX-License-Identifier: GPL-3.0-or-later
// Cells and their shapes, level by level, under each of the four quality-control policies. Two workloads:
//   bench_quality_control cube N LEVELS               cells of the Kuhn cube K(N) cut by the sphere r = 0.35
//   bench_quality_control box MESH X0,Y0,Z0,X1,Y1,Z1 LEVELS   cells of a mesh file with their centroid in a box
// Prints one Markdown table. Run alone or under mpirun.
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>

#include "bench/workloads.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "pamr/par/runtime.hpp"

namespace {

using namespace pamr;

struct Shape {
  double worst = 1, mean = 0;
};

Shape measure(const par::Comm& comm, const mesh::DistMesh& mesh) {
  Shape shape;
  std::vector<double> ratios;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    ratios.push_back(geometry::mean_ratio(mesh.points(c)));
    shape.worst = std::min(shape.worst, ratios.back());
  }
  shape.worst = comm.min(shape.worst);
  shape.mean = par::reproducible_sum(comm, ratios) / static_cast<double>(mesh.info.n_global_cells);
  return shape;
}

struct Workload {
  bool is_cube = true;
  std::string file;
  int n = 0, levels = 0;
  geometry::Vec3 low, high;

  mesh::DistMesh start(const par::Comm& comm) const {
    return is_cube ? bench::cube(comm, n) : assemble::assemble(comm, io::read_native(comm, file));
  }
  std::vector<std::uint8_t> mark(const mesh::DistMesh& mesh) const {
    return is_cube ? bench::mark_crossing(mesh, 0.35) : bench::mark_box(mesh, low, high);
  }
};

Workload parse(int argc, char** argv) {
  Workload work;
  const std::string kind = argc > 1 ? argv[1] : "";
  if (kind == "cube" && argc == 4) {
    work.n = std::stoi(argv[2]);
    work.levels = std::stoi(argv[3]);
    return work;
  }
  if (kind != "box" || argc != 5)
    throw Error("usage: bench_quality_control cube N LEVELS | box MESH X0,Y0,Z0,X1,Y1,Z1 LEVELS");
  work.is_cube = false;
  work.file = argv[2];
  std::istringstream box(argv[3]);
  char comma = 0;
  box >> work.low.x >> comma >> work.low.y >> comma >> work.low.z >> comma >> work.high.x >> comma >> work.high.y >>
      comma >> work.high.z;
  work.levels = std::stoi(argv[4]);
  return work;
}

void run(const par::Comm& comm, const Workload& work) {
  if (comm.is_first())
    std::printf(
        "| policy | level | marked | cells | worst mean ratio | mean of mean ratio | rebuilt | kept | off |\n"
        "|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, policy] : refine::quality_control_names) {
    auto mesh = work.start(comm);
    adapt::Report report;
    report.cells_out = mesh.info.n_global_cells;
    for (int level = 0;; ++level) {
      const auto shape = measure(comm, mesh);
      if (comm.is_first())
        std::printf("| %s | %d | %ld | %ld | %.4f | %.4f | %ld | %ld | %ld |\n", name, level, report.closure.n_marked,
                    report.cells_out, shape.worst, shape.mean, report.closure.families_rebuilt,
                    report.closure.families_kept, report.certificate.n_off_surface);
      std::fflush(stdout);
      if (level == work.levels) break;
      auto result = adapt::refine(comm, mesh, work.mark(mesh), {.quality_control = policy, .marks_field = ""});
      mesh = std::move(result.mesh);
      report = result.report;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const par::Runtime runtime(argc, argv);
  try {
    const par::Comm comm(MPI_COMM_WORLD);
    run(comm, parse(argc, argv));
  } catch (const Error& error) {
    if (runtime.rank() == 0) std::cerr << error.what() << '\n';
    return 2;
  }
  return 0;
}
