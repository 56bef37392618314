// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <random>
#include <sstream>

#include "files.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/export/write_surface_vtu.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr {
namespace surface_vtu_test {

std::string content_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// A square of two triangles on cells 4 and 2, given by the last rank in an order that is not that of the file.
io::SurfaceTriangles square(const par::Comm& comm) {
  io::SurfaceTriangles t{.all_cells = 6};
  t.fields = {{.name = "p"}, {.name = "tau", .n_components = 3}, {.name = "patch", .is_integer = true}};
  t.corner_fields = {{.name = "psi"}};
  if (comm.rank() != comm.size() - 1) return t;
  t.cell = {4, 2};
  t.corner = {{{{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}}, {{{0, 0, 0}, {1, 0, 0.1}, {1, 1, -0.0}}}};
  t.fields[0].value = {0.5, 1.0 / 3};
  t.fields[1].value = {1, 2, 3, 4, 5, 6e-20};
  t.fields[2].value = {1, 0};
  t.corner_fields[0].value = {1, 2, 3, 4, 5, 6};
  return t;
}

TEST(SurfaceVtu, SaysUnitsBehindTheNumbers) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  auto t = square(comm);
  t.corner_fields.clear();
  t.fields[0].unit = "Pa";
  t.fields[1].unit = "W/m^2";

  io::write_surface_vtu(comm, folder / "s.vtu", t);

  const auto text = content_of(folder / "s.vtu");
  const auto key = [](const std::string& unit) {
    return "\n<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">" + unit +
           "</InformationKey>\n</DataArray>";
  };
  EXPECT_THAT(text, testing::HasSubstr("0.5" + key("Pa")));
  EXPECT_THAT(text, testing::HasSubstr("1 2 3" + key("W/m^2")));
  EXPECT_THAT(text, testing::HasSubstr("0\n1\n</DataArray>"));  // patch: none
}

TEST(SurfaceVtu, PrintsSharedPointsByFirstUse) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);
  auto t = square(comm);
  t.corner_fields.clear();

  io::write_surface_vtu(comm, folder / "s.vtu", t);

  EXPECT_EQ(content_of(folder / "s.vtu"), R"(<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1">
<UnstructuredGrid>
<Piece NumberOfPoints="4" NumberOfCells="2">
<Points>
<DataArray type="Float64" Name="Points" NumberOfComponents="3" format="ascii">
0 0 0
1 0 0.10000000000000001
1 1 -0
0 1 0
</DataArray>
</Points>
<Cells>
<DataArray type="Int64" Name="connectivity" NumberOfComponents="1" format="ascii">
0 1 2 
0 2 3 
</DataArray>
<DataArray type="Int64" Name="offsets" NumberOfComponents="1" format="ascii">
3
6
</DataArray>
<DataArray type="UInt8" Name="types" NumberOfComponents="1" format="ascii">
5
5
</DataArray>
</Cells>
<CellData>
<DataArray type="Float64" Name="p" NumberOfComponents="1" format="ascii">
0.333333333
0.5
</DataArray>
<DataArray type="Float64" Name="tau" NumberOfComponents="3" format="ascii">
4 5 6e-20
1 2 3
</DataArray>
<DataArray type="Int64" Name="patch" NumberOfComponents="1" format="ascii">
0
1
</DataArray>
</CellData>
</Piece>
</UnstructuredGrid>
</VTKFile>
)");
}

TEST(SurfaceVtu, PrintsPointsOfTheTrianglesOwnWithCornerFields) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);

  io::write_surface_vtu(comm, folder / "s.vtu", square(comm),
                        {.shares_points = false,
                         .coordinate_digits = 9,
                         .names_scalars = true,
                         .attributes = " byte_order=\"LittleEndian\""});

  const auto text = content_of(folder / "s.vtu");
  EXPECT_THAT(text, testing::HasSubstr("version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n"
                                       "<Piece NumberOfPoints=\"6\" NumberOfCells=\"2\">\n"));
  EXPECT_THAT(text, testing::HasSubstr("0 0 0\n1 0 0.1\n1 1 -0\n0 0 0\n1 1 0\n0 1 0\n</DataArray>"));
  EXPECT_THAT(text, testing::HasSubstr("0 1 2\n3 4 5\n</DataArray>"));
  EXPECT_THAT(text, testing::HasSubstr("<PointData Scalars=\"psi\">\n<DataArray type=\"Float64\" Name=\"psi\" "
                                       "NumberOfComponents=\"1\" format=\"ascii\">\n4 5 6\n1 2 3\n</DataArray>\n"
                                       "</PointData>\n<CellData Scalars=\"p\">\n"));
}

/// The boundary of a Kuhn cube on random ranks.
io::SurfaceTriangles boundary_of(const mesh::DistMesh& mesh) {
  io::SurfaceTriangles t{.all_cells = mesh.info.cell_ids(), .fields = {{.name = "area"}, {.name = "slot"}}};
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      if (mesh.cell_to_cell[at(cell)][slot] >= 0) continue;
      t.cell.push_back(mesh.cell_global[at(cell)]);
      auto& corner = t.corner.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) corner[k] = mesh.points(cell)[at(mesh::tet::face_to_corner[slot][k])];
      t.fields[0].value.push_back(0.5 * norm(cross(corner[1] - corner[0], corner[2] - corner[0])));
      t.fields[1].value.push_back(static_cast<double>(slot));
    }
  return t;
}

TEST(SurfaceVtu, IsTheSameOnAnyRankCountAndPartition) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const test::Folder folder(comm);

  for (const std::uint64_t seed : {1, 2, 3}) {
    test::on_first_rank(comm, [&] {
      io::write_surface_vtu(alone, folder / "one.vtu", boundary_of(test::mesh_with_fields(alone, 4, seed)));
    });
    io::write_surface_vtu(comm, folder / "many.vtu", boundary_of(test::mesh_with_fields(comm, 4, seed)));

    const auto text = content_of(folder / "many.vtu");
    EXPECT_TRUE(text == content_of(folder / "one.vtu"));
    EXPECT_THAT(text, testing::HasSubstr("NumberOfPoints=\"98\" NumberOfCells=\"192\""));
  }
}

TEST(SurfaceVtu, WritesASurfaceWithoutTriangles) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);

  io::write_surface_vtu(comm, folder / "s.vtu", {.all_cells = 6, .fields = {{.name = "p"}}});

  EXPECT_THAT(content_of(folder / "s.vtu"), testing::HasSubstr("NumberOfPoints=\"0\" NumberOfCells=\"0\""));
}

TEST(SurfaceVtu, LeavesNothingBehindWhenTheFolderIsMissing) {
  const par::Comm comm(MPI_COMM_WORLD);
  const test::Folder folder(comm);

  EXPECT_THROW(io::write_surface_vtu(comm, folder / "none" / "s.vtu", square(comm), {.shares_points = false}), Error);
  EXPECT_EQ(folder.n_entries(), 0U);
}

}  // namespace surface_vtu_test
}  // namespace pamr
