// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <limits>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/io/native/native_file.hpp"

namespace pamr {
namespace bad_file_test {

using std::filesystem::path;
using test::Folder;

constexpr auto largest = std::numeric_limits<std::int64_t>::max();

/// A way to spoil a file, and words that the error must contain.
struct Damage {
  const char* name;
  std::function<void(const path&)> make;
  std::vector<std::string> words;
};

void PrintTo(const Damage& damage, std::ostream* out) { *out << damage.name; }

/// Contents of a good file, the same for every damage: a Kuhn cube of 8 cubes (27 nodes, 48 cells, 6 patches) with the
/// cell field `u`.
const std::string& good_file(const par::Comm& comm, const Folder& folder) {
  static std::string contents;
  if (!contents.empty()) return contents;
  auto block = assemble::kuhn_cube(comm, 2);
  block.cell_fields.push_back(
      {"u", "K", 1, mesh::StorageType::float64, std::vector<double>(block.cell_to_node.size())});
  io::write_native(comm, folder / "good.hdf", assemble::assemble(comm, block));
  EXPECT_EQ(test::error_of_reading(comm, folder / "good.hdf"), "no error");
  return contents = test::bytes_of(folder / "good.hdf");
}

class BadFile : public testing::TestWithParam<Damage> {};

TEST_P(BadFile, IsRefusedOnEveryRankWithTheSameWords) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto file = folder / "bad.hdf";
  const auto& good = good_file(comm, folder);
  test::on_first_rank(comm, [&] {
    std::ofstream(file, std::ios::binary) << good;
    GetParam().make(file);
  });

  const auto error = test::error_of_reading(comm, file);

  EXPECT_THAT(error, testing::HasSubstr("bad.hdf'"));
  for (const auto& word : GetParam().words) EXPECT_THAT(error, testing::HasSubstr(word));
  EXPECT_EQ(error, comm.broadcast(error));
}

const double nan_value = std::numeric_limits<double>::quiet_NaN();
const double infinity = std::numeric_limits<double>::infinity();

void shorten(const path& file, double fraction) {
  std::filesystem::resize_file(
      file, static_cast<std::uintmax_t>(fraction * static_cast<double>(std::filesystem::file_size(file))));
}

std::vector<Damage> damages_of_the_file() {
  return {
      {"Missing", [](const path& f) { std::filesystem::remove(f); }, {"expected a file, found none"}},
      {"Folder",
       [](const path& f) {
         std::filesystem::remove(f);
         std::filesystem::create_directory(f);
       },
       {"found a folder"}},
      {"Empty", [](const path& f) { shorten(f, 0); }, {"expected an HDF5 file"}},
      {"NotHdf5", [](const path& f) { std::ofstream(f) << std::string(4096, 'x'); }, {"expected an HDF5 file"}},
      {"SignatureOnly", [](const path& f) { std::filesystem::resize_file(f, 8); }, {"expected a complete HDF5 file"}},
      {"TruncatedEarly", [](const path& f) { shorten(f, 0.1); }, {"expected a complete HDF5 file"}},
      {"TruncatedHalf", [](const path& f) { shorten(f, 0.5); }, {"expected a complete HDF5 file"}},
      {"TruncatedByOneByte",
       [](const path& f) { std::filesystem::resize_file(f, std::filesystem::file_size(f) - 1); },
       {"expected a complete HDF5 file"}},
      {"OtherHdf5", [](const path& f) { test::create_file(f); }, {"/VTKHDF", "found none"}},
  };
}

std::vector<Damage> damages_of_the_structure() {
  using namespace test;
  return {
      {"NoVersion",
       [](const path& f) { remove_attribute(f, "/VTKHDF", "Version"); },
       {"@Version", "expected 1.x or 2.x"}},
      {"LaterVersion",
       [](const path& f) {
         write_attribute(f, "/VTKHDF", "Version", std::vector<std::int64_t>{3, 0});
       },
       {"@Version", "found 3.0"}},
      {"NoType", [](const path& f) { remove_attribute(f, "/VTKHDF", "Type"); }, {"@Type", "UnstructuredGrid"}},
      {"OtherType", [](const path& f) { write_attribute(f, "/VTKHDF", "Type", std::string("ImageData")); }, {"@Type"}},
      {"SeveralPieces",
       [](const path& f) {
         write_dataset<std::int64_t>(f, "/VTKHDF/NumberOfCells", {2}, {24, 24});
       },
       {"NumberOfCells", "expected 1 piece, found 2"}},
      {"NoCells",
       [](const path& f) { write_dataset<std::int64_t>(f, "/VTKHDF/NumberOfCells", {1}, {0}); },
       {"NumberOfCells", "found 0"}},
      {"NegativeNumberOfCells",
       [](const path& f) { write_dataset<std::int64_t>(f, "/VTKHDF/NumberOfCells", {1}, {-1}); },
       {"NumberOfCells", "found -1"}},
      {"HugeNumberOfPoints",
       [](const path& f) { write_dataset<std::int64_t>(f, "/VTKHDF/NumberOfPoints", {1}, {largest}); },
       {"NumberOfPoints", std::to_string(largest)}},
      {"WrongNumberOfPoints",
       [](const path& f) { write_dataset<std::int64_t>(f, "/VTKHDF/NumberOfPoints", {1}, {28}); },
       {"Points", "expected shape 28 x 3, found 27 x 3"}},
      {"NumberOfCellsIsReal",
       [](const path& f) { write_dataset<double>(f, "/VTKHDF/NumberOfCells", {1}, {48}); },
       {"NumberOfCells", "integers"}},
      {"WrongNumberOfConnectivityIds",
       [](const path& f) { write_dataset<std::int64_t>(f, "/VTKHDF/NumberOfConnectivityIds", {1}, {191}); },
       {"expected 192", "found 191"}},
      {"NoPoints", [](const path& f) { remove_object(f, "/VTKHDF/Points"); }, {"/VTKHDF/Points", "found none"}},
      {"FlatPoints",
       [](const path& f) { write_dataset<double>(f, "/VTKHDF/Points", {81}, std::vector<double>(81)); },
       {"/VTKHDF/Points", "expected shape 27 x 3, found 81"}},
      {"IntegerPoints",
       [](const path& f) {
         write_dataset<std::int64_t>(f, "/VTKHDF/Points", {27, 3}, std::vector<std::int64_t>(81));
       },
       {"/VTKHDF/Points", "found int64"}},
      {"RealConnectivity",
       [](const path& f) { write_dataset<double>(f, "/VTKHDF/Connectivity", {192}, std::vector<double>(192)); },
       {"/VTKHDF/Connectivity", "found float64"}},
      {"ShortConnectivity",
       [](const path& f) {
         write_dataset<std::int64_t>(f, "/VTKHDF/Connectivity", {191}, std::vector<std::int64_t>(191));
       },
       {"/VTKHDF/Connectivity", "expected shape 192, found 191"}},
      {"ThreeDimensions",
       [](const path& f) {
         write_dataset<double>(f, "/VTKHDF/CellData/u", {48, 1, 1}, std::vector<double>(48));
       },
       {"/VTKHDF/CellData/u", "1 or 2 dimensions, found 3"}},
      {"ScalarField", [](const path& f) { write_dataset<double>(f, "/VTKHDF/CellData/u", {}, {1.0}); }, {"found 0"}},
      {"ShortField",
       [](const path& f) { write_dataset<double>(f, "/VTKHDF/CellData/u", {47}, std::vector<double>(47)); },
       {"/VTKHDF/CellData/u", "expected 48 rows, found 47"}},
      {"FieldWithoutComponents",
       [](const path& f) {
         write_dataset<double>(f, "/VTKHDF/CellData/u", {48, 0}, {});
       },
       {"/VTKHDF/CellData/u", "components"}},
      {"TextPoints",
       [](const path& f) { write_texts(f, "/VTKHDF/Points", std::vector<std::string>(27, "x")); },
       {"/VTKHDF/Points", "expected numbers", "found text"}},
      {"GroupAsField", [](const path& f) { create_group(f, "/VTKHDF/CellData/v"); }, {"/VTKHDF/CellData/v"}},
      {"SoftLink",
       [](const path& f) { make_soft_link(f, "/VTKHDF/CellData/u", "/VTKHDF/CellData/w"); },
       {"/VTKHDF/CellData/w", "soft or external link"}},
      {"CellDataIsADataset",
       [](const path& f) {
         remove_object(f, "/VTKHDF/CellData");
         write_dataset<double>(f, "/VTKHDF/CellData", {1}, {0});
       },
       {"/VTKHDF/CellData", "expected a group"}},
  };
}

std::vector<Damage> damages_of_the_mesh() {
  using namespace test;
  const auto node = [](std::int64_t value) {
    return [value](const path& f) { set_value<std::int64_t>(f, "/VTKHDF/Connectivity", 101, value); };
  };
  const auto coordinate = [](double value) {
    return [value](const path& f) { set_value<double>(f, "/VTKHDF/Points", 40, value); };
  };
  return {
      {"NanCoordinate", coordinate(nan_value), {"/VTKHDF/Points, row 13", "finite"}},
      {"InfiniteCoordinate", coordinate(-infinity), {"/VTKHDF/Points, row 13", "finite"}},
      {"NegativeNode", node(-1), {"/VTKHDF/Connectivity, row 101", "found -1"}},
      {"NodeJustBeyond", node(27), {"/VTKHDF/Connectivity, row 101", "from 0 to 26, found 27"}},
      {"Node2To31", node(std::int64_t{1} << 31U), {"/VTKHDF/Connectivity, row 101", "found 2147483648"}},
      {"Node2To63", node(std::numeric_limits<std::int64_t>::min()), {"/VTKHDF/Connectivity, row 101"}},
      {"UnsignedNode2To63",
       [](const path& f) {
         auto ids = read_dataset<std::uint64_t>(f, "/VTKHDF/Connectivity");
         ids[101] = std::uint64_t{1} << 63U;
         write_dataset(f, "/VTKHDF/Connectivity", {192}, ids);
       },
       {"/VTKHDF/Connectivity, row 101", "below 2^63, found 9223372036854775808"}},
      {"SameNodeTwice",
       [](const path& f) {
         const auto ids = read_dataset<std::int64_t>(f, "/VTKHDF/Connectivity");
         set_value<std::int64_t>(f, "/VTKHDF/Connectivity", 103, ids[101]);
       },
       {"/VTKHDF/Connectivity, row 100", "four different nodes"}},
      {"Hexahedron",
       [](const path& f) { set_value<std::uint8_t>(f, "/VTKHDF/Types", 30, 12); },
       {"/VTKHDF/Types, row 30", "tetrahedron", "found 12"}},
      {"OffsetOffByOne",
       [](const path& f) { set_value<std::int64_t>(f, "/VTKHDF/Offsets", 30, 121); },
       {"/VTKHDF/Offsets, row 30", "expected 120, found 121"}},
      {"LastOffsetWrong",
       [](const path& f) { set_value<std::int64_t>(f, "/VTKHDF/Offsets", 48, 191); },
       {"/VTKHDF/Offsets, row 48", "expected 192, found 191"}},
      {"PatchTooLarge",
       [](const path& f) { set_value<std::int64_t>(f, "/PAMR/cell_to_cell", 81, -7); },
       {"/PAMR/cell_to_cell, row 20", "-1 to -6", "found -7"}},
      {"NeighborTooLarge",
       [](const path& f) { set_value<std::int64_t>(f, "/PAMR/cell_to_cell", 81, 48); },
       {"/PAMR/cell_to_cell, row 20", "found 48"}},
      {"OwnNeighbor",
       [](const path& f) { set_value<std::int64_t>(f, "/PAMR/cell_to_cell", 81, 20); },
       {"/PAMR/cell_to_cell, row 20", "the cell itself"}},
      {"NarrowNeighbors",
       [](const path& f) {
         write_dataset<std::int64_t>(f, "/PAMR/cell_to_cell", {64, 3}, std::vector<std::int64_t>(192));
       },
       {"/PAMR/cell_to_cell", "expected shape 48 x 4, found 64 x 3"}},
      {"NoNeighborsButPatches",
       [](const path& f) { remove_object(f, "/PAMR/cell_to_cell"); },
       {"/PAMR/cell_to_cell", "6 patches"}},
  };
}

std::vector<Damage> damages_of_the_extension() {
  using namespace test;
  const auto lineage = [](std::size_t cell, mesh::Lineage value) {
    return [cell, value](const path& f) { set_value<std::uint64_t>(f, "/PAMR/lineage", cell, value.bits()); };
  };
  const auto word = [](std::size_t cell, std::uint64_t value) {
    return [cell, value](const path& f) { set_value<std::uint64_t>(f, "/PAMR/lineage", cell, value); };
  };
  const auto word_of_format_1 = [word](std::size_t cell, std::uint64_t value) {
    return [change = word(cell, value)](const path& f) {
      write_attribute(f, "/PAMR", "format", std::vector<std::int64_t>{1});
      change(f);
    };
  };
  using enum mesh::FamilyKind;
  const auto regions = [](std::vector<std::int64_t> numbers, std::vector<std::string> names) {
    return [numbers, names](const path& f) {
      create_group(f, "/PAMR/regions");
      write_dataset<std::int64_t>(f, "/PAMR/regions/numbers", {numbers.size()}, numbers);
      if (!names.empty()) write_texts(f, "/PAMR/regions/names", names);
    };
  };
  return {
      {"InnerPatchIsReal",
       [](const path& f) { write_dataset<double>(f, "/VTKHDF/CellData/inner_patch", {48}, std::vector<double>(48)); },
       {"inner_patch", "one integer a row"}},
      {"InnerPatchBeyond",
       [](const path& f) {
         write_dataset<std::int64_t>(f, "/VTKHDF/CellData/inner_patch", {48}, std::vector<std::int64_t>(48, 7));
       },
       {"field 'inner_patch'", "from 0 to 5, found 6"}},
      {"PatchNumbersTooFew",
       [](const path& f) {
         write_dataset<std::int64_t>(f, "/PAMR/patches/numbers", {2}, {1, 2});
       },
       {"patches/numbers", "expected 6 numbers", "found 2"}},
      {"PatchConditionsTooMany",
       [](const path& f) {
         write_dataset<std::int64_t>(f, "/PAMR/patches/conditions", {7}, {1, 2, 3, 4, 5, 6, 7});
       },
       {"patches/conditions", "expected 6 numbers", "found 7"}},
      {"PatchGroupsTooFew",
       [](const path& f) {
         write_texts(f, "/PAMR/patches/groups", {"", "7 4 wing 9 5 upper"});
       },
       {"patches/groups", "expected 6 texts", "found 2"}},
      {"PatchGroupsWithoutLength",
       [](const path& f) {
         write_texts(f, "/PAMR/patches/groups", {"", "", "7 wing", "", "", ""});
       },
       {"patches/groups", "number, length and name", "row 2"}},
      {"PatchGroupNameIsTooShort",
       [](const path& f) {
         write_texts(f, "/PAMR/patches/groups", {"7 4 wing 9 50 upper", "", "", "", "", ""});
       },
       {"patches/groups", "number, length and name", "row 0"}},
      {"RegionsWithoutNames", regions({1}, {}), {"/PAMR/regions/names", "a dataset"}},
      {"MoreRegionsThanNames", regions({1, 2}, {"gas"}), {"/PAMR/regions/names", "2 texts", "found 1"}},
      {"RegionTwice", regions({2, 2}, {"gas", "solid"}), {"/PAMR/regions/numbers", "ascending", "2 after 2"}},
      {"RegionWithoutName", regions({2, 3}, {"gas", ""}), {"/PAMR/regions/names", "row 1"}},
      {"RegionNameIsNotUtf8", regions({2}, {"g\xff"}), {"/PAMR/regions/names", "UTF-8"}},
      {"RegionNumbersAreReal",
       [](const path& f) {
         create_group(f, "/PAMR/regions");
         write_dataset<double>(f, "/PAMR/regions/numbers", {1}, {1.0});
       },
       {"/PAMR/regions/numbers", "integers"}},
      {"TooManyRegions",
       regions(std::vector<std::int64_t>(4097), std::vector<std::string>(4097)),
       {"/PAMR/regions/numbers", "4097 values"}},
      {"UnknownStateOfFamily", word(7, 2047), {"/PAMR/lineage, row 7", "format 2", "found 2047"}},
      {"FirstCodeWithoutState", word(7, mesh::n_family_codes), {"/PAMR/lineage, row 7"}},
      {"TopBitOfLineage", word(7, std::uint64_t{1} << 63U), {"/PAMR/lineage, row 7"}},
      {"PathOfNoNumber", word(7, 5U << 12U | std::uint64_t{1} << 20U), {"/PAMR/lineage, row 7"}},
      {"PathEndsBetweenNumbers", word(7, 5U << 12U | std::uint64_t{16} << 20U), {"/PAMR/lineage, row 7"}},
      {"PathLongerThanTheLevel", word(7, 1U << 12U | std::uint64_t{64} << 20U), {"/PAMR/lineage, row 7"}},
      {"BrokenFamilyWithPath", word(7, 3U | 1U << 11U | 1U << 12U | std::uint64_t{8} << 20U), {"/PAMR/lineage, row 7"}},
      {"MemberWithAnotherPath",
       [=](const path& f) {
         lineage(7, mesh::Lineage::regular(0).red_child(2).closed(1, 0))(f);
         lineage(8, mesh::Lineage::regular(0).red_child(3).closed(1, 1))(f);
       },
       {"/PAMR/lineage, row 8", "child numbers 2", "found", "child numbers 3"}},
      {"LoneFirstChild",
       lineage(7, mesh::Lineage(edge, 2, 0, 0)),
       {"/PAMR/lineage, row 8", "child 1 of a family of 2"}},
      {"LoneLastChild", lineage(7, mesh::Lineage(face, 2, 3, 0)), {"/PAMR/lineage, row 7", "child 0 of a family of 4"}},
      {"FamilyCutOffByTheEnd", lineage(47, mesh::Lineage(edge, 2, 0, 0)), {"/PAMR/lineage, row 48", "the end"}},
      {"LastChildAtTheStart", lineage(0, mesh::Lineage(edge, 2, 1, 0)), {"/PAMR/lineage, row 0"}},
      {"BrokenRegularCell", lineage(7, mesh::Lineage::regular(1).broken()), {"/PAMR/lineage, row 7"}},
      {"UnknownKindOfFormat1", word_of_format_1(7, 3), {"/PAMR/lineage, row 7", "format 1", "found 3"}},
      {"HighBitOfFormat1", word_of_format_1(7, 1U << 16U), {"/PAMR/lineage, row 7"}},
      {"TopBitOfFormat1", word_of_format_1(7, std::uint64_t{1} << 63U), {"/PAMR/lineage, row 7"}},
      {"EdgeSixOfSixOfFormat1", word_of_format_1(7, 1U | 6U << 2U), {"/PAMR/lineage, row 7"}},
      {"ChildTwoOfTwoOfFormat1", word_of_format_1(7, 1U | 1U << 2U | 2U << 5U), {"/PAMR/lineage, row 7"}},
      {"FaceFourOfFourOfFormat1", word_of_format_1(7, 2U | 4U << 2U), {"/PAMR/lineage, row 7"}},
      {"BrokenRegularCellOfFormat1", word_of_format_1(7, 0x80), {"/PAMR/lineage, row 7"}},
      {"LoneChildOfFormat1", word_of_format_1(7, 2U | 1U << 5U), {"/PAMR/lineage, row 7", "child 0 of a family of 4"}},
      {"LaterFormat",
       [](const path& f) { write_attribute(f, "/PAMR", "format", std::vector<std::int64_t>{5}); },
       {"/PAMR@format", "expected a number from 1 to 4, found 5"}},
      {"FormatZero",
       [](const path& f) { write_attribute(f, "/PAMR", "format", std::vector<std::int64_t>{0}); },
       {"/PAMR@format", "expected a number from 1 to 4, found 0"}},
      {"NoFormat", [](const path& f) { remove_attribute(f, "/PAMR", "format"); }, {"/PAMR@format"}},
      {"PatchNamedTwice",
       [](const path& f) {
         write_texts(f, "/PAMR/patches/names", {"a", "b", "c", "a", "e", "f"});
       },
       {"/PAMR/patches/names", "'a' twice"}},
      {"PatchWithoutName",
       [](const path& f) {
         write_texts(f, "/PAMR/patches/names", {"a", "", "c", "d", "e", "f"});
       },
       {"/PAMR/patches/names", "row 1"}},
      {"PatchNameIsNotUtf8",
       [](const path& f) {
         write_texts(f, "/PAMR/patches/names", {"a", "b\xff", "c", "d", "e", "f"});
       },
       {"/PAMR/patches/names", "UTF-8"}},
      {"TooFewKinds",
       [](const path& f) { write_texts(f, "/PAMR/patches/kinds", {"wall"}); },
       {"/PAMR/patches/kinds", "expected 6 texts", "found 1"}},
      {"SurfacesAreNumbers",
       [](const path& f) { write_dataset<double>(f, "/PAMR/surfaces", {1}, {1.0}); },
       {"/PAMR/surfaces", "expected text"}},
      {"ChecksumOfAnotherType",
       [](const path& f) { write_attribute(f, "/PAMR/checksums", "VTKHDF/Points", std::string("abc")); },
       {"checksums@VTKHDF/Points", "integers"}},
  };
}

std::string name_of(const testing::TestParamInfo<Damage>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(File, BadFile, testing::ValuesIn(damages_of_the_file()), name_of);
INSTANTIATE_TEST_SUITE_P(Structure, BadFile, testing::ValuesIn(damages_of_the_structure()), name_of);
INSTANTIATE_TEST_SUITE_P(Mesh, BadFile, testing::ValuesIn(damages_of_the_mesh()), name_of);
INSTANTIATE_TEST_SUITE_P(Extension, BadFile, testing::ValuesIn(damages_of_the_extension()), name_of);

TEST(BadFile, SaysInOneLineThatNoFileCanBeOpened) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "a.hdf", test::mesh_with_fields(comm, 1, 1));
  const int next = dup(0);  // the number that the next file gets
  close(next);
  int n_refused = 0;
  for (int n_left = 0; n_left < 8; ++n_left) {
    rlimit before{};
    getrlimit(RLIMIT_NOFILE, &before);
    const rlimit few{static_cast<rlim_t>(next + n_left), before.rlim_max};
    setrlimit(RLIMIT_NOFILE, &few);
    const auto error = test::error_of_reading(comm, folder / "a.hdf");
    setrlimit(RLIMIT_NOFILE, &before);
    comm.barrier();

    if (error == "no error") continue;
    ++n_refused;
    EXPECT_THAT(error, testing::AnyOf(testing::HasSubstr("Too many open files"),
                                      testing::HasSubstr("cannot open it")))  // MPI, which says no reason
        << n_left;
    EXPECT_THAT(error, testing::Not(testing::HasSubstr("\n"))) << n_left;
  }
  EXPECT_GT(n_refused, 0);
  EXPECT_EQ(test::error_of_reading(comm, folder / "a.hdf"), "no error");
}

}  // namespace bad_file_test
}  // namespace pamr
