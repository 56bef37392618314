// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>

#include "mutate.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/io/su2/read_su2.hpp"
#include "pamr/io/su2/write_su2.hpp"
#include "pamr/validate/validate.hpp"
#include "seeds.hpp"
#include "support/meshes.hpp"

namespace pamr::fuzz {

// 0 our own; 1 a tetrahedron as other programs write it: points first, numbers behind, comments, a box for deformation
int n_seed_files() { return 2; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  validate::require_valid(comm, io::read_su2(comm, file, {.split_prisms = true}).mesh, file.string());
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".su2"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  io::write_su2(comm, folder / seed_name(0), assemble::assemble(comm, test::random_mesh(comm, 1, 2)));
  std::ofstream(folder / seed_name(1))
      << "% a comment\nNDIME= 3\n\nNPOIN= 4 4\n0 0 0 0\n1 0 0 1\n0 1. 0 2\n0 0 +1e0 3\n"
         "NELEM= 1\n10\t0 1 2 3 0\nNMARK= 2\nMARKER_TAG= wall\nMARKER_ELEMS= 3\n"
         "5 0 1 2\n5 0 1 3\n5 1 2 3\nMARKER_TAG= far field\nMARKER_ELEMS= 1\n5 0 2 3 7\n"
         "NPERIODIC= 1\nFFD_NBOX= 1\nFFD_CORNER_POINTS= 2\n0.0 0.0 0.0\n1.0 1.0 1.0\n";
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
