// SPDX-License-Identifier: GPL-3.0-or-later
// Calls that C++ would make with a value cut to fit do not compile; the right ones beside them do.
#include "pamr/base/exact.hpp"

#include <gtest/gtest.h>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pamr/assemble/turn_inverted.hpp"
#include "pamr/base/toml_table.hpp"
#include "pamr/check/extract.hpp"
#include "pamr/check/view_selection.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/geometry/triangulated/read_triangulation.hpp"
#include "pamr/locate/walk.hpp"
#include "pamr/mark/field_criteria.hpp"
#include "pamr/mark/geometric_criteria.hpp"
#include "pamr/mesh/local_size.hpp"
#include "pamr/mesh/offsets.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/pamr.hpp"
#include "pamr/par/equal_work.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/mailbox.hpp"
#include "pamr/par/select_smallest.hpp"
#include "pamr/par/sum_modulo.hpp"

namespace pamr {
namespace exact_test {

template <class... T, class... Call>
constexpr bool all_take(Call...) {
  return ([]<class One>(One*) { return (std::invocable<One, T> && ...); }(static_cast<Call*>(nullptr)) && ...);
}
template <class... T, class... Call>
constexpr bool none_takes(Call...) {
  return ([]<class One>(One*) { return (!std::invocable<One, T> && ...); }(static_cast<Call*>(nullptr)) && ...);
}

template <class T>
T any_of();  // is called in no program
using Comm = const par::Comm&;
using Mesh = const mesh::DistMesh&;
using Values = std::span<const double>;

TEST(Exact, TakesWhatItHoldsAndIsReadAsIt) {
  static_assert(std::constructible_from<Exact<int>, std::int16_t> && !std::constructible_from<Exact<int>, long>);
  static_assert(!std::constructible_from<Exact<int>, double> && !std::constructible_from<Exact<int>, unsigned>);
  static_assert(!std::constructible_from<Exact<bool>, const char*> && !std::constructible_from<Exact<bool>, int>);
  static_assert(!std::constructible_from<Exact<bool>, const char(&)[3]>);
  static_assert(!std::constructible_from<std::optional<Exact<int>>, double>);
  const std::vector<bool> bits{true};

  const Exact<std::int64_t> count = std::size_t{5};
  const Exact<bool> bit = bits[0];

  EXPECT_EQ(count + 1, 6);
  EXPECT_TRUE(bit);
}

TEST(Exact, NoCountIsCutFromARealNumber) {
  const auto sum = [](auto n) requires requires { any_of<Comm>().sum(n); }
  {};
  const auto before = [](auto n) requires requires { any_of<Comm>().exclusive_sum(n); }
  {};
  const auto asleep = [](auto n) requires requires { any_of<Comm>().min_asleep(n); }
  {};
  const auto modulo = [](auto n) requires requires { par::sum_modulo(any_of<Comm>(), n); }
  {};
  const auto id = [](auto n) requires requires { IdRange(n); }
  {};
  const auto smallest = [](auto n) requires requires {
    par::select_smallest(any_of<Comm>(), any_of<std::span<const par::SortKey>>(), n);
  }
  {};
  const auto strongest = [](auto n) requires requires {
    mark::strongest(any_of<Comm>(), any_of<Mesh>(), any_of<Values>(), n);
  }
  {};
  const auto budget = [](auto n) requires requires {
    mark::marks_within_budget(any_of<Comm>(), any_of<Mesh>(), any_of<Values>(), n, any_of<mark::Prediction>());
  }
  {};
  const auto share = [](auto n) requires requires { mark::above_mean_share(any_of<mark::RecoveredError>(), n, 0.5); }
  {};
  const auto worst = [](auto n) requires requires { check::worst_cells(any_of<Comm>(), any_of<Mesh>(), n); }
  {};
  const auto find = [](auto n) requires requires { check::find_worst_cells(any_of<Comm>(), any_of<Mesh>(), n); }
  {};
  const auto local = [](auto n) requires requires { mesh::require_local_size(any_of<Comm>(), n, ""); }
  {};
  const auto weight = [](auto n) requires requires { balance::measure_ranks(any_of<Comm>(), any_of<Mesh>(), n); }
  {};
  const auto region = [](auto n) requires requires { mesh::name_of_region(any_of<const mesh::MeshInfo&>(), n); }
  {};
  const auto width = [](auto n) requires requires {
    par::fetch_rows<double>(any_of<Comm>(), GlobalId{1}, any_of<Values>(), n, any_of<std::span<const GlobalId>>());
  }
  {};
  const auto piece = [](auto n) requires requires { par::Comm(MPI_COMM_SELF, n); }
  {};

  EXPECT_TRUE((all_take<int, std::uint8_t, LocalId, GlobalId, std::size_t>(sum, before, asleep, modulo, id, smallest,
                                                                           strongest, budget, share, worst, find, local,
                                                                           weight, region, width, piece)));
  EXPECT_TRUE((none_takes<float, double, long double>(sum, before, asleep, modulo, id, smallest, strongest, budget,
                                                      share, worst, find, local, weight, region, width, piece)));
}

TEST(Exact, NoLocalIdRankOrLevelIsCutFromAWiderNumber) {
  const auto point = [](auto i) requires requires { any_of<Mesh>().point(i); }
  {};
  const auto points = [](auto i) requires requires { any_of<Mesh>().points(i); }
  {};
  const auto own = [](auto i) requires requires { any_of<Mesh>().is_own(i); }
  {};
  const auto ghost = [](auto i) requires requires { any_of<Mesh>().is_ghost(i); }
  {};
  const auto surface = [](auto i) requires requires { any_of<const mesh::MeshInfo&>().surface_of(i); }
  {};
  const auto slot = [](auto i) requires requires { mesh::patch_to_slot(i); }
  {};
  const auto patch = [](auto i) requires requires { mesh::slot_to_patch(i); }
  {};
  const auto near = [](auto i) requires requires { any_of<const locate::Locator&>().find({}, i); }
  {};
  const auto walk = [](auto i) requires requires { locate::walk_towards(any_of<Mesh>(), i, {}); }
  {};
  const auto side = [](auto i) requires requires { locate::side_of_cell(any_of<Mesh>(), i, {}); }
  {};
  const auto centroid = [](auto i) requires requires { mark::centroid(any_of<Mesh>(), i); }
  {};
  const auto size = [](auto i) requires requires { mark::cell_size(any_of<Mesh>(), i, mark::CellSize::cbrt_volume); }
  {};
  const auto layers = [](auto i) requires requires { mark::near_patch(any_of<Comm>(), any_of<Mesh>(), "wall", i); }
  {};
  const auto level = [](auto i) requires requires {
    mark::keep_below_level(any_of<Mesh>(), i, any_of<mark::Indicator&>());
  }
  {};
  const auto cube = [](auto i) requires requires { assemble::kuhn_cube(any_of<Comm>(), i); }
  {};
  const auto root = [](auto i) requires requires { any_of<Comm>().broadcast(std::string(), i); }
  {};
  const auto root_of_data = [](auto i) requires requires { any_of<Comm>().broadcast(std::vector<int>(), i); }
  {};
  const auto rank = [](auto i) requires requires { par::block_range(IdRange(4), i, 2); }
  {};
  const auto n_ranks = [](auto i) requires requires { par::block_of(0, IdRange(4), i); }
  {};
  const auto target = [](auto i) requires requires { any_of<par::Mailbox<int>&>().add(i, 1); }
  {};
  const auto runs = [](auto i) requires requires {
    par::runs_of_equal_work(any_of<Comm>(), any_of<std::span<const std::uint8_t>>(), i);
  }
  {};
  const auto parts = [](auto i) requires requires {
    balance::partition(any_of<Comm>(), any_of<Mesh>(), any_of<std::span<const std::int64_t>>(), i);
  }
  {};
  const auto axis = [](auto i) requires requires { geometry::described_plane("plane", i, 0.5); }
  {};
  const auto of_set = [](auto i) requires requires { any_of<const geometry::SurfaceSet&>().get(i); }
  {};

  EXPECT_TRUE((all_take<int, std::int16_t, std::uint8_t>(point, points, own, ghost, surface, slot, patch, near, walk,
                                                         side, centroid, size, layers, level, cube, root, root_of_data,
                                                         rank, n_ranks, target, runs, parts, axis, of_set)));
  EXPECT_TRUE((none_takes<double, float, GlobalId, std::size_t, unsigned>(
      point, points, own, ghost, surface, slot, patch, near, walk, side, centroid, size, layers, level, cube, root,
      root_of_data, rank, n_ranks, target, runs, parts, axis, of_set)));
}

TEST(Exact, NoAnswerIsMadeOfANumberOrAPointer) {
  const auto any = [](auto is) requires requires { any_of<Comm>().any(is); }
  {};
  const auto all = [](auto is) requires requires { any_of<Comm>().all(is); }
  {};
  const auto repair = [](auto is) requires requires {
    assemble::orient(any_of<Comm>(), any_of<mesh::BlockMesh&>(), is);
  }
  {};
  const auto open = [](auto is) requires requires { geometry::read_triangulation(std::filesystem::path(), is); }
  {};
  const auto fill = [](auto is) requires requires {
    mark::choose_within_budget(any_of<Comm>(), any_of<Mesh>(), any_of<const mark::Request&>(),
                               any_of<const mark::Applied&>(), {1, is, any_of<mark::PredictionBothWays>()});
  }
  {};
  const auto flag = [](auto is) requires requires { any_of<const TomlTable&>().flag_or("key", is); }
  {};

  EXPECT_TRUE((all_take<bool, std::vector<bool>::reference>(any, all, repair, open, fill, flag)));
  EXPECT_TRUE((none_takes<int, double, std::size_t, const char*, void*>(any, all, repair, open, fill, flag)));
}

TEST(Exact, NoOptionIsCutWhenItIsSet) {
  const auto keep_for = [](auto n) requires requires { any_of<mark::Request&>().keep_for = n; }
  {};
  const auto min_level = [](auto n) requires requires { any_of<mark::Request&>().min_level = n; }
  {};
  const auto max_level = [](auto n) requires requires { any_of<mark::Request&>().max_level = n; }
  {};
  const auto format = [](auto n) requires requires { any_of<io::WriteOptions&>().format = n; }
  {};
  const auto slab = [](auto n) requires requires { any_of<io::ReadOptions&>().slab_bytes = n; }
  {};
  const auto vertices = [](auto n) requires requires { any_of<balance::Options&>().vertices_per_part = n; }
  {};
  const auto project = [](auto is) requires requires { any_of<refine::Options&>().project = is; }
  {};
  const auto repair = [](auto is) requires requires { any_of<io::GmshOptions&>().repair = is; }
  {};
  const auto binary = [](auto is) requires requires { any_of<io::GmshWriteOptions&>().binary = is; }
  {};

  EXPECT_TRUE((all_take<int, std::uint8_t>(keep_for, min_level, max_level, format, slab, vertices)));
  EXPECT_TRUE((none_takes<double, float>(keep_for, min_level, max_level, format, slab, vertices)));
  EXPECT_TRUE((none_takes<std::int64_t>(keep_for, min_level, max_level, format)));
  EXPECT_TRUE(all_take<bool>(project, repair, binary));
  EXPECT_TRUE((none_takes<int, double, const char*>(project, repair, binary)));
}

TEST(Exact, SmallestAndLargestKeepTheirType) {
  const auto smallest = [](auto value) requires requires { any_of<Comm>().min(value); }
  {};
  const auto largest = [](auto value) requires requires { any_of<Comm>().max(value); }
  {};
  const auto gathered = [](auto value) requires requires { any_of<Comm>().all_gather(value); }
  {};

  EXPECT_TRUE((all_take<double, float, std::int64_t>(smallest, largest, gathered)));
  EXPECT_TRUE((none_takes<std::uint64_t, long double>(smallest, largest, gathered)));  // which of the two is meant?
  EXPECT_TRUE((std::same_as<decltype(any_of<Comm>().min(0.75)), double>));
}

}  // namespace exact_test
}  // namespace pamr
