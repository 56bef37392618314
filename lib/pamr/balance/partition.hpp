// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/balance/quality.hpp"
#include "pamr/base/exact.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// How the cells are spread.
enum class Method : std::uint8_t {
  none,    ///< they stay where they are
  scotch,  ///< PT-Scotch on the graph of cell neighbors: few faces between parts; the curve in builds without it
  blocks,  ///< runs of cells in global order: cheap, as good as that order is local
  best,    ///< runs or pieces of the curve if these are good enough and cheaper than PT-Scotch, else PT-Scotch
  curve,   ///< pieces of Hilbert's curve through the cells: cheap whatever their order, more faces than Scotch's
};

/// Their names on command lines and in reports.
inline constexpr std::array<std::pair<const char*, Method>, 5> method_names{{{"auto", Method::best},
                                                                             {"scotch", Method::scotch},
                                                                             {"curve", Method::curve},
                                                                             {"blocks", Method::blocks},
                                                                             {"none", Method::none}}};
/// The method of that name. Throws `Error` for any other name.
Method method_named(std::string_view name);
const char* name_of(Method method);
/// A line for users who ask for a method that this build does not have, and what stands in for it; empty for others.
std::string what_stands_in(Method method);

struct Options {
  Method method = Method::scotch;
  /// Everything may stay where it is while max/mean of the weights is at most this. Below 1: cells always move.
  double keep_below = 1.02;
  /// ... and while there are at most this many times the faces between ranks that compact parts would have. `blocks`
  /// does not ask for that.
  double max_cut = 1.5;
  /// How often the mesh will be worked through before its cells are spread anew, in passes that cost what refining it
  /// costs: by it `best` knows what PT-Scotch's fewer faces are worth.
  double passes = 1;
  /// What Scotch is asked for: allowed excess of a part over the mean, as a fraction.
  double tolerance = 0.01;
  /// Where Scotch's parts still exceed the mean by this factor, or `max_cut`, pieces of the curve are taken if they are
  /// better.
  double worst_accepted = 1.05;
  /// Vertices of the graph that Scotch gets for each part: so many groups of cells that lie together. The borders
  /// between the parts are smoothed cell by cell afterwards. More cut fewer faces and take longer. 0: every cell and
  /// every closure family is a vertex; so it is, too, where there are more than 4 times the faces of compact parts
  /// between the ranks: cells of a rank that lie apart make no groups.
  Exact<std::int64_t> vertices_per_part = 500;
};

struct Partition {
  std::vector<Rank> part;        ///< of each of this rank's cells; whole families in one part
  Method method = Method::none;  ///< what gave it: `none` when all was kept, also `curve` where Scotch was no use
  Quality quality;
};

/// Spreads the cells over `n_parts` parts of equal weight. `weight`: positive, one for each cell of this rank, of sum
/// at most `max_total_weight`. More parts than cells leave parts empty. A mesh with too few families for Scotch to
/// choose from is cut along the curve.
///
/// Where there are as many parts as ranks, parts bear the number of the rank that holds most of them already, so that
/// few cells move, and unless `keep_below` is below 1 this is the rule, whatever the weights mean:
/// 1. All stays where it is while the ranks are within `keep_below` (or the heaviest family, which no part can be
///    below) and `max_cut`.
/// 2. Else parts are made by the method. `best` takes runs of cells in global order if the ranks hold such and these
///    meet both, else pieces of the curve; but PT-Scotch if these are not even, or if it is expected to cost less in
///    all (`price.hpp`).
/// 3. Cells move to them if they meet both, or if a pass over the mesh gets at least a hundredth cheaper.
/// Collective. Cost: a few reductions for 1; O(cells / ranks), and Scotch on `vertices_per_part * n_parts` vertices.
Partition partition(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                    Exact<Rank> n_parts, const Options& options = {});

}  // namespace pamr::balance
