// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/native_file.hpp"

#include <gmock/gmock.h>
#include <pthread.h>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace native_file_test {

using test::Folder;

void expect_same(const mesh::Field& a, const mesh::Field& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_EQ(a.n_components, b.n_components);
  EXPECT_EQ(a.storage, b.storage);
  EXPECT_EQ(a.value, b.value) << a.name;
}

std::vector<mesh::Field> by_name(std::vector<mesh::Field> fields) {
  std::sort(fields.begin(), fields.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return fields;
}

/// Both whole on every rank.
void expect_same(const mesh::BlockMesh& a, const mesh::BlockMesh& b) {
  EXPECT_EQ(a.info.n_global_nodes, b.info.n_global_nodes);
  EXPECT_EQ(a.info.n_global_cells, b.info.n_global_cells);
  EXPECT_EQ(a.info.patches, b.info.patches);
  EXPECT_EQ(a.info.regions, b.info.regions);
  EXPECT_EQ(a.info.surfaces->toml, b.info.surfaces->toml);
  EXPECT_EQ(a.info.surfaces->name, b.info.surfaces->name);
  EXPECT_EQ(a.info.length_unit, b.info.length_unit);
  EXPECT_EQ(a.node_position, b.node_position);
  EXPECT_EQ(a.cell_to_node, b.cell_to_node);
  EXPECT_EQ(a.cell_to_cell, b.cell_to_cell);
  EXPECT_EQ(a.lineage, b.lineage);
  ASSERT_EQ(a.cell_fields.size(), b.cell_fields.size());
  ASSERT_EQ(a.node_fields.size(), b.node_fields.size());
  for (std::size_t f = 0; f < a.cell_fields.size(); ++f) expect_same(a.cell_fields[f], b.cell_fields[f]);
  for (std::size_t f = 0; f < a.node_fields.size(); ++f) expect_same(a.node_fields[f], b.node_fields[f]);
}

TEST(NativeFile, ReadsBackEveryBitOfAMeshOnRandomRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto mesh = test::mesh_with_fields(comm, 3, 1);

  io::write_native(comm, folder / "a.hdf", mesh, {.provenance = "made by a test"});
  const auto read = io::read_native(comm, folder / "a.hdf");

  auto expected = test::gather(comm, mesh);
  expected.cell_fields = by_name(expected.cell_fields);
  expected.node_fields = by_name(expected.node_fields);
  expect_same(test::gather(comm, read), expected);
  EXPECT_EQ(read.info.provenance, "made by a test");
  EXPECT_EQ(folder.n_entries(), 1U);
}

TEST(NativeFile, KeepsPatchesInsideAndNumbersOfPatches) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  auto block = test::kuhn_cube(comm, 2);
  block.cell_to_cell.clear();
  block.boundary = {};
  if (comm.is_first()) block.boundary = {{{0, 1, 13}}, {4}};  // inside the first cube
  for (std::size_t p = 0; p < block.info.patches.size(); ++p)
    block.info.patches[p].number = p == 2 ? -1 : 40 - std::int64_t(p);
  const auto mesh = assemble::assemble(comm, std::move(block));
  ASSERT_EQ(mesh::count_inner_faces(comm, mesh)[4], 1);

  io::write_native(comm, folder / "a.hdf", mesh);
  const auto read = assemble::assemble(comm, io::read_native(comm, folder / "a.hdf"));

  EXPECT_EQ(read.info.patches, mesh.info.patches);
  EXPECT_EQ(mesh::fingerprint(comm, read), mesh::fingerprint(comm, mesh));
  EXPECT_EQ(mesh::count_inner_faces(comm, read), mesh::count_inner_faces(comm, mesh));
  EXPECT_THROW(io::write_native(comm, folder / "b.hdf", mesh, {.format = 3}), Error);
}

TEST(NativeFile, ReadsTheSameInSmallPieces) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto mesh = test::mesh_with_fields(comm, 3, 2);

  io::write_native(comm, folder / "whole.hdf", mesh);
  io::write_native(comm, folder / "pieces.hdf", mesh, {.provenance = "", .slab_bytes = 200});
  const auto whole = io::read_native(comm, folder / "whole.hdf");
  const auto pieces = io::read_native(comm, folder / "whole.hdf", {.verify_checksums = true, .slab_bytes = 200});

  EXPECT_EQ(test::bytes_of(folder / "whole.hdf"), test::bytes_of(folder / "pieces.hdf"));
  expect_same(test::gather(comm, pieces), test::gather(comm, whole));
}

TEST(NativeFile, IsReadInRunsThatBeginWhereToldOrAtTheNextFamily) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 4));
  io::write_native(comm, folder / "a.hdf", mesh);
  const GlobalId first = comm.rank() == 0 ? 0 : 384 - 2 * (comm.size() - comm.rank());

  io::NativeFile file(comm, folder / "a.hdf"), in_pieces(comm, folder / "a.hdf", {.slab_bytes = 200});
  const auto block = file.read(first), pieces = in_pieces.read(first), even = file.read();

  EXPECT_EQ(block.first_cell, first);
  EXPECT_EQ(pieces.first_cell, first);
  EXPECT_EQ(std::ssize(block.cell_to_node), comm.is_first() && comm.size() > 1 ? 384 - 2 * (comm.size() - 1)
                                            : comm.size() > 1                  ? 2
                                                                               : 384);
  EXPECT_EQ(pieces.cell_to_node, block.cell_to_node);
  expect_same(test::gather(comm, block), test::gather(comm, even));
}

TEST(NativeFile, GivesSingleFieldsOfIntegersAndLeavesOneOut) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 2));
  std::vector<std::int64_t> twice;
  for (const auto id : mesh.cell_global) twice.push_back(2 * id);
  mesh.cell_fields = {{"twice", "", 1, mesh::StorageType::int32, twice},
                      {"pair", "", 2, mesh::StorageType::int8, std::vector<std::int64_t>(2 * twice.size(), 1)},
                      {"real", "", 1, mesh::StorageType::float64, std::vector<double>(twice.size(), 1)}};
  io::write_native(comm, folder / "a.hdf", mesh);

  io::NativeFile file(comm, folder / "a.hdf");
  const auto values = file.read_integers("twice", io::NativeFile::Checked::checksum);
  const auto cells = file.read_cell_to_node();
  const auto block = file.read({}, "twice");

  EXPECT_EQ(file.info().n_global_cells, 48);
  for (const auto* name : {"pair", "real", "none"}) EXPECT_FALSE(file.has_integers(name)) << name;
  const auto range = par::block_range(48, comm.rank(), comm.size());
  ASSERT_EQ(std::ssize(values), range.count());
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], 2 * (range.begin + std::int64_t(i)));
  EXPECT_EQ(cells, block.cell_to_node);
  ASSERT_EQ(block.cell_fields.size(), 2U);
  EXPECT_EQ(block.cell_fields[0].name, "pair");
}

TEST(NativeFile, HasTheSameBytesOnAnyNumberOfRanksAndAnyPartition) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  MPI_Comm self_handle = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, comm.rank(), 0, &self_handle);
  const auto own = folder / ("alone" + std::to_string(comm.rank()) + ".hdf");

  io::write_native(comm, folder / "together.hdf", test::mesh_with_fields(comm, 3, 3));
  {
    const par::Comm self(self_handle);
    io::write_native(self, own, test::mesh_with_fields(self, 3, 3));
  }

  EXPECT_EQ(test::bytes_of(folder / "together.hdf"), test::bytes_of(own));
  comm.barrier();
  MPI_Comm_free(&self_handle);
}

TEST(NativeFile, WritesWhatItRead) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "first.hdf", test::mesh_with_fields(comm, 2, 4), {.provenance = "first"});

  io::write_native(comm, folder / "second.hdf", assemble::assemble(comm, io::read_native(comm, folder / "first.hdf")));

  EXPECT_EQ(test::bytes_of(folder / "first.hdf"), test::bytes_of(folder / "second.hdf"));
}

TEST(NativeFile, StatesTheFingerprintOfTheMesh) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto mesh = test::mesh_with_fields(comm, 2, 8);

  io::write_native(comm, folder / "a.hdf", mesh);

  const auto expected = mesh::fingerprint(comm, mesh);
  if (comm.is_first()) {
    EXPECT_EQ(test::read_unsigned_attribute(folder / "a.hdf", "/PAMR", "fingerprint"), expected);
  }
}

TEST(NativeFile, ReplacesAnExistingFile) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);

  io::write_native(comm, folder / "a.hdf", test::mesh_with_fields(comm, 3, 5));
  io::write_native(comm, folder / "a.hdf", assemble::assemble(comm, assemble::kuhn_cube(comm, 1)));

  EXPECT_EQ(io::read_native(comm, folder / "a.hdf").info.n_global_cells, 6);
  EXPECT_EQ(folder.n_entries(), 1U);
}

TEST(NativeFile, GivesEachRankWholeFamilies) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "a.hdf", assemble::assemble(comm, assemble::kuhn_cube(comm, 2)));
  using enum mesh::FamilyKind;
  std::vector<std::uint64_t> words;
  for (int k = 0; k < 5; ++k) {
    for (int child = 0; child < 4; ++child) words.push_back(mesh::Lineage(face, 2, child, 1).bits());
    for (int child = 0; child < 2; ++child) words.push_back(mesh::Lineage(edge, 5, child, 0).bits());
    words.push_back(mesh::Lineage(face, 3, 1, 1).broken().bits());
    for (int child = 0; child < 2; ++child) words.push_back(mesh::Lineage(edge, 0, child, 3).bits());
  }
  words.resize(48, mesh::Lineage(regular, 0, 0, 2).bits());
  test::on_first_rank(comm, [&] { test::write_dataset(folder / "a.hdf", "/PAMR/lineage", {48}, words); });

  const auto block = io::read_native(comm, folder / "a.hdf");

  ASSERT_FALSE(block.lineage.empty());
  EXPECT_TRUE(block.lineage.front().child() == 0 || !block.lineage.front().is_removable());
  EXPECT_EQ(comm.sum(static_cast<std::int64_t>(block.lineage.size())), 48);
  for (std::size_t c = 0; c < block.lineage.size(); ++c)
    EXPECT_EQ(block.lineage[c].bits(), words[static_cast<std::size_t>(block.first_cell) + c]);
}

TEST(NativeFile, ReadsAFamilyOnMoreRanksThanItHasCells) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto whole = test::closure_family(mesh::FamilyKind::edge, 3);
  std::vector<GlobalId> begin(static_cast<std::size_t>(comm.size()), 2);
  begin[0] = 0;
  const auto mesh = assemble::assemble(comm, test::cut(comm, whole, begin));

  io::write_native(comm, folder / "family.hdf", mesh);
  const auto block = io::read_native(comm, folder / "family.hdf");

  EXPECT_EQ(block.cell_to_node.size(), comm.is_first() ? 2U : 0U);
  EXPECT_EQ(test::gather(comm, block).cell_to_node, whole.cell_to_node);
}

TEST(NativeFile, AcceptsAFileWithNothingButTheVtkPart) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  for (const bool chunked : {false, true}) {
    test::on_first_rank(comm, [&] { test::write_plain_vtkhdf(folder / "plain.hdf", chunked); });

    const auto block = io::read_native(comm, folder / "plain.hdf");

    const auto whole = test::gather(comm, block);
    EXPECT_TRUE(whole.cell_to_cell.empty());
    EXPECT_TRUE(whole.lineage.empty());
    ASSERT_EQ(whole.info.patches.size(), 1U);
    EXPECT_EQ(whole.info.patches[0].name, "boundary");
    EXPECT_EQ(whole.node_position[5], (geometry::Vec3{1, 0, 1}));
    EXPECT_THAT(whole.cell_to_node[3], testing::ElementsAre(0, 2, 6, 7));
    ASSERT_EQ(whole.cell_fields.size(), 1U);
    EXPECT_THAT(whole.cell_fields[0].integer(), testing::ElementsAre(0, 1, 0, -1, 0, 5));
    ASSERT_EQ(whole.node_fields.size(), 1U);
    EXPECT_EQ(whole.node_fields[0].n_components, 2);
    EXPECT_EQ(whole.node_fields[0].real()[15], 15.0);
    EXPECT_EQ(assemble::assemble(comm, block).info.n_global_cells, 6);
  }
}

TEST(NativeFile, AcceptsFieldsAndTextsThatAScriptAdded) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "a.hdf", assemble::assemble(comm, assemble::kuhn_cube(comm, 1)));
  test::on_first_rank(comm, [&] {
    test::write_dataset<std::int32_t>(folder / "a.hdf", "/VTKHDF/CellData/refine", {6}, {0, 1, 0, 1, 0, 1});
    test::write_attribute(folder / "a.hdf", "/VTKHDF/CellData/refine", "unit", std::string("1"));
    test::write_texts(folder / "a.hdf", "/PAMR/patches/names", {"a", "b", "c", "d", "größer", "f"});
  });

  const auto block = io::read_native(comm, folder / "a.hdf");

  const auto whole = test::gather(comm, block);
  ASSERT_EQ(whole.cell_fields.size(), 1U);
  EXPECT_EQ(whole.cell_fields[0].storage, mesh::StorageType::int32);
  EXPECT_EQ(whole.cell_fields[0].unit, "1");
  EXPECT_THAT(whole.cell_fields[0].integer(), testing::ElementsAre(0, 1, 0, 1, 0, 1));
  EXPECT_EQ(block.info.patches[4].name, "größer");
  EXPECT_EQ(block.info.patches[4].kind, assemble::kuhn_cube(comm, 1).info.patches[4].kind);
}

TEST(NativeFile, KeepsSurfacesThatAreNotBuilt) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "a.hdf", test::mesh_with_fields(comm, 2, 1));

  auto block = io::read_native(comm, folder / "a.hdf", {.build_surfaces = false});

  EXPECT_EQ(block.info.surface_name(block.info.patches[1]), "ball");
  EXPECT_EQ(block.info.surface_of(1), nullptr);
  io::write_native(comm, folder / "b.hdf", assemble::assemble(comm, std::move(block)));
  EXPECT_EQ(test::bytes_of(folder / "a.hdf"), test::bytes_of(folder / "b.hdf"));
}

int n_forks = 0;

TEST(NativeFile, IsReadWithoutAFork) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  test::on_first_rank(comm, [&] {
    test::write_plain_vtkhdf(folder / "contiguous.hdf", false);
    test::write_plain_vtkhdf(folder / "chunked.hdf", true);
  });
  ASSERT_EQ(pthread_atfork([] { ++n_forks; }, nullptr, nullptr), 0);
  const auto before = n_forks;

  const auto contiguous = io::read_native(comm, folder / "contiguous.hdf");
  const auto chunked = io::read_native(comm, folder / "chunked.hdf");

  EXPECT_EQ(n_forks, before);
  EXPECT_EQ(chunked.cell_to_node, contiguous.cell_to_node);
  EXPECT_EQ(chunked.node_position, contiguous.node_position);
}

TEST(NativeFile, RefusesADamagedCompressedChunk) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  test::on_first_rank(comm, [&] {
    test::write_plain_vtkhdf(folder / "a.hdf", true);
    const auto chunk = test::first_chunk_of(folder / "a.hdf", "/VTKHDF/Points");
    for (std::uint64_t i = 0; i < chunk.bytes; ++i) test::flip_byte(folder / "a.hdf", chunk.offset + i);
  });

  const auto error = test::error_of_reading(comm, folder / "a.hdf");

  EXPECT_THAT(error, testing::AllOf(testing::HasSubstr("/VTKHDF/Points"), testing::HasSubstr("sound chunks")));
}

}  // namespace native_file_test
}  // namespace pamr
