// SPDX-License-Identifier: GPL-3.0-or-later
// netgen on the workloads of docs/performance.md: uniform refinement (W1) and bisection of marked cells (W2, W3), which
// cuts a marked cell three times. `UpdateTopology`, by which its users get the faces of the cells, is part of
// bisection; after uniform refinement it is timed apart. Both work on the mesh in place. Command line and output as
// those of workload.py: netgen_peer WORKLOAD N LEVELS REPEATS BUDGET.
#include <malloc.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <memory>
#include <meshing.hpp>
#include <string>

namespace {

constexpr double growth = 4.5;  // of a level of W3 over the one before, in memory
constexpr double middle = 0.5, radius = 0.35, shell_width = 0.06;

using Corners = std::array<netgen::Point<3>, 4>;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

long status_bytes(const std::string& key, const char* file = "/proc/self/status") {
  std::ifstream status(file);
  for (std::string word; status >> word;)
    if (word == key) {
      status >> word;
      return 1024 * std::stol(word);
    }
  return 0;
}

/// Gives back what is free, so that the peak to come is that of the call.
void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

void add_face(netgen::Mesh& mesh, netgen::PointIndex a, netgen::PointIndex b, netgen::PointIndex c) {
  netgen::Element2d face(a, b, c);
  face.SetIndex(1);
  mesh.AddSurfaceElement(face);
}

/// The Kuhn cube K(n), numbered as lib/pamr/mesh/kuhn_cube.hpp, with its boundary triangles.
std::unique_ptr<netgen::Mesh> kuhn_cube(int n) {
  constexpr int axis_order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
  auto mesh = std::make_unique<netgen::Mesh>();
  mesh->SetDimension(3);
  mesh->AddFaceDescriptor(netgen::FaceDescriptor(1, 1, 0, 1));
  mesh->GetFaceDescriptor(1).SetBCProperty(1);
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) mesh->AddPoint(netgen::Point3d(1.0 * i / n, 1.0 * j / n, 1.0 * k / n));
  for (int cube = 0; cube < n * n * n; ++cube)
    for (const auto& axes : axis_order) {
      std::array<std::array<int, 3>, 4> path{{{cube % n, cube / n % n, cube / n / n}}};
      netgen::Element cell(netgen::TET);
      for (int step = 0; step < 4; ++step) {
        auto& p = path[static_cast<std::size_t>(step)];
        if (step > 0) {
          p = path[static_cast<std::size_t>(step - 1)];
          ++p[static_cast<std::size_t>(axes[step - 1])];
        }
        cell[step] = netgen::PointIndex(1 + p[0] + (n + 1) * (p[1] + (n + 1) * p[2]));
      }
      // The first face of the path lies in the cube's far side along the first axis, its last in the near side along
      // the last axis.
      if (path[1][static_cast<std::size_t>(axes[0])] == n) add_face(*mesh, cell[1], cell[2], cell[3]);
      if (path[0][static_cast<std::size_t>(axes[2])] == 0) add_face(*mesh, cell[0], cell[1], cell[2]);
      cell.SetIndex(1);
      mesh->AddVolumeElement(cell);
    }
  mesh->SetNextMajorTimeStamp();
  return mesh;
}

Corners corners(const netgen::Mesh& mesh, netgen::ElementIndex cell) {
  Corners p;
  for (int i = 0; i < 4; ++i) p[static_cast<std::size_t>(i)] = mesh.Point(mesh.VolumeElement(cell)[i]);
  return p;
}

double distance(const netgen::Point<3>& p) { return std::hypot(p(0) - middle, p(1) - middle, p(2) - middle); }

bool in_shell(const Corners& p) {
  netgen::Point<3> centroid(0, 0, 0);
  for (int axis = 0; axis < 3; ++axis) centroid(axis) = 0.25 * (p[0](axis) + p[1](axis) + p[2](axis) + p[3](axis));
  return std::abs(distance(centroid) - radius) < shell_width;
}

bool cut_by_sphere(const Corners& p) {
  double least = 1e300, greatest = 0;
  for (const auto& corner : p) {
    least = std::min(least, distance(corner));
    greatest = std::max(greatest, distance(corner));
  }
  return least < radius && radius < greatest;
}

/// Least of 12 (3V)^(2/3) / sum of squared edges, 1 for a regular tetrahedron.
double worst_mean_ratio(const netgen::Mesh& mesh) {
  double worst = 1;
  for (netgen::ElementIndex cell = 0; cell < mesh.GetNE(); ++cell) {
    const auto p = corners(mesh, cell);
    const double volume = std::abs(netgen::Cross(p[1] - p[0], p[2] - p[0]) * (p[3] - p[0])) / 6;
    double squares = 0;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) squares += (p[b] - p[a]).Length2();
    worst = std::min(worst, 12 * std::pow(3 * volume, 2.0 / 3) / squares);
  }
  return worst;
}

void mark(netgen::Mesh& mesh, const std::string& workload) {
  for (netgen::ElementIndex cell = 0; cell < mesh.GetNE(); ++cell) {
    const auto p = corners(mesh, cell);
    mesh.VolumeElement(cell).SetRefinementFlag(workload == "W2" ? in_shell(p) : cut_by_sphere(p));
  }
}

void refine(netgen::Mesh& mesh, bool is_uniform) {
  const netgen::Refinement refinement;
  if (is_uniform) return refinement.Refine(mesh);
  netgen::BisectionOptions options;
  options.usemarkedelements = 1;
  refinement.Bisect(mesh, options);
}

double time_topology(netgen::Mesh& mesh) {
  const auto start = cpu_seconds();
  mesh.UpdateTopology();
  return cpu_seconds() - start;
}

void one_run(const std::string& workload, int n, int levels, int run) {
  const auto before = status_bytes("VmRSS:");
  const auto mesh = kuhn_cube(n);
  for (int level = 1; level <= levels; ++level) {
    if (workload != "W1") mark(*mesh, workload);
    forget_peak();
    const auto start = cpu_seconds();
    refine(*mesh, workload == "W1");
    const auto refined = cpu_seconds();
    const auto peak = status_bytes("VmHWM:") - before;
    std::printf(
        "{\"peer\": \"netgen %s\", \"workload\": \"%s\", \"level\": %d, \"run\": %d, \"cells\": %zu, \"cpu\": %.6f, "
        "\"peak\": %ld",
        NETGEN_VERSION_NAME, workload.c_str(), level, run, static_cast<std::size_t>(mesh->GetNE()), refined - start,
        peak);
    if (workload == "W1") std::printf(", \"relate_cpu\": %.6f", time_topology(*mesh));
    if (workload == "W3" && run == 1) std::printf(", \"worst\": %.6f", worst_mean_ratio(*mesh));
    std::puts("}");
    std::fflush(stdout);
    if (growth * static_cast<double>(peak) > static_cast<double>(status_bytes("MemAvailable:", "/proc/meminfo")))
      return;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fputs("usage: netgen_peer WORKLOAD N LEVELS REPEATS BUDGET\n", stderr);
    return 2;
  }
  const std::string workload = argv[1];
  const int n = std::stoi(argv[2]), levels = std::stoi(argv[3]), repeats = std::stoi(argv[4]);
  const double budget = std::stod(argv[5]);
  netgen::printmessage_importance = 0;
  one_run(workload, n, levels, 1);
  const double duration = cpu_seconds();
  for (int run = 2; run <= repeats && cpu_seconds() + duration <= budget; ++run) one_run(workload, n, levels, run);
  return 0;
}
