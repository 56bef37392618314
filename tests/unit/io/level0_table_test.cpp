// SPDX-License-Identifier: GPL-3.0-or-later
// The map of level 0 in the native file.
#include "pamr/io/native/level0_table.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/io/formats.hpp"
#include "pamr/io/native/native_file.hpp"
#include "support/error_of.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace level0_table_test {

using std::filesystem::path;
using test::Folder;
using testing::HasSubstr;

const std::string keys = "/VTKHDF/PointData/level0_key";
const std::string rows = "/VTKHDF/CellData/level0_cell";

std::string table(const char* dataset) { return std::string("/PAMR/level0/") + dataset; }

std::vector<std::string> names_of(const std::vector<mesh::Field>& fields) {
  std::vector<std::string> names;
  for (const auto& field : fields) names.push_back(field.name);
  return names;
}

TEST(Level0Table, TurnsEveryNumberOfACellIntoAWordOfItsOwn) {
  mesh::Level0Cell cell;
  std::int32_t next = 1;
  const auto vector = [&] {
    const double x = next++, y = next++, z = next++;
    return geometry::Vec3{x, y, z};
  };
  cell.row = 7;
  for (auto& node : cell.node) node = next++;
  for (auto& corner : cell.corner) corner = vector();
  for (auto& bulge : cell.bulge) bulge = vector();
  for (auto& patch : cell.face_patch) patch = -next++;
  for (auto& patches : cell.edge_patch)
    for (auto& patch : patches) patch = next++;
  for (auto& normal : cell.beside) normal = vector();
  for (auto* bits : {&cell.sharp_edges, &cell.creases, &cell.bent_corners}) *bits = static_cast<std::uint8_t>(next++);

  const auto words = io::words_of(cell);
  const auto back = io::level0_cell_of(7, words);

  EXPECT_EQ(static_cast<std::size_t>(next), io::n_level0_words + 1);
  for (const auto& column : io::level0_columns)
    for (auto w = column.first; w < column.first + column.width; ++w) {
      const auto value = mesh::is_integer(column.type) ? static_cast<double>(static_cast<std::int64_t>(words[w]))
                                                       : std::bit_cast<double>(words[w]);
      EXPECT_EQ(std::abs(value), static_cast<double>(w + 1)) << column.name;
    }
  EXPECT_EQ(io::words_of(back), words);
  EXPECT_EQ(back.row, 7);
  EXPECT_EQ(back.bulge, cell.bulge);
  EXPECT_EQ(back.edge_patch, cell.edge_patch);
  EXPECT_EQ(back.bent_corners, cell.bent_corners);
}

TEST(Level0Table, IsReadBackInBlocksAndGoesWhereItsCellsAre) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "a.hdf", test::mesh_with_level0(comm));

  auto block = io::read_native(comm, folder / "a.hdf");

  ASSERT_NE(block.info.level0, nullptr);
  EXPECT_EQ(block.info.level0->n_global_cells(), 3);
  const auto range = par::block_range(3, comm.rank(), comm.size());
  ASSERT_EQ(std::ssize(block.info.level0->cells()), range.count());
  for (auto row = range.begin; row < range.end; ++row) {
    const auto& cell = block.info.level0->cells()[static_cast<std::size_t>(row - range.begin)];
    EXPECT_EQ(cell.row, row);
    EXPECT_EQ(io::words_of(cell), io::words_of(test::level0_cell(row)));
  }

  const auto destination = test::random_destinations(comm, block, 3);
  const auto mesh = assemble::assemble(comm, std::move(block), destination);
  const auto& map = *mesh.info.level0;
  EXPECT_EQ(map.n_global_cells(), 3);
  for (const auto row : mesh.find_cell_field(mesh::level0_cell_field)->integer()) {
    if (row < 0) continue;
    ASSERT_GE(map.find(row), 0);
    EXPECT_EQ(io::words_of(map.cells()[static_cast<std::size_t>(map.find(row))]), io::words_of(test::level0_cell(row)));
  }
}

TEST(Level0Table, HasTheSameBytesOnAnyRanksAndWhenWrittenAgain) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const Folder folder(comm);

  io::write_native(comm, folder / "together.hdf", test::mesh_with_level0(comm));
  test::on_first_rank(
      comm, [&] { io::write_native(self, folder / "alone.hdf", test::mesh_with_level0(self), {.slab_bytes = 48}); });
  for (const bool build_surfaces : {true, false}) {
    const auto again = folder / (build_surfaces ? "again.hdf" : "without surfaces.hdf");
    const auto mesh = assemble::assemble(
        comm, io::read_native(comm, folder / "together.hdf", {.slab_bytes = 200, .build_surfaces = build_surfaces}));
    io::write_native(comm, again, mesh);
    EXPECT_EQ(test::bytes_of(folder / "together.hdf"), test::bytes_of(again));
  }

  EXPECT_EQ(test::bytes_of(folder / "together.hdf"), test::bytes_of(folder / "alone.hdf"));
  EXPECT_EQ(test::read_unsigned_attribute(folder / "together.hdf", "/PAMR", "format"), 3U);
}

TEST(Level0Table, IsNotInFilesOfMeshesWithoutMapNorInOlderFormats) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  auto mesh = test::mesh_with_level0(comm);
  std::string remarks;
  const auto remark = [&](const std::string& text) { remarks += text; };

  io::write_native(comm, folder / "old.hdf", mesh, {.format = 2, .remark = remark});
  mesh::drop_level0(mesh);
  std::string none;
  io::write_native(comm, folder / "without.hdf", mesh, {.remark = [&](const std::string& text) { none += text; }});

  EXPECT_THAT(remarks, HasSubstr("format 2 has no place for the map of level 0"));
  EXPECT_EQ(none, "");
  EXPECT_EQ(test::bytes_of(folder / "old.hdf"), test::bytes_of(folder / "without.hdf"));
  EXPECT_EQ(test::read_unsigned_attribute(folder / "old.hdf", "/PAMR", "format"), 2U);
  EXPECT_FALSE(test::has_object(folder / "old.hdf", "/PAMR/level0"));
  EXPECT_FALSE(test::has_object(folder / "old.hdf", keys));
  EXPECT_EQ(test::error_of_reading(comm, folder / "old.hdf"), "no error");
}

TEST(Level0Table, IsLeftOutWithARemarkWhereAPartIsMissing) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto file = folder / "a.hdf";
  for (const auto& [missing, words] : {std::pair<std::string, std::string>{"/PAMR/level0", "/PAMR/level0 is missing"},
                                       {keys, "'level0_key' of nodes and 'level0_cell' of cells are missing"},
                                       {rows, "'level0_key' of nodes and 'level0_cell' of cells are missing"}}) {
    io::write_native(comm, file, test::mesh_with_level0(comm));
    test::on_first_rank(comm, [&, gone = missing] { test::remove_object(file, gone); });

    std::string remarks;
    const auto block = io::read_native(comm, file, {.remark = [&](const std::string& text) { remarks += text; }});

    EXPECT_THAT(remarks, HasSubstr(words));
    EXPECT_EQ(block.info.level0, nullptr);
    EXPECT_THAT(names_of(block.node_fields), testing::UnorderedElementsAre("potential", "number"));
    EXPECT_THAT(names_of(block.cell_fields), testing::UnorderedElementsAre("refine", "stress", "région"));
    io::write_native(comm, folder / "b.hdf", assemble::assemble(comm, block));
    EXPECT_EQ(test::error_of_reading(comm, folder / "b.hdf"), "no error");
  }
}

TEST(Level0Table, IsNotInFilesOfOtherPrograms) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto mesh = test::mesh_with_level0(comm);

  for (const auto* name : {"a.vtu", "a.cgns"}) {
    io::write_mesh(comm, folder / name, mesh);

    const auto bytes = test::bytes_of(folder / name);
    EXPECT_THAT(bytes, HasSubstr("potential")) << name;
    EXPECT_THAT(bytes, testing::Not(HasSubstr("level0"))) << name;
  }
}

/// A way to spoil the map, and words that the error must contain.
struct Damage {
  const char* name;
  std::function<void(const path&)> make;
  std::vector<std::string> words;
};
void PrintTo(const Damage& damage, std::ostream* out) { *out << damage.name; }

template <class T>
std::function<void(const path&)> set(const std::string& dataset, std::size_t index, T value) {
  return [=](const path& file) { test::set_value<T>(file, dataset, index, value); };
}

/// Node 0 has no key, node 1 that of itself, node 2 that of the middle of 0 and 2.
std::vector<Damage> damaged_fields() {
  using Int = std::int64_t;
  return {
      {"KeyOfNodeBeyond", set<Int>(keys, 8, 27), {keys, "row 1", "weights that add up to 2^62", "found node 27"}},
      {"KeyNotAscending", set<Int>(keys, 17, 0), {keys, "row 2", "node 0 after 0"}},
      {"KeyWithAGap", set<Int>(keys, 18 + 1, 5), {keys, "row 2", "node 5 after -1"}},
      {"KeyWithoutItsFirstNode", set<Int>(keys, 1, 5), {keys, "row 0", "without its first node"}},
      {"KeyOfANodeBelow", set<Int>(keys, 8, -2), {keys, "row 1", "first node"}},
      {"WeightWithoutNode", set<Int>(keys, 17, -1), {keys, "row 2", "a weight without node"}},
      {"WeightZero", set<Int>(keys, 20, 0), {keys, "row 2", "weight 0"}},
      {"WeightNegative", set<Int>(keys, 20, -1), {keys, "row 2", "weight -1"}},
      {"WeightAboveOne", set<Int>(keys, 12, (Int{1} << 62U) + 1), {keys, "row 1", "weight 4611686018427387905"}},
      {"WeightsOfAnotherSum", set<Int>(keys, 12, 1), {keys, "row 1", "another sum"}},
      {"RowBeyond", set<Int>(rows, 4, 3), {rows, "row 4", "-1 or a row from 0 to 2", "found 3"}},
      {"RowBelow", set<Int>(rows, 47, -2), {rows, "row 47", "found -2"}},
      {"RowWithoutCell",
       [](const path& f) {
         auto values = test::read_dataset<Int>(f, rows);
         std::replace(values.begin(), values.end(), Int{2}, Int{1});
         test::write_dataset<Int>(f, rows, {48}, values);
       },
       {"/PAMR/level0, row 2", "cells that name this row in 'level0_cell', found none"}},
      {"KeysOfFour",
       [](const path& f) {
         test::write_dataset<Int>(f, keys, {27, 4}, std::vector<Int>(108, -1));
       },
       {keys, "expected 8 integers a row, found 4"}},
      {"RealRows",
       [](const path& f) { test::write_dataset<double>(f, rows, {48}, std::vector<double>(48, -1)); },
       {rows, "expected 1 integers a row", "float64"}},
  };
}

std::vector<Damage> damaged_tables() {
  using Int = std::int64_t;
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto corners = table("corners"), faces = table("face_patches"), edges = table("edge_patches");
  const auto points = table("points"), bulges = table("bulges"), beside = table("beside"), flags = table("flags");
  return {
      {"CornerBeyond", set<Int>(corners, 5, 27), {corners, "row 1", "nodes from 0 to 26", "found 27"}},
      {"CornerBelow", set<Int>(corners, 8, -1), {corners, "row 2", "found -1"}},
      {"CornerTwice", set<Int>(corners, 0, 1), {corners, "row 0", "four different nodes", "node 1 twice"}},
      {"PointNotFinite", set<double>(points, 13, nan), {points, "row 1", "finite"}},
      {"PointsInAnotherOrder", set<double>(points, 0, 5.0), {points, "row 0", "in the order of their coordinates"}},
      {"BulgeNotFinite", set<double>(bulges, 53, infinity), {bulges, "row 2", "finite"}},
      {"FacePatchBeyond", set<Int>(faces, 4, 6), {faces, "row 1", "patches from -1 to 5", "found 6"}},
      {"FacePatchBeyond32Bits", set<Int>(faces, 4, (Int{1} << 32U) + 1), {faces, "found 4294967297"}},
      {"FacePatchWithoutSurface", set<Int>(faces, 0, 0), {faces, "row 0", "patch 0 without"}},
      {"EdgePatchBelow", set<Int>(edges, 12, -2), {edges, "row 1", "found -2"}},
      {"EdgeWithOnePatch",
       set<Int>(edges, 0, -1),
       {edges, "row 0", "one twice, or two in ascending order", "-1 and 1"}},
      {"EdgePatchesDescend", set<Int>(edges, 2, 2), {edges, "row 0", "ascending order, found 2 and 1"}},
      {"EdgePatchesWithoutSurface", set<Int>(edges, 3, 0), {edges, "row 0", "0 and 0 without"}},
      {"NormalNotFinite", set<double>(beside, 0, nan), {beside, "row 0", "finite"}},
      {"SharpEdgeWithoutNormal", set<double>(beside, 5, 0.0), {beside, "row 0", "none at edge 1"}},
      {"UnknownBits", set<Int>(flags, 0, 64), {flags, "row 0", "bits from 0 to 63", "found 64"}},
      {"CreaseInNoWall", set<Int>(flags, 4, 4), {flags, "row 1", "edge 2 in none"}},
      {"SharpEdgeInNoWall", set<Int>(flags, 6, 8), {flags, "row 2", "edge 3 in none"}},
      {"NoBentCorner", set<Int>(flags, 2, 0), {flags, "row 0", "bent corners from 1 to 15, found 0"}},
      {"TooManyCorners", set<Int>(flags, 2, 16), {flags, "row 0", "found 16"}},
      {"WrongWidth",
       [=](const path& f) {
         test::write_dataset<double>(f, bulges, {3, 17}, std::vector<double>(51, 0));
       },
       {bulges, "expected shape 3 x 18, found 3 x 17"}},
      {"WrongLength",
       [=](const path& f) {
         test::write_dataset<Int>(f, corners, {2, 4}, {0, 1, 2, 3, 4, 5, 6, 7});
       },
       {points, "expected shape 2 x 12, found 3 x 12"}},
      {"NoRows",
       [=](const path& f) {
         test::write_dataset<Int>(f, corners, {0, 4}, {});
       },
       {corners, "1 to 48 rows"}},
      {"RealFlags",
       [=](const path& f) {
         test::write_dataset<double>(f, flags, {3, 3}, std::vector<double>(9, 1));
       },
       {flags, "expected integers"}},
      {"OneDatasetMissing",
       [=](const path& f) { test::remove_object(f, beside); },
       {beside, "expected this dataset, found none"}},
      {"FlippedBulge",
       [=](const path& f) { test::flip_byte(f, test::extent_of(f, bulges).offset + 30); },
       {bulges, "checksum"}},
  };
}

class BadLevel0Table : public testing::TestWithParam<Damage> {};
INSTANTIATE_TEST_SUITE_P(Fields, BadLevel0Table, testing::ValuesIn(damaged_fields()),
                         [](const auto& damage) { return damage.param.name; });
INSTANTIATE_TEST_SUITE_P(Tables, BadLevel0Table, testing::ValuesIn(damaged_tables()),
                         [](const auto& damage) { return damage.param.name; });

TEST_P(BadLevel0Table, IsRefusedOnEveryRankWithTheSameWords) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "bad.hdf", test::mesh_with_level0(comm));
  test::on_first_rank(comm, [&] { GetParam().make(folder / "bad.hdf"); });

  const auto error = test::error_of_reading(comm, folder / "bad.hdf");

  EXPECT_THAT(error, HasSubstr("bad.hdf'"));
  for (const auto& word : GetParam().words) EXPECT_THAT(error, HasSubstr(word));
  EXPECT_EQ(error, comm.broadcast(error));
}

}  // namespace level0_table_test
}  // namespace pamr
