// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutate.hpp"
#include "pamr/io/medit/read_medit.hpp"
#include "pamr/io/medit/write_medit.hpp"
#include "seeds.hpp"
#include "unit/io/files.hpp"

namespace pamr::fuzz {

// fields of one mesh, 0 as text, 1 as bytes
int n_seed_files() { return 2; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  io::MeditOptions options;
  options.solution = file;
  (void)io::read_medit(comm, file.parent_path() / "good.meshb", options);
}

std::string seed_name(int i) { return i == 0 ? "seed0.sol" : "seed1.solb"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  const auto mesh = test::mesh_with_fields(comm, 2, 1);
  io::write_medit(comm, folder / "good.meshb", mesh);
  for (int i = 0; i < n_seed_files(); ++i) {
    io::write_medit_fields(comm, folder / seed_name(i), mesh, io::choose_medit_fields(mesh, {}));
  }
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
