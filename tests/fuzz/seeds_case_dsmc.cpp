// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <fstream>

#include "case_files.hpp"
#include "mutate.hpp"
#include "pamr/assemble/assemble.hpp"
#include "seeds.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/stream_case.hpp"

namespace pamr::fuzz {

namespace {

constexpr std::array<const char*, 5> cases{"blunt-cone/heat-flux.toml", "supersonic-sphere/case.toml",
                                           "moving-shock/case.toml", "shock/nitrogen-m20.toml", "box/case.toml"};

}  // namespace

// 0 a small case, which goes on to its mesh; then cases of the project
int n_seed_files() { return static_cast<int>(cases.size()) + 1; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  static const auto mesh = assemble::assemble(comm, test::random_mesh(comm, 5, 1));
  const auto problem = dsmc::read_case(text_of(file), file.string());
  if (problem.boundary.contains("ymax")) (void)dsmc::make_setup(comm, problem, mesh);
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".toml"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  std::ofstream(folder / seed_name(0)) << test::stream_case;
  for (int i = 1; i < n_seed_files(); ++i)
    std::ofstream(folder / seed_name(i)) << case_of_project(cases.at(static_cast<std::size_t>(i) - 1));
  std::ofstream(folder / "species.toml") << case_of_project("species.toml");
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
