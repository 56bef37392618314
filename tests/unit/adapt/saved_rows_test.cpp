// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/saved_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mpi.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/balance/rebalance.hpp"
#include "pamr/base/error.hpp"
#include "pamr/io/native/native_file.hpp"
#include "support/meshes.hpp"

namespace pamr::adapt {
namespace saved_rows_test {

using Rows = CellRows<std::int32_t>;
namespace fs = std::filesystem;

/// As many items as the number of the cell says, 0 to 3.
Rows rows_of(const mesh::DistMesh& mesh) {
  Rows rows;
  for (const auto id : mesh.cell_global) {
    for (GlobalId k = 0; k < id % 4; ++k) rows.value.push_back(static_cast<std::int32_t>(10 * id + k));
    rows.offset.push_back(rows.value.size());
  }
  return rows;
}

/// A folder for the files of one test, shared by the ranks.
class SavedRowsTest : public ::testing::Test {
 protected:
  SavedRowsTest() {
    const auto here = fs::temp_directory_path() / ("pamr saved rows " + std::to_string(::getpid()));
    folder_ = comm_.broadcast(here.string());
    if (comm_.is_first()) fs::create_directory(folder_);
    comm_.barrier();
  }
  ~SavedRowsTest() override {
    comm_.barrier();
    if (comm_.is_first()) fs::remove_all(folder_);
  }
  SavedRowsTest(const SavedRowsTest&) = delete;
  SavedRowsTest& operator=(const SavedRowsTest&) = delete;
  SavedRowsTest(SavedRowsTest&&) = delete;
  SavedRowsTest& operator=(SavedRowsTest&&) = delete;

  std::string file(const std::string& name) const { return (fs::path(folder_) / name).string(); }

  /// Calls the function with a communicator of the first `n` ranks, on these.
  template <class Call>
  void on_first(int n, const Call& call) const {
    MPI_Comm few = MPI_COMM_NULL;
    MPI_Comm_split(MPI_COMM_WORLD, comm_.rank() < n ? 0 : MPI_UNDEFINED, 0, &few);
    if (few != MPI_COMM_NULL) {
      call(par::Comm(few));
      MPI_Comm_free(&few);
    }
    comm_.barrier();
  }

  std::string text_of(const std::string& name) const {
    std::ifstream in(file(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  void put(const std::string& name, const std::string& text) const {
    if (comm_.is_first()) std::ofstream(file(name), std::ios::binary) << text;
    comm_.barrier();
  }

  std::string error_of(const std::string& name, const mesh::DistMesh& mesh) const {
    try {
      read_cell_rows<std::int32_t>(comm_, file(name), mesh);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  par::Comm comm_{MPI_COMM_WORLD};
  std::string folder_;
};

/// A mesh with a field, and rows: refined and saved by some ranks.
void save(const par::Comm& comm, const std::string& mesh_file, const std::string& rows_file) {
  auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 3));
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) flags.push_back(norm(mesh.points(c)[0]) < 0.7 ? 1 : 0);
  mesh = refine(comm, std::move(mesh), flags).mesh;
  mesh::CellField field{"u", "K", 1, mesh::StorageType::float64, {}};
  for (const auto id : mesh.cell_global) field.real().push_back(std::sqrt(double(id)));
  mesh.cell_fields.push_back(std::move(field));
  io::write_native(comm, mesh_file, mesh);
  write_cell_rows(comm, rows_file, mesh, rows_of(mesh), "particles 1");
}

/// Goes on from the files: everything is there, and goes through one refinement more.
void go_on(const par::Comm& comm, const std::string& mesh_file, const std::string& rows_file, const std::string& to) {
  auto read = assemble::assemble(comm, io::read_native(comm, mesh_file));
  const std::vector<double> weights(read.cell_global.size(), 1.0);
  auto mesh =
      balance::rebalance(comm, std::move(read), std::span<const double>(weights), {.method = balance::Method::scotch})
          .mesh;
  const auto saved = read_cell_rows<std::int32_t>(comm, rows_file, mesh);
  EXPECT_EQ(saved.description, "particles 1");
  EXPECT_EQ(saved.rows.offset, rows_of(mesh).offset);
  EXPECT_EQ(saved.rows.value, rows_of(mesh).value);
  for (std::size_t c = 0; c < mesh.cell_global.size(); ++c)
    EXPECT_EQ(mesh.find_cell_field("u")->real()[c], std::sqrt(double(mesh.cell_global[c])));
  const auto before = mesh.info.cell_ids();
  const auto held = mesh.cell_global;
  std::vector<std::uint8_t> flags(held.size(), 1);
  mesh = refine(comm, std::move(mesh), flags).mesh;
  const auto rows = data_of_parents<std::int32_t>(comm, before, held, saved.rows, mesh);
  write_cell_rows(comm, to, mesh, rows);
}

TEST_F(SavedRowsTest, GoOnWithAnotherNumberOfRanks) {
  std::string expected;
  for (const auto& [from, to] : {std::pair{1, 1}, {3, 2}, {2, 5}}) {
    if (std::max(from, to) > comm_.size()) continue;
    on_first(from, [&](const par::Comm& few) { save(few, file("mesh.hdf"), file("rows")); });
    on_first(to, [&](const par::Comm& few) { go_on(few, file("mesh.hdf"), file("rows"), file("next")); });
    if (expected.empty()) expected = text_of("next");
    EXPECT_GT(expected.size(), 10000U);
    EXPECT_TRUE(text_of("next") == expected) << from << " to " << to;
    comm_.barrier();
  }
}

TEST_F(SavedRowsTest, SayWhatIsWrongWithAFile) {
  const auto mesh = assemble::assemble(comm_, assemble::kuhn_cube(comm_, 2));
  write_cell_rows(comm_, file("rows"), mesh, rows_of(mesh));
  const auto good = text_of("rows");
  const auto changed = [&](std::size_t place, char bit) {
    auto text = good;
    text[place] = static_cast<char>(text[place] ^ bit);
    put("bad", text);
    return error_of("bad", mesh);
  };

  EXPECT_EQ(error_of("rows", mesh), "no error");
  EXPECT_THAT(error_of("none", mesh), testing::HasSubstr("expected a file that can be read, found none"));
  EXPECT_THAT(changed(0, 1), testing::HasSubstr("found another kind of file"));
  EXPECT_THAT(changed(8, 2), testing::HasSubstr("expected version 1, found version 3"));
  EXPECT_THAT(changed(16, 1), testing::HasSubstr("expected items of 4 bytes, found 5"));
  EXPECT_THAT(changed(24, 1), testing::HasSubstr("expected data of 48 cells, as the mesh has, found 49"));
  EXPECT_THAT(changed(32, 1), testing::HasSubstr("expected a file as long as its head says"));
  EXPECT_THAT(changed(40, 1), testing::HasSubstr("found another one"));
  EXPECT_THAT(changed(120 + 8 * 5, 64), testing::HasSubstr("expected rows one after another"));
  EXPECT_THAT(changed(good.size() - 1, 1), testing::HasSubstr("the file is damaged"));
  put("bad", good.substr(0, good.size() - 1));
  EXPECT_THAT(error_of("bad", mesh), testing::HasSubstr("expected a file as long as its head says"));
  put("bad", good.substr(0, 50));
  EXPECT_THAT(error_of("bad", mesh), testing::HasSubstr("found a shorter file"));
  EXPECT_THROW((read_cell_rows<std::int64_t>(comm_, file("rows"), mesh)), Error);
  auto other = mesh;
  for (auto& p : other.node_position) p.x *= 2;
  EXPECT_THAT(error_of("rows", other), testing::HasSubstr("expected the mesh that the data were written with"));
  EXPECT_THROW(write_cell_rows(comm_, file("rows"), mesh, rows_of(mesh), std::string(65, 'x')), Error);
}

}  // namespace saved_rows_test
}  // namespace pamr::adapt
