// SPDX-License-Identifier: GPL-3.0-or-later
// Triangulated surfaces in the native file.
#include <gmock/gmock.h>

#include <limits>

#include "files.hpp"
#include "hdf5_edit.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/native/native_file.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace triangulation_test {

using std::filesystem::path;
using test::Folder;

constexpr const char* points_of_a = "/PAMR/surface_data/a tetrahedron/points";
constexpr const char* triangles_of_a = "/PAMR/surface_data/a tetrahedron/triangles";

std::vector<geometry::Triangulation> two_surfaces() {
  return {
      {"épaule", {{0, 0, 0}, {1, 0, 1e-300}, {0, -1.5, 0}}, {{0, 1, 2}}},
      {"a tetrahedron", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}};
}

std::vector<geometry::Triangulation> by_name(std::vector<geometry::Triangulation> surfaces) {
  std::sort(surfaces.begin(), surfaces.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return surfaces;
}

std::vector<geometry::Triangulation> data_of(const mesh::BlockMesh& block) {
  std::vector<geometry::Triangulation> result;
  for (const auto& data : block.info.surfaces->triangulations) result.push_back(*data);
  return result;
}

mesh::DistMesh cube_with(const par::Comm& comm, std::vector<geometry::Triangulation> surfaces) {
  auto block = test::kuhn_cube(comm, 2);
  geometry::SurfaceSet set;
  for (auto& surface : surfaces)
    set.triangulations.push_back(std::make_shared<const geometry::Triangulation>(std::move(surface)));
  block.info.surfaces = std::make_shared<const geometry::SurfaceSet>(std::move(set));
  return assemble::assemble(comm, std::move(block));
}

TEST(Triangulations, AreReadBackOnEveryRankInOrderOfTheirNames) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);

  io::write_native(comm, folder / "a.hdf", cube_with(comm, two_surfaces()));

  EXPECT_EQ(data_of(io::read_native(comm, folder / "a.hdf")), by_name(two_surfaces()));
}

TEST(Triangulations, GoThroughARefinementAndAnotherFileWithTheSameBytes) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const Folder folder(comm);
  const auto fine = [&](const par::Comm& ranks) {
    const auto mesh = cube_with(ranks, two_surfaces());
    const std::vector<std::uint8_t> all(static_cast<std::size_t>(mesh.n_cells()), 1);
    return adapt::refine(ranks, mesh, all, {.marks_field = ""}).mesh;
  };

  io::write_native(comm, folder / "together.hdf", fine(comm));
  if (comm.is_first()) io::write_native(self, folder / "alone.hdf", fine(self), {.provenance = "", .slab_bytes = 48});
  comm.barrier();
  io::write_native(comm, folder / "again.hdf",
                   assemble::assemble(comm, io::read_native(comm, folder / "together.hdf")));

  EXPECT_EQ(test::bytes_of(folder / "together.hdf"), test::bytes_of(folder / "alone.hdf"));
  EXPECT_EQ(test::bytes_of(folder / "together.hdf"), test::bytes_of(folder / "again.hdf"));
  EXPECT_EQ(data_of(io::read_native(comm, folder / "again.hdf")), by_name(two_surfaces()));
}

TEST(Triangulations, MayBeWrittenByAStrangerInOtherTypes) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "a.hdf", cube_with(comm, {}));
  test::on_first_rank(comm, [&] {
    test::create_group(folder / "a.hdf", "/PAMR/surface_data");
    test::create_group(folder / "a.hdf", "/PAMR/surface_data/wall");
    test::write_dataset<float>(folder / "a.hdf", "/PAMR/surface_data/wall/points", {3, 3}, {0, 0, 0, 1, 0, 0, 0, 1, 0});
    test::write_dataset<std::int64_t>(folder / "a.hdf", "/PAMR/surface_data/wall/triangles", {1, 3}, {2, 0, 1},
                                      {.chunk = 1});
  });

  const auto read = data_of(io::read_native(comm, folder / "a.hdf"));

  EXPECT_EQ(read, (std::vector<geometry::Triangulation>{{"wall", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{2, 0, 1}}}}));
}

/// A way to spoil the surfaces, and words that the error must contain.
struct Damage {
  const char* name;
  std::function<void(const path&)> make;
  std::vector<std::string> words;
};
void PrintTo(const Damage& damage, std::ostream* out) { *out << damage.name; }

std::vector<Damage> damages() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  return {
      {"NotFinite",
       [nan](const path& f) { test::set_value<double>(f, points_of_a, 7, nan); },
       {points_of_a, "row 2", "finite"}},
      {"PointTooLarge",
       [](const path& f) { test::set_value<std::int64_t>(f, triangles_of_a, 10, 4); },
       {triangles_of_a, "row 3", "from 0 to 3", "found 4"}},
      {"PointNegative",
       [](const path& f) { test::set_value<std::int64_t>(f, triangles_of_a, 0, -1); },
       {triangles_of_a, "row 0", "found -1"}},
      {"PointBeyond32Bits",
       [](const path& f) { test::set_value<std::int64_t>(f, triangles_of_a, 0, (std::int64_t{1} << 32U) + 1); },
       {triangles_of_a, "found 4294967297"}},
      {"WrongWidth",
       [](const path& f) {
         test::write_dataset<double>(f, points_of_a, {3, 2}, {0, 0, 1, 0, 0, 1});
       },
       {points_of_a, "n x 3", "found 3 x 2"}},
      {"NoTriangles",
       [](const path& f) {
         test::write_dataset<std::int32_t>(f, triangles_of_a, {0, 3}, {});
       },
       {triangles_of_a, "n from 1", "found 0 x 3"}},
      {"RealTriangles",
       [](const path& f) {
         test::write_dataset<double>(f, triangles_of_a, {1, 3}, {0, 1, 2});
       },
       {triangles_of_a, "expected integers"}},
      {"OneDatasetMissing",
       [](const path& f) { test::remove_object(f, triangles_of_a); },
       {triangles_of_a, "expected this dataset, found none"}},
      {"DatasetForGroup",
       [](const path& f) { test::write_dataset<double>(f, "/PAMR/surface_data/loose", {1}, {0}); },
       {"/PAMR/surface_data/loose", "expected a group"}},
      {"FlippedPoint",
       [](const path& f) { test::flip_byte(f, test::extent_of(f, points_of_a).offset + 30); },
       {points_of_a, "checksum"}},
      {"FlippedTriangle",
       [](const path& f) { test::flip_byte(f, test::extent_of(f, "/PAMR/surface_data/épaule/triangles").offset); },
       {"/PAMR/surface_data/épaule/triangles"}},
  };
}

class BadTriangulation : public testing::TestWithParam<Damage> {};
INSTANTIATE_TEST_SUITE_P(Surfaces, BadTriangulation, testing::ValuesIn(damages()),
                         [](const auto& damage) { return damage.param.name; });

TEST_P(BadTriangulation, IsRefusedOnEveryRankWithTheSameWords) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  io::write_native(comm, folder / "bad.hdf", cube_with(comm, two_surfaces()));
  test::on_first_rank(comm, [&] { GetParam().make(folder / "bad.hdf"); });

  const auto error = test::error_of_reading(comm, folder / "bad.hdf");

  EXPECT_THAT(error, testing::HasSubstr("bad.hdf'"));
  for (const auto& word : GetParam().words) EXPECT_THAT(error, testing::HasSubstr(word));
  EXPECT_EQ(error, comm.broadcast(error));
}

TEST(Triangulations, AreNotWrittenWhenTheyCouldNotBeReadBack) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Folder folder(comm);
  const auto good = two_surfaces()[0];
  const auto expect_refusal = [&](const std::function<void(geometry::Triangulation&)>& spoil, const char* words) {
    auto bad = good;
    spoil(bad);
    try {
      io::write_native(comm, folder / "a.hdf", cube_with(comm, {two_surfaces()[1], bad}));
      ADD_FAILURE() << "written in spite of: " << words;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(words));
    }
  };

  expect_refusal([](auto& s) { s.name = "a/b"; }, "without '/'");
  expect_refusal([](auto& s) { s.name = ""; }, "expected a name");
  expect_refusal([](auto& s) { s.name = "a tetrahedron"; }, "found it twice");
  expect_refusal([](auto& s) { s.points[1].y = std::numeric_limits<double>::infinity(); }, "finite");
  expect_refusal([](auto& s) { s.triangles[0][2] = 3; }, "points from 0 to 2");
  expect_refusal([](auto& s) { s.triangles.clear(); }, "1 triangle or more");
  EXPECT_EQ(folder.n_entries(), 0U);
}

}  // namespace triangulation_test
}  // namespace pamr
