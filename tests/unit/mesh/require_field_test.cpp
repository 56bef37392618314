// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/require_field.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {
namespace require_field_test {

DistMesh mesh_with_three_fields() {
  DistMesh mesh;
  mesh.cell_fields = {{"refine", "", 1, StorageType::int32, std::vector<std::int64_t>{}},
                      {"u", "m/s", 3, StorageType::float64, std::vector<double>{}}};
  mesh.node_fields = {{"potential", "V", 1, StorageType::float64, std::vector<double>{}}};
  return mesh;
}

std::string error_of(const auto& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(RequireField, GivesTheFieldThatIsAsWanted) {
  const auto mesh = mesh_with_three_fields();

  EXPECT_EQ(&require_cell_field(mesh, {.name = "refine", .values = FieldValues::integer}), &mesh.cell_fields[0]);
  EXPECT_EQ(&require_cell_field(mesh, {.name = "u", .values = FieldValues::real, .n_components = 3}),
            &mesh.cell_fields[1]);
  EXPECT_EQ(&require_node_field(mesh, {.name = "potential"}), &mesh.node_fields[0]);
}

TEST(RequireField, SaysWhichFieldsThereAreWhenThatOneIsMissing) {
  const auto mesh = mesh_with_three_fields();

  EXPECT_EQ(error_of([&] { require_cell_field(mesh, {.name = "potential", .used_for = "marks"}); }),
            "marks: expected a cell field \"potential\", found none of that name (the mesh has: refine, u)");
  EXPECT_EQ(error_of([&] { require_node_field(DistMesh(), {.name = "x"}); }),
            "expected a node field \"x\", found none of that name (the mesh has: none)");
}

TEST(RequireField, SaysWhatAFieldOfTheNameHoldsInstead) {
  const auto mesh = mesh_with_three_fields();

  EXPECT_EQ(error_of([&] { require_cell_field(mesh, {.name = "u", .values = FieldValues::integer}); }),
            "cell field \"u\": expected 1 integer component, found 3 real components");
  EXPECT_EQ(error_of([&] { require_node_field(mesh, {.name = "potential", .n_components = 2, .used_for = "start"}); }),
            "start: node field \"potential\": expected 2 components, found 1 real component");
}

TEST(PutField, TakesThePlaceOfTheOldOneOrTheLast) {
  auto mesh = mesh_with_three_fields();

  put_field(mesh.cell_fields, {"refine", "", 1, StorageType::int64, std::vector<std::int64_t>{7}});
  put_field(mesh.cell_fields, {"new", "", 1, StorageType::float64, std::vector<double>{}});
  remove_field(mesh.cell_fields, "u");
  remove_field(mesh.cell_fields, "none of that name");

  EXPECT_EQ(names_of(mesh.cell_fields), "refine, new");
  EXPECT_THAT(mesh.cell_fields[0].integer(), testing::ElementsAre(7));
}

class RequireReplaceable : public ::testing::Test {
 protected:
  /// Of a cell on each rank, numbered as the ranks are.
  std::string error_with(Field field) {
    DistMesh mesh;
    mesh.cell_global = {comm.rank()};
    mesh.cell_fields = {std::move(field)};
    return error_of([&] { require_replaceable(comm, mesh, {"marks", "--marks", -1, 1}); });
  }

  par::Comm comm{MPI_COMM_WORLD};
};

TEST_F(RequireReplaceable, AcceptsAnOlderFieldOfTheStageAndNone) {
  EXPECT_EQ(error_with({"marks", "", 1, StorageType::int8, std::vector<std::int64_t>{-1}}), "no error");
  EXPECT_EQ(error_with({"other", "", 1, StorageType::float64, std::vector<double>{0.5}}), "no error");
}

TEST_F(RequireReplaceable, RefusesDataOnEveryRankAlike) {
  const std::string begin = "cell field 'marks', which --marks would replace: expected integers from -1 to 1, found ";
  const auto last = comm.size() - 1;
  const std::int64_t value = comm.rank() == last ? 2 : 1;

  EXPECT_EQ(error_with({"marks", "", 1, StorageType::int64, std::vector<std::int64_t>{value}}),
            begin + "2 in cell " + std::to_string(last));
  EXPECT_EQ(error_with({"marks", "", 1, StorageType::float64, std::vector<double>{1}}), begin + "reals");
  EXPECT_EQ(error_with({"marks", "", 3, StorageType::int64, std::vector<std::int64_t>{0, 0, 0}}),
            begin + "3 components");
}

}  // namespace require_field_test
}  // namespace pamr::mesh
