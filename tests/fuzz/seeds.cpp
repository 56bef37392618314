// SPDX-License-Identifier: GPL-3.0-or-later
#include "seeds.hpp"

#include "pamr/io/native_file.hpp"
#include "pamr/mesh/assemble.hpp"
#include "support/meshes.hpp"
#include "unit/io/files.hpp"
#include "unit/io/hdf5_edit.hpp"

namespace pamr::fuzz {

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".hdf"; }

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  io::write_native(comm, folder / seed_name(0), test::mesh_with_fields(comm, 2, 1), {.provenance = "fuzz"});
  const auto family = test::closure_family(mesh::FamilyKind::face, 1);
  io::write_native(comm, folder / seed_name(1), mesh::assemble(comm, family));
  test::write_plain_vtkhdf(folder / seed_name(2), false);
  const auto chunked = folder / seed_name(3);
  test::write_plain_vtkhdf(chunked, true);
  test::create_group(chunked, "/PAMR");
  test::write_attribute(chunked, "/PAMR", "format", std::vector<std::int64_t>{1});
  test::create_group(chunked, "/PAMR/patches");
  test::write_texts(chunked, "/PAMR/patches/names", {"wall"});
  test::write_texts(chunked, "/PAMR/surfaces", {"[wall]\nkind = \"plane\"\n"});
}

}  // namespace pamr::fuzz
