// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/// The workloads of docs/reports/performance.md for peers that speak C++: mesh, marks, clock, memory, shapes. What
/// workload.py is for Python; command line and output are the same.
///
/// A peer is a class with
///   Peer(const PlainMesh&)       makes the mesh in the peer's own data structure
///   name()                       name and version
///   n_cells(), corners(visit)    number of cells; visit(Corners) for each, always in the same order
///   mark(flags)                  hands over a flag for each cell in that order; not timed. Empty: all
///   refine()                     the timed call
///   relate()                     the peer's way to the cells on both sides of a face, where `refine` does not include
///                                it: true when it did something
///   coarsen()                    goes back one level: true when it could; timed apart
namespace peer {

using Point = std::array<double, 3>;
using Corners = std::array<Point, 4>;

struct PlainMesh {
  std::vector<Point> node;
  std::vector<std::array<int, 4>> cell;  ///< positive: (p1 - p0) x (p2 - p0) . (p3 - p0) > 0
};

constexpr double growth = 4.5;  ///< of a level of W3 over the one before, in memory

inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

inline long status_bytes(const std::string& key, const char* file = "/proc/self/status") {
  std::ifstream status(file);
  for (std::string word; status >> word;)
    if (word == key) {
      status >> word;
      return 1024 * std::stol(word);
    }
  return 0;
}

/// Gives back what is free, so that the peak to come is that of the call.
inline void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

/// The Kuhn cube K(n), numbered as lib/pamr/mesh/kuhn_cube.hpp.
inline PlainMesh kuhn_cube(int n) {
  constexpr std::array<std::array<int, 3>, 6> axis_order{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}}};
  PlainMesh mesh;
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) mesh.node.push_back({1.0 * i / n, 1.0 * j / n, 1.0 * k / n});
  for (int cube = 0; cube < n * n * n; ++cube)
    for (std::size_t order = 0; order < 6; ++order) {
      std::array<int, 3> p{cube % n, cube / n % n, cube / n / n};
      std::array<int, 4> path{};
      for (std::size_t step = 0; step < 4; ++step) {
        if (step > 0) ++p[static_cast<std::size_t>(axis_order[order][step - 1])];
        path[step] = p[0] + (n + 1) * (p[1] + (n + 1) * p[2]);
      }
      if (order >= 3) std::swap(path[1], path[2]);  // odd orders of axes
      mesh.cell.push_back(path);
    }
  return mesh;
}

/// The tetrahedra of a Gmsh file of format 2.2, text.
inline PlainMesh read_mesh(const std::string& file) {
  std::ifstream in(file);
  PlainMesh mesh;
  std::map<long, int> node_number;
  long count = 0;
  for (std::string line; std::getline(in, line);) {
    if (line == "$Nodes" && in >> count)
      for (long tag = 0; count > 0 && in >> tag; --count) {
        node_number[tag] = static_cast<int>(mesh.node.size());
        auto& p = mesh.node.emplace_back();
        in >> p[0] >> p[1] >> p[2];
      }
    if (line != "$Elements" || !(in >> count)) continue;
    for (std::getline(in, line); count > 0 && std::getline(in, line); --count) {
      std::istringstream row(line);
      long number = 0, type = 0, n_tags = 0, tag = 0;
      row >> number >> type >> n_tags;
      if (type != 4) continue;
      for (; n_tags > 0; --n_tags) row >> tag;
      for (auto& n : mesh.cell.emplace_back()) {
        row >> tag;
        n = node_number.at(tag);
      }
    }
  }
  if (mesh.cell.empty()) throw std::runtime_error("expected a Gmsh file of format 2.2, text, with tetrahedra: " + file);
  return mesh;
}

/// `kuhn:N` or the name of a file.
inline PlainMesh mesh_named(const std::string& name) {
  return name.rfind("kuhn:", 0) == 0 ? kuhn_cube(std::stoi(name.substr(5))) : read_mesh(name);
}

using Law = std::function<bool(const Corners&)>;

inline Point centroid(const Corners& p) {
  Point sum{};
  for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] = 0.25 * (p[0][axis] + p[1][axis] + p[2][axis] + p[3][axis]);
  return sum;
}

inline double distance(const Point& p, const Point& q) { return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]); }

constexpr Point middle{0.5, 0.5, 0.5};
constexpr double sphere_radius = 0.35, shell_width = 0.06;

/// Cells cut by a sphere: a corner within, another without.
inline Law cut_by_sphere(Point center, double radius) {
  return [=](const Corners& p) {
    double nearest = 1e300, farthest = 0;
    for (const auto& corner : p) {
      nearest = std::min(nearest, distance(corner, center));
      farthest = std::max(farthest, distance(corner, center));
    }
    return nearest < radius && radius < farthest;
  };
}

/// Cells whose centroid lies in a box.
inline Law inside_box(Point low, Point high) {
  return [=](const Corners& p) {
    const auto c = centroid(p);
    bool is_inside = true;
    for (std::size_t axis = 0; axis < 3; ++axis) is_inside = is_inside && low[axis] <= c[axis] && c[axis] <= high[axis];
    return is_inside;
  };
}

/// `sphere:X,Y,Z,R` or `box:X0,Y0,Z0,X1,Y1,Z1`.
inline Law law_named(const std::string& name) {
  std::vector<double> numbers;
  std::istringstream list(name.substr(name.find(':') + 1));
  for (std::string number; std::getline(list, number, ',');) numbers.push_back(std::stod(number));
  if (name.rfind("sphere:", 0) == 0 && numbers.size() == 4)
    return cut_by_sphere({numbers[0], numbers[1], numbers[2]}, numbers[3]);
  if (name.rfind("box:", 0) == 0 && numbers.size() == 6)
    return inside_box({numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]});
  throw std::runtime_error("expected sphere:X,Y,Z,R or box:X0,Y0,Z0,X1,Y1,Z1, found " + name);
}

inline Law law_of(const std::string& workload) {
  if (workload == "W3") return cut_by_sphere(middle, sphere_radius);
  return [](const Corners& p) { return std::abs(distance(centroid(p), middle) - sphere_radius) < shell_width; };
}

/// 12 (3V)^(2/3) / sum of squared edges, 1 for a regular tetrahedron.
inline double mean_ratio(const Corners& p) {
  std::array<Point, 3> d{};
  double squares = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) squares += std::pow(distance(p[i], p[j]), 2);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) d[i][axis] = p[i + 1][axis] - p[0][axis];
  const double six_volumes = d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) -
                             d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
                             d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
  return 12 * std::pow(std::abs(six_volumes) / 2, 2.0 / 3) / squares;
}

struct Shapes {
  double worst = 1, low = 1, mean = 0;  ///< low: one cell of a thousand is below
};

template <class Peer>
Shapes shapes(Peer& peer) {
  std::vector<double> ratio;
  peer.corners([&](const Corners& p) { ratio.push_back(mean_ratio(p)); });
  Shapes found;
  for (const double r : ratio) found.mean += r / static_cast<double>(ratio.size());
  std::sort(ratio.begin(), ratio.end());
  found.worst = ratio.front();
  found.low = ratio[ratio.size() / 1000];
  return found;
}

template <class Peer>
void mark(Peer& peer, const Law& law) {
  std::vector<bool> flags;
  peer.corners([&](const Corners& p) { flags.push_back(law(p)); });
  peer.mark(flags);
}

template <class Call>
double measured(Call&& call) {
  const double start = cpu_seconds();
  call();
  return cpu_seconds() - start;
}

/// All the way back, one level a call.
template <class Peer>
void time_coarsening(Peer& peer, const std::string& workload, int level, int run) {
  const auto n_cells = peer.n_cells();
  int calls = 0;
  const double cpu = measured([&] {
    while (peer.coarsen()) ++calls;
  });
  if (calls > 0)
    std::printf(
        "{\"peer\": \"%s\", \"coarsening\": \"%s\", \"level\": %d, \"run\": %d, \"cells\": %zu, \"cells_left\": %zu, "
        "\"calls\": %d, \"cpu\": %.6f}\n",
        peer.name().c_str(), workload.c_str(), level, run, n_cells, peer.n_cells(), calls, cpu);
}

template <class Peer>
void one_run(const std::string& workload, int n, int levels, int run) {
  const auto before = status_bytes("VmRSS:");
  Peer peer(kuhn_cube(n));
  int level = 1;
  for (bool goes_on = true; goes_on; ++level) {
    if (workload == "W1")
      peer.mark({});
    else
      mark(peer, law_of(workload));
    forget_peak();
    const double cpu = measured([&] { peer.refine(); });
    const auto peak = status_bytes("VmHWM:") - before;
    std::printf(
        "{\"peer\": \"%s\", \"workload\": \"%s\", \"level\": %d, \"run\": %d, \"cells\": %zu, \"cpu\": %.6f, "
        "\"peak\": %ld",
        peer.name().c_str(), workload.c_str(), level, run, peer.n_cells(), cpu, peak);
    bool has_related = false;
    const double relate_cpu = measured([&] { has_related = workload == "W1" && peer.relate(); });
    if (has_related) std::printf(", \"relate_cpu\": %.6f", relate_cpu);
    if (workload == "W3" && run == 1) std::printf(", \"worst\": %.6f", shapes(peer).worst);
    std::puts("}");
    std::fflush(stdout);
    goes_on = level < levels &&
              growth * static_cast<double>(peak) < static_cast<double>(status_bytes("MemAvailable:", "/proc/meminfo"));
  }
  if (workload != "W1") time_coarsening(peer, workload, level - 1, run);
}

/// The shapes of every level: a line for each.
template <class Peer>
void follow_shapes(const std::string& mesh_name, const std::string& law_name, int levels) {
  Peer peer(mesh_named(mesh_name));
  for (int level = 0; level <= levels; ++level) {
    if (level > 0) {
      mark(peer, law_named(law_name));
      forget_peak();
      peer.refine();
    }
    const auto found = shapes(peer);
    std::printf("{\"peer\": \"%s\", \"level\": %d, \"cells\": %zu, \"worst\": %.6f, \"low\": %.6f, \"mean\": %.6f}\n",
                peer.name().c_str(), level, peer.n_cells(), found.worst, found.low, found.mean);
    std::fflush(stdout);
    if (growth * static_cast<double>(status_bytes("VmHWM:")) >
        static_cast<double>(status_bytes("MemAvailable:", "/proc/meminfo")))
      return;
  }
}

/// PEER WORKLOAD N LEVELS REPEATS BUDGET, or PEER shapes MESH LAW LEVELS.
template <class Peer>
int main_of(int argc, char** argv) {
  const std::string workload = argc > 1 ? argv[1] : "";
  if (workload == "shapes" && argc == 5) {
    follow_shapes<Peer>(argv[2], argv[3], std::stoi(argv[4]));
    return 0;
  }
  if (argc != 6) {
    std::fprintf(stderr, "usage: %s WORKLOAD N LEVELS REPEATS BUDGET | %s shapes MESH LAW LEVELS\n", argv[0], argv[0]);
    return 2;
  }
  const int n = std::stoi(argv[2]), levels = std::stoi(argv[3]), repeats = std::stoi(argv[4]);
  const double budget = std::stod(argv[5]);
  one_run<Peer>(workload, n, levels, 1);
  const double duration = cpu_seconds();
  for (int run = 2; run <= repeats && cpu_seconds() + duration <= budget; ++run)
    one_run<Peer>(workload, n, levels, run);
  return 0;
}

}  // namespace peer
