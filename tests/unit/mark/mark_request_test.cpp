// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/mark/budget.hpp"
#include "pamr/mark/criteria.hpp"

namespace pamr::mark {
namespace mark_request_test {

template <class Rule>
const Rule& rule(const Request& request, std::size_t i) {
  return std::get<Rule>(request.criteria.at(i).rule);
}

TEST(ReadRequest, ReadsEachCriterion) {
  const auto request = read_request({{"--all", ""},
                                     {"--crossing-sphere", "1,-2,3.5,0.25"},
                                     {"--centroid-shell", "0,0,0,1,0.1"},
                                     {"--box", "-1,-1,-1,+1,1e0,1"},
                                     {"--patch", "wall"},
                                     {"--field", "rho"},
                                     {"--below", "-1"},
                                     {"--size-over", "lambda"},
                                     {"--ratio", "0.5"},
                                     {"--recovered-error", "psi"},
                                     {"--target", "0.01"}});

  ASSERT_EQ(request.criteria.size(), 8U);
  EXPECT_EQ(rule<ErrorOver>(request, 7).bar, ErrorOver::Bar::target);
  EXPECT_EQ(rule<CrossingSphere>(request, 1).sphere.center, (geometry::Vec3{1, -2, 3.5}));
  EXPECT_EQ(rule<CrossingSphere>(request, 1).sphere.radius, 0.25);
  EXPECT_EQ(rule<CentroidShell>(request, 2).width, 0.1);
  EXPECT_EQ(rule<Box>(request, 3).high, (geometry::Vec3{1, 1, 1}));
  EXPECT_EQ(rule<NearPatch>(request, 4).layers, 1);
  EXPECT_EQ(rule<Threshold>(request, 5).side, mark::Side::below);
  EXPECT_EQ(rule<Threshold>(request, 5).value, -1);
  EXPECT_EQ(rule<SizeOver>(request, 6).ratio, 0.5);
}

TEST(ReadRequest, GivesASecondOptionToTheNearestFirstOneBeforeIt) {
  const auto request = read_request(
      {{"--field", "a"}, {"--above", "1"}, {"--field", "b"}, {"--below", "2"}, {"--patch", "p"}, {"--layers", "3"}});

  EXPECT_EQ(rule<Threshold>(request, 0).value, 1);
  EXPECT_EQ(rule<Threshold>(request, 1).value, 2);
  EXPECT_EQ(rule<NearPatch>(request, 2).layers, 3);
}

TEST(ReadRequest, TakesASecondOptionBeforeItsFirst) {
  const auto request = read_request({{"--above", "1"}, {"--layers", "2"}, {"--patch", "p"}, {"--field", "a"}});

  EXPECT_EQ(rule<NearPatch>(request, 0).layers, 2);
  EXPECT_EQ(rule<Threshold>(request, 1).value, 1);
}

TEST(ReadRequest, ReadsLimits) {
  const auto request = read_request({{"--all", ""},
                                     {"--max-level", "3"},
                                     {"--only-where", "a:b:above:1.5"},
                                     {"--error", "of a:2.5"},
                                     {"--only-where", "c:below:-2"},
                                     {"--error", "of c"},
                                     {"--only-where", "d:below:0"},
                                     {"--size-over", "f"},
                                     {"--ratio", "2"},
                                     {"--size", "longest-edge"}});

  EXPECT_EQ(request.max_level, 3);
  EXPECT_EQ(request.only_where.at(0).threshold.field, "a:b");
  EXPECT_EQ(request.only_where.at(0).threshold.value, 1.5);
  EXPECT_EQ(request.only_where.at(0).certainty.field, "of a");
  EXPECT_EQ(request.only_where.at(0).certainty.times, 2.5);
  EXPECT_EQ(request.only_where.at(1).threshold.side, mark::Side::below);
  EXPECT_EQ(request.only_where.at(1).certainty.field, "of c");
  EXPECT_EQ(request.only_where.at(1).certainty.times, 3);
  EXPECT_EQ(request.only_where.at(2).certainty.field, "");
  EXPECT_EQ(request.size, mark::CellSize::longest_edge);
}

TEST(ReadRequest, RefusesWhatItCannotRead) {
  const std::vector<std::vector<Given>> bad{
      {},
      {{"--max-level", "2"}},
      {{"--crossing-sphere", "0,0,0"}},
      {{"--crossing-sphere", "0,0,0,1,2"}},
      {{"--crossing-sphere", "0,0,0,-1"}},
      {{"--crossing-sphere", "0,0,x,1"}},
      {{"--crossing-sphere", "0,0,nan,1"}},
      {{"--crossing-sphere", ""}},
      {{"--box", "1,0,0,0,1,1"}},
      {{"--field", "rho"}},
      {{"--field", "rho"}, {"--above", "1"}, {"--above", "2"}},
      {{"--above", "1"}},
      {{"--all", ""}, {"--layers", "2"}},
      {{"--patch", "p"}, {"--layers", "0"}},
      {{"--patch", "p"}, {"--layers", "1.5"}},
      {{"--size-over", "f"}},
      {{"--size-over", "f"}, {"--ratio", "0"}},
      {{"--recovered-error", "f"}},
      {{"--recovered-error", "f"}, {"--bulk", "1.5"}},
      {{"--recovered-error", "f"}, {"--theta", "0"}},
      {{"--size-over", "f"}, {"--ratio", "2"}, {"--size", "big"}},
      {{"--all", ""}, {"--size", "cbrt"}},
      {{"--all", ""}, {"--min-level", "1"}},
      {{"--all", ""}, {"--keep-for", "1"}},
      {{"--all", ""}, {"--max-level", "1"}, {"--max-level", "2"}},
      {{"--centroid-shell", "0,0,0,1,-1"}},
      {{"--all", ""}, {"--max-level", "-1"}},
      {{"--all", ""}, {"--only-where", "rho:1"}},
      {{"--all", ""}, {"--only-where", "rho:over:1"}},
      {{"--all", ""}, {"--only-where", ":above:1"}},
      {{"--all", ""}, {"--error", "f"}},
      {{"--all", ""}, {"--only-where", "rho:above:1"}, {"--error", "f:-1"}},
      {{"--all", ""}, {"--only-where", "rho:above:1"}, {"--error", ":2"}},
  };
  for (const auto& given : bad)
    EXPECT_THROW(read_request(given), Error) << (given.empty() ? "nothing" : given.back().option + given.back().text);
}

TEST(MarksWithinBudget, TakesAsManyAsFit) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 2));
  mark::Indicator indicator;
  for (const auto id : mesh.cell_global) indicator.push_back(static_cast<double>(id % 5));
  std::int64_t n_predictions = 0, max_cells = 48 + 70;
  const Prediction prediction = [&](std::span<const std::uint8_t> marks) {
    ++n_predictions;
    EXPECT_LE(8 * mark::count_marked(comm, marks), max_cells) << "too many without a prediction";
    return 48 + 7 * mark::count_marked(comm, marks);
  };
  const auto marked_for = [&](std::int64_t budget) {
    max_cells = budget;
    return mark::count_marked(comm, marks_within_budget(comm, mesh, indicator, budget, prediction));
  };

  EXPECT_EQ(marked_for(1), 0);
  EXPECT_EQ(marked_for(54), 0);
  EXPECT_EQ(marked_for(55), 1);
  EXPECT_EQ(marked_for(48 + 70), 10);
  EXPECT_EQ(marked_for(48 + 76), 10);
  EXPECT_EQ(marked_for(10000), 38);  // all of the 48 whose number is no multiple of five
  EXPECT_LT(n_predictions, 6 * 8);

  max_cells = 48 + 70;
  const auto ten = marks_within_budget(comm, mesh, indicator, 48 + 70, prediction);
  double min_marked = 4, max_left = 0;
  for (std::size_t i = 0; i < ten.size(); ++i)
    (ten[i] != 0 ? min_marked : max_left) =
        ten[i] != 0 ? std::min(min_marked, indicator[i]) : std::max(max_left, indicator[i]);
  EXPECT_GE(comm.min(min_marked), comm.max(max_left));
}

}  // namespace mark_request_test
}  // namespace pamr::mark
