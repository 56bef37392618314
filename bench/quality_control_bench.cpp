// SPDX-License-Identifier: GPL-3.0-or-later
// Cells and their shapes, level by level, under each of the four quality-control policies, or under `removable` with
// the shape floors given:
//   bench_quality_control MESH LAW LEVELS [FLOOR,...]
// MESH: kuhn:N, the Kuhn cube K(N), or a mesh file, PAMR's or (*.msh) Gmsh's. LAW: which cells are marked at every
// level: sphere:X,Y,Z,R those cut by a sphere, box:X0,Y0,Z0,X1,Y1,Z1 those with their centroid in a box,
// wall-and-shell:PATCH,X,Y,Z,R,W1,W2,... those with a face on the patch, and at level n those with their centroid
// nearer than Wn to the sphere. Prints one Markdown table; "0.1 %": one cell of a thousand is below; "below": cells
// under the floor. Run alone or under mpirun.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/workloads.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/gmsh/read_gmsh.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mark/geometric_criteria.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "pamr/par/runtime.hpp"

namespace {

using namespace pamr;

struct Shape {
  double worst = 1, low = 1, mean = 0;
  std::int64_t n_below = 0;
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

Shape measure(const par::Comm& comm, const mesh::DistMesh& mesh, double floor) {
  Shape shape;
  std::vector<double> ratios;
  ratios.reserve(static_cast<std::size_t>(mesh.n_cells()));
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    ratios.push_back(geometry::mean_ratio(mesh.points(c)));
    shape.worst = std::min(shape.worst, ratios.back());
    shape.n_below += ratios.back() < (1 - 0x1p-40) * floor ? 1 : 0;
  }
  shape.n_below = comm.sum(shape.n_below);
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
  std::string mesh, law, patch;
  std::vector<double> numbers;
  int levels = 0;
  std::vector<double> floors;

  mesh::DistMesh start(const par::Comm& comm) const {
    if (mesh.starts_with("kuhn:")) return bench::cube(comm, std::stoi(mesh.substr(5)));
    if (mesh.ends_with(".msh")) return io::read_gmsh(comm, mesh).mesh;
    return assemble::assemble(comm, io::read_native(comm, mesh));
  }
  std::vector<std::uint8_t> mark(const par::Comm& comm, const mesh::DistMesh& coarse, std::size_t level) const {
    const auto& n = numbers;
    if (law == "wall-and-shell") {
      auto wanted = mark::near_patch(comm, coarse, patch);
      const auto in_shell = mark::centroid_in_shell(coarse, {{n[0], n[1], n[2]}, n[3]}, n.at(4 + level));
      for (std::size_t c = 0; c < wanted.size(); ++c) wanted[c] = std::max(wanted[c], in_shell[c]);
      return mark::marks_of(wanted);
    }
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
  auto rest = colon == std::string::npos ? std::string() : law.substr(colon + 1);
  if (work.law == "wall-and-shell") {
    work.patch = rest.substr(0, rest.find(','));
    rest.erase(0, work.patch.size() + 1);
  }
  work.numbers = numbers_in(rest);
  work.levels = std::stoi(argv[3]);
  const auto n = work.numbers.size();
  if (!(work.law == "sphere" && n == 4) && !(work.law == "box" && n == 6) &&
      !(work.law == "wall-and-shell" && n >= 4 + static_cast<std::size_t>(work.levels)))
    throw Error(
        "expected sphere:X,Y,Z,R or box:X0,Y0,Z0,X1,Y1,Z1 or wall-and-shell:PATCH,X,Y,Z,R,W1,W2,... with a width for "
        "each level, found " +
        law);
  if (argc == 5) work.floors = numbers_in(argv[4]);
  return work;
}

void follow(const par::Comm& comm, const Workload& work, const std::string& name, const refine::Options& options) {
  auto mesh = work.start(comm);
  adapt::Report report;
  report.cells_out = mesh.info.n_global_cells;
  for (int level = 0;; ++level) {
    const auto shape = measure(comm, mesh, options.shape_floor);
    if (comm.is_first())
      std::printf("| %s | %d | %ld | %ld | %.4f | %.4f | %.4f | %ld | %ld | %ld | %ld | %d |\n", name.c_str(), level,
                  report.closure.n_marked, report.cells_out, shape.worst, shape.low, shape.mean, shape.n_below,
                  report.closure.families_rebuilt, report.closure.families_kept, report.certificate.n_off_surface,
                  report.closure.early_passes);
    std::fflush(stdout);
    if (level == work.levels) break;
    const auto flags = work.mark(comm, mesh, static_cast<std::size_t>(level));
    auto result = adapt::refine(comm, std::move(mesh), flags, options);
    mesh = std::move(result.mesh);
    report = result.report;
  }
}

void run(const par::Comm& comm, const Workload& work) {
  if (comm.is_first())
    std::printf(
        "| policy | level | marked | cells | worst mean ratio | 0.1 %% | mean of mean ratio | below | rebuilt | kept | "
        "off | early |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
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
