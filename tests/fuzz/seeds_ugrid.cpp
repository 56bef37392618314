// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutate.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/io/ugrid/read_ugrid.hpp"
#include "pamr/io/ugrid/write_ugrid.hpp"
#include "pamr/validate/validate.hpp"
#include "seeds.hpp"
#include "support/meshes.hpp"

namespace pamr::fuzz {

// two meshes; the other order of bytes is the same reader
int n_seed_files() { return 2; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  validate::require_valid(comm, io::read_ugrid(comm, file, {.split_prisms = true}).mesh, file.string());
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".lb8.ugrid"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  for (int i = 0; i < n_seed_files(); ++i) {
    io::write_ugrid(comm, folder / seed_name(i),
                    assemble::assemble(comm, test::random_mesh(comm, static_cast<std::uint64_t>(i + 1), 1 + i)));
  }
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
