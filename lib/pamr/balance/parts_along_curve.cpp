// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/parts_along_curve.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/order/hilbert.hpp"

namespace pamr::balance {

namespace {

constexpr unsigned key_bits = 63;
/// Weights that a round adds up over the ranks: as many bits more of the keys are looked at as these allow, at least 3.
constexpr std::size_t pieces_a_round = 4096;

unsigned bits_of_round(std::size_t n_stretches) {
  return std::max(4U, static_cast<unsigned>(std::bit_width(pieces_a_round / n_stretches))) - 1;
}

/// A family or another cell.
struct Item {
  std::uint64_t key = 0;
  std::int64_t weight = 0;
};

std::vector<Item> items_of(const mesh::DistMesh& mesh, const order::CurveGrid& grid,
                           std::span<const std::int64_t> weight) {
  std::vector<Item> items;
  items.reserve(weight.size());
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto lineage = mesh.lineage[at(c)];
    if (lineage.is_removable() && lineage.child() > 0)
      items.back().weight += weight[at(c)];
    else
      items.push_back({order::key_of(grid, mesh.points(c)), weight[at(c)]});
  }
  return items;
}

/// Where a part begins: the stretch of the curve in which that is, and what lies before it.
struct Beginning {
  std::uint64_t stretch = 0;  ///< keys `stretch << shift` and so many more
  std::int64_t before = 0;    ///< weight on the curve before the stretch
  std::int64_t wanted = 0;    ///< weight that should lie before the part
  bool is_found = false;
  std::uint64_t key = 0;  ///< the part's first one, once found
};

/// All parts' beginnings but that of the first.
class Cutter {
 public:
  Cutter(std::int64_t total, Rank n_parts) : begin_(at(n_parts - 1)), close_enough_(total / n_parts / 1000) {
    // whole shares first: the product might not fit
    for (std::int64_t b = 1; b < n_parts; ++b)
      begin_[at(b - 1)].wanted = b * (total / n_parts) + b * (total % n_parts) / n_parts;
  }

  /// Keys at which the parts but the first begin.
  std::vector<std::uint64_t> cut(const par::Comm& comm, std::vector<Item> items) {
    for (unsigned shift = key_bits; shift > 0;) {
      const auto stretches = open_stretches();
      if (stretches.empty()) break;
      const auto bits = std::min(shift, bits_of_round(stretches.size()));
      shift -= bits;
      refine(weigh(comm, stretches, items, shift, bits), stretches, shift, bits);
    }
    std::vector<std::uint64_t> keys;
    for (const auto& begin : begin_) keys.push_back(begin.key);
    return keys;
  }

 private:
  std::vector<std::uint64_t> open_stretches() const {
    std::vector<std::uint64_t> stretches;
    for (const auto& begin : begin_)
      if (!begin.is_found && (stretches.empty() || stretches.back() != begin.stretch))
        stretches.push_back(begin.stretch);
    return stretches;
  }

  /// Weight of each of the 2^bits pieces of each stretch, all ranks. Only the items on them are kept.
  static std::vector<std::int64_t> weigh(const par::Comm& comm, const std::vector<std::uint64_t>& stretches,
                                         std::vector<Item>& items, unsigned shift, unsigned bits) {
    std::vector<std::int64_t> sum(stretches.size() << bits, 0);
    std::size_t n_kept = 0;
    for (const auto item : items) {
      const auto piece = item.key >> shift;
      const auto found = std::lower_bound(stretches.begin(), stretches.end(), piece >> bits);
      if (found == stretches.end() || *found != piece >> bits) continue;
      sum[(at(found - stretches.begin()) << bits) + (piece & ((1U << bits) - 1))] += item.weight;
      items[n_kept++] = item;
    }
    items.resize(n_kept);
    comm.sum_in_place(sum);
    return sum;
  }

  void refine(const std::vector<std::int64_t>& sum, const std::vector<std::uint64_t>& stretches, unsigned shift,
              unsigned bits) {
    std::size_t s = 0;
    for (auto& begin : begin_) {
      if (begin.is_found) continue;
      while (stretches[s] != begin.stretch) ++s;
      const auto* piece = &sum[s << bits];
      const auto* const last = piece + ((std::size_t{1} << bits) - 1);
      begin.stretch <<= bits;
      for (; piece != last && begin.before + *piece <= begin.wanted; ++piece, ++begin.stretch) begin.before += *piece;
      if (shift > 0 && *piece > close_enough_) continue;
      begin.is_found = true;
      const bool is_nearer_to_the_end = 2 * (begin.wanted - begin.before) > *piece;
      begin.key = (begin.stretch + (is_nearer_to_the_end ? 1 : 0)) << shift;
    }
  }

  std::vector<Beginning> begin_;
  std::int64_t close_enough_;
};

}  // namespace

std::vector<Rank> parts_along_curve(const par::Comm& comm, const mesh::DistMesh& mesh,
                                    std::span<const std::int64_t> weight, Rank n_parts) {
  PAMR_EXPECTS(weight.size() == at(mesh.n_cells()) && n_parts >= 1);
  const auto total = comm.sum(std::accumulate(weight.begin(), weight.end(), std::int64_t{0}));
  const order::CurveGrid grid(mesh::box_over_ranks(comm, geometry::box_of(mesh.node_position)));
  const auto items = items_of(mesh, grid, weight);
  const auto begin = Cutter(total, n_parts).cut(comm, items);
  std::vector<Rank> part(weight.size());
  std::size_t item = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto lineage = mesh.lineage[at(c)];
    if (lineage.is_removable() && lineage.child() > 0) {
      part[at(c)] = part[at(c - 1)];
      continue;
    }
    const auto after = std::upper_bound(begin.begin(), begin.end(), items[item++].key);
    part[at(c)] = static_cast<Rank>(after - begin.begin());
  }
  return part;
}

}  // namespace pamr::balance
