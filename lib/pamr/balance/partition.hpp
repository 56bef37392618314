// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// How the cells are spread.
enum class Method : std::uint8_t {
  none,    ///< they stay where they are
  scotch,  ///< PT-Scotch on the graph of cell neighbors: few faces between parts
  blocks,  ///< runs of cells in global order: cheap, as good as that order is local
  best,    ///< runs where these cut few faces, else PT-Scotch: for meshes that are soon written in global order
};

/// Their names on command lines and in reports.
inline constexpr std::array<std::pair<const char*, Method>, 4> method_names{
    {{"auto", Method::best}, {"scotch", Method::scotch}, {"blocks", Method::blocks}, {"none", Method::none}}};
/// The method of that name. Throws `Error` for any other name.
Method method_named(std::string_view name);
const char* name_of(Method method);

struct Options {
  Method method = Method::scotch;
  /// Leave everything where it is while max/mean of the weights is at most this. Below 1: always move.
  double keep_below = 1.02;
  /// What Scotch is asked for: allowed excess of a part over the mean, as a fraction.
  double tolerance = 0.01;
  /// Where Scotch's parts still exceed the mean by this factor, runs of cells are taken instead if they are better.
  double worst_accepted = 1.05;
  /// Vertices of the graph that Scotch gets for each part: so many groups of cells that lie together. The borders
  /// between the parts are smoothed cell by cell afterwards. More cut fewer faces and take longer. 0: every cell and
  /// every closure family is a vertex.
  Exact<std::int64_t> vertices_per_part = 500;
  /// `best` takes runs that cut at most this many times the faces that compact parts would have between them. Along a
  /// space-filling curve it is 1 to 1.5, where cells lie in no order far more.
  double runs_accepted = 2;
};

/// How good a distribution of cells over parts is. The same on every rank.
struct Quality {
  double imbalance = 1;            ///< greatest weight of a part / mean
  std::int64_t edge_cut = 0;       ///< faces between cells of different parts
  std::int64_t max_neighbors = 0;  ///< parts that share a face with one part: the most
  double mean_neighbors = 0;       ///< mean of the same
  std::int64_t empty_parts = 0;    ///< parts without cells
};

/// Looks at `part` (0 .. n_parts-1), the part of each of this rank's cells. Collective: one neighbor exchange, one
/// sparse exchange of 8 bytes a pair of adjacent parts that a rank sees, reductions of n_parts integers.
Quality measure(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                std::span<const Rank> part, Exact<Rank> n_parts);

/// The same for the distribution over the ranks that the mesh has, part by rank; faster: from the rank borders alone.
/// `weight_here`: of this rank's cells together. Collective: four reductions.
Quality measure_ranks(const par::Comm& comm, const mesh::DistMesh& mesh, Exact<std::int64_t> weight_here);

struct Partition {
  std::vector<Rank> part;        ///< of each of this rank's cells; whole families in one part
  Method method = Method::none;  ///< what gave it: `none` when all was kept, `blocks` also where Scotch was no use
  Quality quality;
};

/// Spreads the cells over `n_parts` parts of equal weight. `weight`: positive, one for each cell of this rank, of sum
/// at most `max_total_weight`. Where there are as many parts as ranks, parts bear the number of the rank that holds
/// most of them already, so that few cells move, and `keep_below` holds. A mesh with too few families for Scotch to
/// choose from is cut into runs. More parts than cells leave parts empty. Collective. Cost: O(cells / ranks) and Scotch
/// on `vertices_per_part * n_parts` vertices.
Partition partition(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                    Exact<Rank> n_parts, const Options& options = {});

}  // namespace pamr::balance
