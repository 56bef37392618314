// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdexcept>
#include <utility>

#include "mutate.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/ring.hpp"
#include "pamr/validate/validate.hpp"
#include "seeds.hpp"
#include "support/meshes.hpp"
#include "unit/io/files.hpp"
#include "unit/io/hdf5_edit.hpp"

namespace pamr::fuzz {

// 0 a Kuhn cube with fields and patches, also of faces inside, as the library writes it; 1 a closure family; 2 the `/VTKHDF` part alone in
// HDF5's oldest layout; 3 the same chunked and compressed, with texts of variable length and families of format 1; 4
// all parts in the oldest layout and without checksums, so that damage reaches the values; 5 and 6 as 0 and 1, without
// checksums; 7 and 8 with a map of level 0, with and without checksums.
int n_seed_files() { return 9; }

std::string damaged(const std::string& good, std::uint64_t seed) { return mutate(good, seed); }

/// As every tool does; inverted cells and open boundaries are accepted, since `pamr-quality` counts them.
void read_file(const par::Comm& comm, const std::filesystem::path& file) {
  const auto mesh = with_file_name(file, [&] { return assemble::assemble(comm, io::read_native(comm, file)); });
  for (const auto& violation : validate::validate(comm, mesh))
    if (violation.invariant == "ids_in_range" || violation.invariant == "distinct_corners" ||
        violation.invariant == "finite_coordinates" || violation.invariant == "patches_in_range")
      throw std::logic_error("accepted, but " + violation.invariant);
}

std::string seed_name(int i) { return "seed" + std::to_string(i) + ".hdf"; }

/// On one rank: every third face inside has a patch, and a patch has a number.
mesh::DistMesh with_faces_inside(mesh::DistMesh mesh) {
  auto& word = mesh::make_inner_patches(mesh);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int slot = 0; slot < 4; ++slot) {
      const auto next = mesh.cell_to_cell[at(c)][at(slot)];
      if (next < c || (c + slot) % 3 != 0) continue;
      const int there = mesh::slot_of(mesh.cell_to_cell[at(next)], c),
                patch = slot % static_cast<int>(mesh.info.patches.size());
      word[at(c)] = mesh::with_inner_patch(word[at(c)], slot, patch);
      word[at(next)] = mesh::with_inner_patch(word[at(next)], there, patch);
    }
  mesh.info.patches[0].number = 7;
  return mesh;
}

void write_seed_files(const par::Comm& comm, const std::filesystem::path& folder) {
  io::write_native(comm, folder / seed_name(0), with_faces_inside(test::mesh_with_fields(comm, 2, 1)),
                   {.provenance = "fuzz"});
  const auto family = test::closure_family(mesh::FamilyKind::face, 1);
  io::write_native(comm, folder / seed_name(1), assemble::assemble(comm, family));
  test::write_plain_vtkhdf(folder / seed_name(2), false);
  const auto chunked = folder / seed_name(3);
  test::write_plain_vtkhdf(chunked, true);
  test::create_group(chunked, "/PAMR");
  test::write_attribute(chunked, "/PAMR", "format", std::vector<std::int64_t>{1});
  test::create_group(chunked, "/PAMR/patches");
  test::write_texts(chunked, "/PAMR/patches/names", {"wall"});
  test::write_texts(chunked, "/PAMR/surfaces",
                    {"[[surface]]\nname = \"wall\"\nkind = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n"});
  // 1:2 on edge 3 and 1:4 on face 2
  test::write_dataset<std::uint64_t>(chunked, "/PAMR/lineage", {6}, {0x10d, 0x12d, 0x00a, 0x02a, 0x04a, 0x06a});
  const auto bare = folder / seed_name(4);
  test::write_plain_vtkhdf(bare, false);
  test::create_group(bare, "/PAMR");
  test::write_attribute(bare, "/PAMR", "format", std::vector<std::int64_t>{2});
  test::create_group(bare, "/PAMR/patches");
  test::write_texts(bare, "/PAMR/patches/names", {"inflow", "wall"});
  test::create_group(bare, "/PAMR/regions");
  test::write_dataset<std::int64_t>(bare, "/PAMR/regions/numbers", {2}, {1, 4});
  test::write_texts(bare, "/PAMR/regions/names", {"gas", "solid"});
  test::write_dataset<std::int64_t>(bare, "/PAMR/cell_to_cell", {6, 4}, {1, -1, 2, -2, 0, -1, 4, -2, 3, -1, 0, -2,
                                                                         2, -1, 5, -2, 5, -1, 1, -2, 4, -1, 3, -2});
  const auto base = mesh::Lineage::regular(0).red_child(6).red_child(1);
  std::vector<std::uint64_t> words;
  for (int child = 0; child < 2; ++child) words.push_back(base.closed(4, child).bits());
  for (int child = 0; child < 4; ++child) words.push_back(base.red_parent().closed(9, child).bits());
  test::write_dataset<std::uint64_t>(bare, "/PAMR/lineage", {6}, words);
  io::write_native(comm, folder / seed_name(7), test::mesh_with_level0(comm));
  for (const auto& [from, to] : {std::pair{0, 5}, std::pair{1, 6}, std::pair{7, 8}}) {
    std::filesystem::copy_file(folder / seed_name(from), folder / seed_name(to));
    test::remove_object(folder / seed_name(to), "/PAMR/checksums");
  }
  for (const int i : {0, 1, 2, 5, 6, 7, 8})
    read_file(comm, folder / seed_name(i));  // good ones; the families of the others are none
}

}  // namespace pamr::fuzz
