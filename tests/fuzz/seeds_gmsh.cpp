// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutate.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/io/gmsh/read_gmsh.hpp"
#include "pamr/io/gmsh/write_gmsh.hpp"
#include "pamr/validate/validate.hpp"
#include "seeds.hpp"
#include "support/meshes.hpp"

namespace pamr::fuzz {

// 0 version 2.2 as text, 1 binary; 2 version 4.1 as text, 3 binary
int n_seed_files() { return 4; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  validate::require_valid(comm, io::read_gmsh(comm, file, {.split_prisms = true}).mesh, file.string());
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".msh"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  auto block = test::random_mesh(comm, 1, 2);
  block.info.regions = {{1, "gas"}, {2, "solid"}};
  std::vector<std::int64_t> region(block.cell_to_node.size());
  for (std::size_t c = 0; c < region.size(); ++c) region[c] = 1 + (block.first_cell + static_cast<std::int64_t>(c)) % 2;
  block.cell_fields = {{"region", "", 1, mesh::StorageType::int32, std::move(region)}};
  const auto mesh = assemble::assemble(comm, std::move(block));
  for (int i = 0; i < n_seed_files(); ++i)
    io::write_gmsh(comm, folder / seed_name(i), mesh,
                   {i < 2 ? io::GmshVersion::v2_2 : io::GmshVersion::v4_1, i % 2 == 1, io::Interfaces::by_regions});
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
