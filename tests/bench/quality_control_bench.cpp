// SPDX-License-Identifier: GPL-3.0-or-later
// Cells and their shapes, level by level, under each of the four quality-control policies, or under `removable` with
// the shape floors given:
//   bench_quality_control MESH LAW LEVELS [FLOOR,...]
// MESH: kuhn:N, the Kuhn cube K(N), or a mesh file, PAMR's or (*.msh) Gmsh's. LAW: which cells are marked at every
// level: sphere:X,Y,Z,R those cut by a sphere, box:X0,Y0,Z0,X1,Y1,Z1 those with their centroid in a box. Prints one
// Markdown table; "0.1 %": one cell of a thousand is below. Run alone or under mpirun.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "bench/workloads.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/gmsh/read_gmsh.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "pamr/par/runtime.hpp"

namespace {

using namespace pamr;

struct Shape {
  double worst = 1, low = 1, mean = 0;
};

/// The value that stands in place n of the ascending ratios of all ranks: by bisection, since all are in (-1, 1].
double value_in_place(const par::Comm& comm, const std::vector<double>& ratios, GlobalId n) {
  double below = -1, above = 1;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (below + above);
    const auto count = std::count_if(ratios.begin(), ratios.end(), [middle](double r) { return r <= middle; });
    (comm.sum(static_cast<std::int64_t>(count)) <= n ? below : above) = middle;
  }
  return above;
}

Shape measure(const par::Comm& comm, const mesh::DistMesh& mesh) {
  Shape shape;
  std::vector<double> ratios;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    ratios.push_back(geometry::mean_ratio(mesh.points(c)));
    shape.worst = std::min(shape.worst, ratios.back());
  }
  shape.worst = comm.min(shape.worst);
  shape.low = value_in_place(comm, ratios, mesh.info.n_global_cells / 1000);
  shape.mean = par::reproducible_sum(comm, ratios) / static_cast<double>(mesh.info.n_global_cells);
  return shape;
}

std::vector<double> numbers_in(const std::string& list) {
  std::vector<double> numbers;
  std::istringstream rest(list);
  for (std::string number; std::getline(rest, number, ',');) numbers.push_back(std::stod(number));
  return numbers;
}

struct Workload {
  std::string mesh, law;
  std::vector<double> numbers;
  int levels = 0;
  std::vector<double> floors;

  mesh::DistMesh start(const par::Comm& comm) const {
    if (mesh.starts_with("kuhn:")) return bench::cube(comm, std::stoi(mesh.substr(5)));
    if (mesh.ends_with(".msh")) return io::read_gmsh(comm, mesh).mesh;
    return assemble::assemble(comm, io::read_native(comm, mesh));
  }
  std::vector<std::uint8_t> mark(const mesh::DistMesh& coarse) const {
    const auto& n = numbers;
    if (law == "sphere") return bench::mark_crossing(coarse, {n[0], n[1], n[2]}, n[3]);
    return bench::mark_box(coarse, {n[0], n[1], n[2]}, {n[3], n[4], n[5]});
  }
};

Workload parse(int argc, char** argv) {
  if (argc != 4 && argc != 5) throw Error("usage: bench_quality_control MESH LAW LEVELS [FLOOR,...]");
  Workload work;
  work.mesh = argv[1];
  const std::string law = argv[2];
  const auto colon = law.find(':');
  work.law = law.substr(0, colon);
  if (colon != std::string::npos) work.numbers = numbers_in(law.substr(colon + 1));
  if (!(work.law == "sphere" && work.numbers.size() == 4) && !(work.law == "box" && work.numbers.size() == 6))
    throw Error("expected sphere:X,Y,Z,R or box:X0,Y0,Z0,X1,Y1,Z1, found " + law);
  work.levels = std::stoi(argv[3]);
  if (argc == 5) work.floors = numbers_in(argv[4]);
  return work;
}

void follow(const par::Comm& comm, const Workload& work, const std::string& name, const refine::Options& options) {
  auto mesh = work.start(comm);
  adapt::Report report;
  report.cells_out = mesh.info.n_global_cells;
  for (int level = 0;; ++level) {
    const auto shape = measure(comm, mesh);
    if (comm.is_first())
      std::printf("| %s | %d | %ld | %ld | %.4f | %.4f | %.4f | %ld | %ld | %ld | %d |\n", name.c_str(), level,
                  report.closure.n_marked, report.cells_out, shape.worst, shape.low, shape.mean,
                  report.closure.families_rebuilt, report.closure.families_kept, report.certificate.n_off_surface,
                  report.closure.early_passes);
    std::fflush(stdout);
    if (level == work.levels) break;
    auto result = adapt::refine(comm, mesh, work.mark(mesh), options);
    mesh = std::move(result.mesh);
    report = result.report;
  }
}

void run(const par::Comm& comm, const Workload& work) {
  if (comm.is_first())
    std::printf(
        "| policy | level | marked | cells | worst mean ratio | 0.1 %% | mean of mean ratio | rebuilt | kept | off | "
        "early |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  if (work.floors.empty())
    for (const auto& [name, policy] : refine::quality_control_names)
      follow(comm, work, name, {.quality_control = policy, .marks_field = ""});
  for (const double floor : work.floors) {
    std::ostringstream name;
    name << "removable " << floor;
    follow(comm, work, name.str(), {.shape_floor = floor, .marks_field = ""});
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
