// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>

#include "mutate.hpp"
#include "pamr/io/mfem/read_mfem.hpp"
#include "pamr/validate/validate.hpp"
#include "seeds.hpp"

namespace pamr::fuzz {

// 0 vertices, comments, names; 1 coordinates as nodes of first order
int n_seed_files() { return 2; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  validate::require_valid(comm, io::read_mfem(comm, file, {.split_prisms = true}).mesh, file.string());
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".mfem"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  const std::string elements =
      "dimension\n3\n\nelements\n2\n1 4 0 1 2 3\n2 4 1 2 3 4\n\nboundary\n7\n1 2 0 1 2\n1 2 0 1 3\n1 2 0 2 3\n"
      "2 2 1 2 4\n2 2 1 3 4\n2 2 2 3 4\n3 2 1 2 3\n\n";
  std::ofstream(folder / seed_name(0))
      << "MFEM mesh v1.3\n\n# a comment\n"
      << elements
      << "attribute_sets\n1\n\"gas\" 1 1\n\nbdr_attribute_sets\n2\n\"near wall\" 1 1\n\"both\" 2 1 2\n\n"
         "vertices\n5\n3\n0 0 0\n1 0 0\n0 1. 0\n0 0 1e0\n1 1 1\n\nmfem_mesh_end\n";
  std::ofstream(folder / seed_name(1))
      << "MFEM mesh v1.0\n\n"
      << elements
      << "vertices\n5\n\nnodes\nFiniteElementSpace\nFiniteElementCollection: H1_3D_P1\nVDim: 3\nOrdering: 1\n\n"
         "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n";
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
