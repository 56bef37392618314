// SPDX-License-Identifier: GPL-3.0-or-later
#include "mutate.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/io/cgns/read_cgns.hpp"
#include "pamr/io/export/write_cgns.hpp"
#include "pamr/validate/validate.hpp"
#include "seeds.hpp"
#include "support/meshes.hpp"

namespace pamr::fuzz {

// our own: 0 without fields, 1 with fields on nodes and cells
int n_seed_files() { return 2; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  validate::require_valid(comm, io::read_cgns(comm, file, {.split_prisms = true}).mesh, file.string());
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".cgns"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 1, 2));
  io::write_cgns(comm, folder / seed_name(0), mesh);
  mesh::Field v{"v", "", 3, mesh::StorageType::float64, std::vector<double>()};
  for (const auto& p : mesh.node_position)
    for (std::size_t axis = 0; axis < 3; ++axis) v.real().push_back(p[axis]);
  mesh.node_fields.push_back(v);
  mesh.cell_fields.push_back({"region", "", 1, mesh::StorageType::int32,
                              std::vector<std::int64_t>(static_cast<std::size_t>(mesh.n_cells()), 3)});
  io::write_cgns(comm, folder / seed_name(1), mesh);
  for (int i = 0; i < n_seed_files(); ++i) read_file(comm, folder / seed_name(i));  // good ones
}

}  // namespace pamr::fuzz
