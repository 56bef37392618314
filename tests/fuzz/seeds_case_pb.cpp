// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "case_files.hpp"
#include "mutate.hpp"
#include "seeds.hpp"
#include "solvers/poisson_boltzmann/problem/pb_case.hpp"

namespace pamr::fuzz {

namespace {

constexpr std::array<const char*, 6> cases{"charged-spheres/paper.toml", "charged-spheres/reading-b.toml",
                                           "ellipsoid-plate/case.toml",  "charged-rod/eccentric.toml",
                                           "sphere-pair/case.toml",      "plate/cube.toml"};

}  // namespace

int n_seed_files() { return static_cast<int>(cases.size()); }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& /*comm*/, const std::filesystem::path& file) {
  const auto problem = poisson_boltzmann::read_case(text_of(file), file.string());
  (void)poisson_boltzmann::describe(problem);
  for (const auto& boundary : problem.boundary)
    if (!std::isfinite(boundary.value)) throw std::logic_error("accepted, but not finite");
  for (const auto& sphere : problem.spheres)
    if (!std::isfinite(norm(sphere.center)) || !std::isfinite(sphere.radius) || sphere.radius <= 0)
      throw std::logic_error("accepted, but no sphere");
  if (!(problem.solver.tolerance > 0 && problem.solver.tolerance < 1)) throw std::logic_error("accepted, no tolerance");
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".toml"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  for (int i = 0; i < n_seed_files(); ++i)
    std::ofstream(folder / seed_name(i)) << case_of_project(cases.at(static_cast<std::size_t>(i)));
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
