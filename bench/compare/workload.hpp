// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "assess.hpp"
#include "memory.hpp"

/// The workloads of docs/reports/performance.md for codes that speak C++, ours included: mesh, marks, clock, memory.
/// As workload.py for Python; command line and output are the same and are explained there.
///
/// A code is a class with
///   Peer(const std::string& mesh)  makes the mesh in its own data structure; `mesh_named` reads it
///   name()                         name and version
///   n_cells(), corners(visit)      number of cells; visit(Corners) for each, always in the same order
///   mark(flags)                    hands over a flag for each cell in that order: 1 split, -1 coarsen if possible, 0
///                                  keep; not timed. Empty: split all
///   refine()                       the timed call
///   mark_more()                    marks for another call that the same work takes; false when there is none
///   coarsening_calls()             that it takes to take back what one call has split
///   relate()                       the code's way to the cells on both sides of a face, where `refine` does not
///                                  include it: true when it did something
namespace peer {

struct PlainMesh {
  std::vector<Point> node;
  std::vector<std::array<int, 4>> cell;  ///< positive: (p1 - p0) x (p2 - p0) . (p3 - p0) > 0
};

constexpr std::size_t bytes_of_cell = 200;  ///< of what a call takes, for `warm_memory`
constexpr double growth = 4.5;              ///< of a level around a sphere over the one before, in memory

inline double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
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

/// Faces of one cell, by their nodes, seen from outside.
inline std::vector<std::array<int, 3>> boundary_of(const PlainMesh& plain) {
  constexpr std::array<std::array<std::size_t, 3>, 4> face_to_corner{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::map<std::array<int, 3>, std::array<int, 3>> open;
  for (const auto& n : plain.cell)
    for (const auto& f : face_to_corner) {
      const std::array<int, 3> face{n[f[0]], n[f[1]], n[f[2]]};
      auto key = face;
      std::sort(key.begin(), key.end());
      if (!open.emplace(key, face).second) open.erase(key);
    }
  std::vector<std::array<int, 3>> faces;
  for (const auto& [key, face] : open) faces.push_back(face);
  return faces;
}

using Law = std::function<bool(const Corners&)>;

constexpr double shell_width = 0.06;

/// Cells cut by a sphere: a corner within, another without.
inline Law cut_by_sphere(Point center, double radius) {
  return [=](const Corners& p) {
    const auto [nearest, farthest] = distances(p, center);
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

inline Law law_named(const std::string& name) {
  if (name == "uniform") return [](const Corners&) { return true; };
  if (name == "shell")
    return [](const Corners& p) { return std::abs(distance(centroid(p), {0.5, 0.5, 0.5}) - 0.35) < shell_width; };
  if (name == "wall") return [](const Corners& p) { return distances(p, hole_center).first <= on_wall * hole_radius; };
  std::vector<double> numbers;
  std::istringstream list(name.substr(name.find(':') + 1));
  for (std::string number; std::getline(list, number, ',');) numbers.push_back(std::stod(number));
  if (name.rfind("sphere:", 0) == 0 && numbers.size() == 4)
    return cut_by_sphere({numbers[0], numbers[1], numbers[2]}, numbers[3]);
  if (name.rfind("box:", 0) == 0 && numbers.size() == 6)
    return inside_box({numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]});
  throw std::runtime_error("expected uniform, shell, wall, front, sphere:X,Y,Z,R or box:X0,Y0,Z0,X1,Y1,Z1, found " +
                           name);
}

template <class Call>
double measured(Call&& call) {
  const double start = cpu_seconds();
  call();
  return cpu_seconds() - start;
}

/// One line: what is known of a level, and with `assessment` what workload.py says that it has.
template <class Peer>
void print_line(const Peer& peer, const std::string& workload, int level, const std::string& values,
                const std::optional<Assessment>& assessment) {
  std::printf("{\"peer\": \"%s\", \"workload\": \"%s\", \"level\": %d, \"cells\": %zu%s%s}\n", peer.name().c_str(),
              workload.c_str(), level, peer.n_cells(), values.c_str(), assessment ? text_of(*assessment).c_str() : "");
  std::fflush(stdout);
}

inline std::string value_text(const std::string& key, double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), ", \"%s\": %.9g", key.c_str(), value);
  return text.data();
}

template <class Peer>
std::vector<std::int8_t> flags_of(Peer& peer, const Law& law) {
  std::vector<std::int8_t> flags;
  flags.reserve(peer.n_cells());
  peer.corners([&](const Corners& p) { flags.push_back(law(p) ? 1 : 0); });
  return flags;
}

template <class Peer>
void follow_levels(const std::string& workload, const std::string& mesh_name, int levels, bool assesses) {
  const auto law = law_named(workload);
  const bool is_uniform = workload == "uniform";
  const auto before = status_bytes("VmRSS:");
  Peer peer(mesh_name);
  std::optional<Assessment> assessment;
  const auto assess_again = [&] {
    if (assesses) assessment = assess(peer, domain_of(mesh_name), assessment);
  };
  assess_again();
  if (assesses) print_line(peer, workload, 0, "", assessment);
  for (int level = 1; level <= levels; ++level) {
    auto flags = is_uniform ? std::vector<std::int8_t>{} : flags_of(peer, law);
    peer.mark(flags);
    const auto n_split =
        is_uniform ? peer.n_cells() : static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
    warm_memory(bytes_of_cell * (peer.n_cells() + 8 * n_split));
    std::vector<std::int8_t>().swap(flags);
    forget_peak();
    double cpu = measured([&] { peer.refine(); });
    while (peer.mark_more()) cpu += measured([&] { peer.refine(); });
    const auto peak = status_bytes("VmHWM:") - before;
    auto values = value_text("cpu", cpu) + value_text("peak", static_cast<double>(peak));
    bool has_related = false;
    const double relate_cpu = measured([&] { has_related = is_uniform && peer.relate(); });
    if (has_related) values += value_text("relate_cpu", relate_cpu);
    assess_again();
    print_line(peer, workload, level, values, assessment);
    if (growth * static_cast<double>(peak) > static_cast<double>(status_bytes("MemAvailable:", "/proc/meminfo")))
      return;
  }
}

/// A sphere that has moved by x: cells that it cuts are split while their longest edge is above `size`, those farther
/// from it than their longest edge may be coarsened.
template <class Peer>
std::vector<std::int8_t> flags_at_front(Peer& peer, double x, double size, bool coarsens) {
  const Point center{front_start + x, 0.5, 0.5};
  std::vector<std::int8_t> flags;
  flags.reserve(peer.n_cells());
  peer.corners([&](const Corners& p) {
    const auto [nearest, farthest] = distances(p, center);
    const double longest = longest_edge(p);
    const bool is_cut = nearest < front_radius && front_radius < farthest;
    const bool is_near = nearest < front_radius + longest && farthest > front_radius - longest;
    flags.push_back(static_cast<std::int8_t>(is_cut && longest > size ? 1 : is_near || !coarsens ? 0 : -1));
  });
  return flags;
}

/// Calls until no cell that the front cuts is too large; seconds of them.
template <class Peer>
double meet_front(Peer& peer, double x, double size, int& calls) {
  double cpu = 0;
  for (calls = 0; calls < 40; ++calls) {
    const auto flags = flags_at_front(peer, x, size, calls < peer.coarsening_calls());
    if (calls >= peer.coarsening_calls() && std::count(flags.begin(), flags.end(), 1) == 0) break;
    peer.mark(flags);
    cpu += measured([&] { peer.refine(); });
  }
  return cpu;
}

template <class Peer>
void follow_front(const std::string& mesh_name, int levels, int steps, bool assesses) {
  const int n = std::stoi(mesh_name.substr(mesh_name.find(':') + 1));
  const double size = 1.01 * std::sqrt(3.0) / n / (1 << levels);
  const auto before = status_bytes("VmRSS:");
  Peer peer(mesh_name);
  int calls = 0;
  meet_front(peer, 0, size, calls);
  std::optional<Assessment> assessment;
  for (int step = 1; step <= steps; ++step) {
    const auto cells_in = static_cast<double>(peer.n_cells());
    if (assesses) assessment = assess(peer, domain_of(mesh_name), std::nullopt);
    warm_memory(2 * bytes_of_cell * peer.n_cells());
    forget_peak();
    const double cpu = meet_front(peer, front_shift * step, size, calls);
    const auto peak = static_cast<double>(status_bytes("VmHWM:") - before);
    if (assesses) assessment = assess(peer, domain_of(mesh_name), assessment);
    print_line(peer, "front", step,
               value_text("cpu", cpu) + value_text("peak", peak) + value_text("calls", calls) +
                   value_text("cells_in", cells_in),
               assessment);
  }
}

/// CODE WORKLOAD MESH LEVELS [STEPS] [assess]; see workload.py.
template <class Peer>
int main_of(int argc, char** argv) {
  const bool assesses = argc > 1 && std::string(argv[argc - 1]) == "assess";
  const int n = assesses ? argc - 1 : argc;
  const std::string workload = n > 1 ? argv[1] : "";
  if (n != (workload == "front" ? 5 : 4)) {
    std::fprintf(stderr, "usage: %s WORKLOAD MESH LEVELS [assess] | %s front kuhn:N LEVELS STEPS [assess]\n", argv[0],
                 argv[0]);
    return 2;
  }
  if (workload == "front")
    follow_front<Peer>(argv[2], std::stoi(argv[3]), std::stoi(argv[4]), assesses);
  else
    follow_levels<Peer>(workload, argv[2], std::stoi(argv[3]), assesses);
  return 0;
}

}  // namespace peer
