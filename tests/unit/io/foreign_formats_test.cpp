// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/io/cgns/cgns_conditions.hpp"
#include "pamr/io/elements/boundary_rows.hpp"
#include "pamr/io/elements/numbers.hpp"
#include "pamr/io/medit/gmf.hpp"
#include "pamr/io/ugrid/mapbc.hpp"
#include "pamr/io/ugrid/ugrid_layout.hpp"
#include "pamr/io/vtk/vtk_xml.hpp"
#include "pamr/io/written_names.hpp"

namespace pamr::io {
namespace foreign_formats_test {

constexpr std::int64_t two_31 = std::int64_t{1} << 31;

TEST(MeditVersion, GrowsWithPlacesAndNumbers) {
  EXPECT_EQ(gmf::version_for(1000, 10), 2);
  EXPECT_EQ(gmf::version_for(two_31 - 1, 10), 2);
  EXPECT_EQ(gmf::version_for(two_31, 10), 3);
  EXPECT_EQ(gmf::version_for(40 * two_31, two_31 - 1), 3);
  EXPECT_EQ(gmf::version_for(40 * two_31, two_31), 4);
}

TEST(VtkType, IsOneOfNumbersOrRefused) {
  EXPECT_EQ(vtk::storage_of("UInt16"), mesh::StorageType::uint16);
  EXPECT_THROW(vtk::storage_of("String"), Error);
  EXPECT_THROW(vtk::storage_of(""), Error);
}

TEST(UgridLayout, HasPlacesBeyondTwoGigabytes) {
  const auto layout = ugrid::layout_of({.nodes = 300'000'000, .triangles = 2'000'000, .tetrahedra = 2'000'000'000});

  EXPECT_EQ(layout.triangles, 28 + 7'200'000'000);
  EXPECT_EQ(layout.references, layout.triangles + 24'000'000);
  EXPECT_EQ(layout.tetrahedra, layout.references + 8'000'000);
  EXPECT_EQ(layout.bytes, layout.tetrahedra + 32'000'000'000);
}

TEST(UgridName, SaysTheOrderOfBytesAndWhereConditionsAre) {
  EXPECT_TRUE(ugrid::is_big_endian("a folder/part.b8.ugrid"));
  EXPECT_FALSE(ugrid::is_big_endian("part.lb8.ugrid"));
  EXPECT_THROW(ugrid::is_big_endian("part.ugrid"), Error);
  EXPECT_THROW(ugrid::is_big_endian("part.r8.ugrid"), Error);
  EXPECT_EQ(ugrid::mapbc_of("a.b/part.lb8.ugrid").string(), "a.b/part.mapbc");
}

TEST(UgridConditions, ComeBackAsTheKindsThatTheyStandFor) {
  for (const auto* kind : {"wall", "symmetry", "farfield", "inflow", "outflow"})
    EXPECT_EQ(ugrid::kind_of_condition(ugrid::condition_of_kind(kind, 1)), kind);
  EXPECT_EQ(ugrid::condition_of_kind("symmetry", 2), 6663);
  EXPECT_EQ(ugrid::condition_of_kind("symmetry", -1), 3000);
  EXPECT_EQ(ugrid::condition_of_kind("", 0), 0);
  EXPECT_EQ(ugrid::kind_of_condition(0), "");
}

TEST(PatchNumbers, KeepThoseInNamesAndFillTheGaps) {
  const std::vector<std::string> names{"wall", "ref_2", "ref_0", "ref_x", "ref_2 ", "ref_1234567890", "far"};

  EXPECT_EQ(patch_numbers(names, "ref_", 0), (std::vector<std::int64_t>{1, 2, 0, 3, 4, 5, 6}));
  EXPECT_EQ(patch_numbers(names, "ref_", 1), (std::vector<std::int64_t>{1, 2, 3, 4, 5, 6, 7}));
}

TEST(WrittenNames, StayDifferentAndSaySo) {
  std::vector<std::string> said;
  const auto remark = [&](const std::string& text) { said.push_back(text); };
  const NameRule rule{
      .format = "X", .what = "patch", .is_allowed = [](char c) { return c != ' '; }, .longest = 6, .taken = {"mine"}};
  using Names = std::vector<std::string>;

  EXPECT_EQ(written_names(rule, {"a", "b_c"}, remark), (Names{"a", "b_c"}));
  EXPECT_EQ(said, Names());
  // Names that can stay do, wherever they come; cut ones leave room for the number, whole characters for the others.
  EXPECT_EQ(written_names(rule, {"a b", "a_b", "a_b_2", "mine", "longest", "longes", "éééé"}, remark),
            (Names{"a_b_3", "a_b", "a_b_2", "mine_2", "long_2", "longes", "ééé"}));
  EXPECT_EQ(said, (Names{"X: patch 'a b' is written as 'a_b_3', and 3 other names are changed, too"}));
  EXPECT_EQ(written_names(rule, {"velocity", "velocity", "velo", "veloci"}, remark, {"X", "Y", "", "X"}),
            (Names{"velocX", "velocY", "velo", "vel_2X"}));
  EXPECT_EQ(written_names(rule, {"a_b", "a", "a"}, {}, {"", "_b", ""}), (Names{"a_b", "a_2_b", "a"}));
}

/// Elements as a section of tetrahedra, one of prisms and tetrahedra in turn, and one of earlier numbers have them.
cgns::Elements some_elements() {
  cgns::Elements elements;
  std::size_t n = 0;
  const auto add = [&](std::int64_t number, std::size_t pieces) {
    elements.add(number, {n, pieces});
    n += pieces;
  };
  for (std::int64_t number = 10; number < 20; ++number) add(number, 1);
  for (std::int64_t number = 20; number < 24; ++number) add(number, number % 2 == 0 ? 3 : 1);
  for (std::int64_t number = 1; number < 4; ++number) add(number, 1);
  return elements;
}

TEST(CgnsElements, AreFoundByTheirNumbers) {
  auto elements = some_elements();
  elements.put_in_order();

  EXPECT_EQ(elements.size(), 17);
  EXPECT_EQ(elements.runs().size(), 6U);
  EXPECT_FALSE(elements.were_in_order());
  const auto found = [&](std::int64_t number) {
    const auto [first, n] = elements.find(number);
    return std::pair(first, n);
  };
  using Pieces = std::pair<std::size_t, std::size_t>;
  EXPECT_EQ(found(10), Pieces(0, 1));
  EXPECT_EQ(found(19), Pieces(9, 1));
  EXPECT_EQ(found(20), Pieces(10, 3));
  EXPECT_EQ(found(21), Pieces(13, 1));
  EXPECT_EQ(found(22), Pieces(14, 3));
  EXPECT_EQ(found(1), Pieces(18, 1));
  EXPECT_EQ(found(3), Pieces(20, 1));
  for (const std::int64_t missing : {-5, 0, 4, 9, 24}) EXPECT_EQ(found(missing).second, 0U);
}

TEST(CgnsElements, OfEqualNumbersAreRefused) {
  for (const std::int64_t twice : {1, 3, 10, 21}) {
    auto elements = some_elements();
    elements.add(twice, {21, 1});
    EXPECT_THROW(elements.put_in_order(), Error);
  }
}

TEST(Numbers, SwapTheirBytes) {
  std::string bytes;
  append_bytes(bytes, std::int32_t{0x01020304}, true);
  append_bytes(bytes, std::int32_t{0x01020304});

  EXPECT_EQ(bytes, "\x01\x02\x03\x04\x04\x03\x02\x01");
  EXPECT_EQ(byteswapped(byteswapped(0.1)), 0.1);
}

}  // namespace foreign_formats_test
}  // namespace pamr::io
