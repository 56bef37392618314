// SPDX-License-Identifier: GPL-3.0-or-later
// That a refinement does not depend on how its input is numbered: not on the order of cells and nodes, not on that of a
// cell's corners, not on the ranks.
#include <gtest/gtest.h>

#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "pamr/validate/validate.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace numbering_test {

using refine::QualityControl;

/// Flags about one cell in `one_in`, drawn from the places of its corners, in whatever order.
std::vector<std::uint8_t> draw(const mesh::DistMesh& mesh, std::uint64_t seed, std::uint64_t one_in) {
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    std::uint64_t sum = 0;
    for (const auto p : mesh.points(c))
      sum += combine(combine(combine(seed, bits_of(p.x)), bits_of(p.y)), bits_of(p.z));
    flags.push_back(mix(sum) % one_in == 0 ? 1 : 0);
  }
  return flags;
}

struct Outcome {
  std::uint64_t fingerprint = 0;
  std::int64_t cells = 0;
  friend bool operator==(const Outcome&, const Outcome&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Outcome& o) {
    return out << std::hex << o.fingerprint << std::dec << ", " << o.cells << " cells";
  }
};

/// Refines level by level; before each level the mesh is renumbered at random if `shuffle` is not 0, and then ordered
/// along the curve if `order`.
std::vector<Outcome> refine_levels(const par::Comm& comm, const mesh::BlockMesh& start, QualityControl policy,
                                   std::uint64_t shuffle, bool order) {
  auto mesh = assemble::assemble(comm, start);
  std::vector<Outcome> outcomes;
  for (std::uint64_t level = 0; level < 3; ++level) {
    if (shuffle != 0) {
      auto block = test::permute(comm, test::cut(comm, test::gather(comm, mesh)), combine(shuffle, level));
      if (order) block = order::order_along_curve(comm, std::move(block)).block;
      const auto destination = test::random_destinations(comm, block, shuffle);
      mesh = assemble::assemble(comm, std::move(block), destination);
    }
    mesh = adapt::refine(comm, mesh, draw(mesh, level, 15),
                         {.quality_control = policy, .parent_field = false, .marks_field = ""})
               .mesh;
    outcomes.push_back({mesh::fingerprint(comm, mesh), mesh.info.n_global_cells});
  }
  EXPECT_TRUE(validate::validate(comm, mesh).empty());
  return outcomes;
}

class AnyNumbering : public ::testing::TestWithParam<QualityControl> {};
INSTANTIATE_TEST_SUITE_P(Refine, AnyNumbering,
                         ::testing::Values(QualityControl::none, QualityControl::isotropic, QualityControl::short_edge,
                                           QualityControl::removable));

TEST_P(AnyNumbering, GivesTheSameMeshOfARandomOne) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const auto block = test::random_mesh(comm, seed, 3);
    const auto expected = refine_levels(self, test::gather(comm, block), GetParam(), 0, false);

    EXPECT_EQ(refine_levels(comm, block, GetParam(), 10 + seed, false), expected) << "seed " << seed;
    EXPECT_EQ(refine_levels(comm, block, GetParam(), 20 + seed, true), expected) << "seed " << seed;
  }
}

/// Full of equals: lengths, volumes, qualities.
TEST_P(AnyNumbering, GivesTheSameMeshOfACube) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto block = test::kuhn_cube(comm, 4);
  const auto expected = refine_levels(self, test::kuhn_cube(self, 4), GetParam(), 0, false);

  EXPECT_EQ(refine_levels(comm, block, GetParam(), 31, false), expected);
  EXPECT_EQ(refine_levels(comm, block, GetParam(), 32, true), expected);
}

}  // namespace numbering_test
}  // namespace pamr
