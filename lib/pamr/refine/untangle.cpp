// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/untangle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/diagonal.hpp"
#include "pamr/refine/untangle_region.hpp"

namespace pamr::refine {

namespace {

using geometry::Vec3;

constexpr int n_tries = 8;  ///< places tried around a node in one round
constexpr int max_rounds = 400;
constexpr double first_step = 0.3;  ///< of the longest edge at a node
constexpr double last_step = 0.01;
constexpr double infinite = std::numeric_limits<double>::infinity();

constexpr double key_of(double mean_ratio) { return mean_ratio * mean_ratio * mean_ratio / 15552; }
constexpr double poor_key = key_of(poor_mean_ratio), sliding_key = key_of(sliding_mean_ratio);
constexpr double very_poor_key = key_of(very_poor_mean_ratio);
constexpr double family_scale = poor_key / key_of(parent_mean_ratio);  ///< makes families comparable with cells

/// How far nodes of the wall may move along it.
enum class Slide : std::uint8_t { none, little, far };

using Tries = std::array<double, n_tries>;

std::uint64_t hash_of(Vec3 p, int round) {
  return combine(combine(combine(static_cast<std::uint64_t>(round), bits_of(p.x)), bits_of(p.y)), bits_of(p.z));
}

/// A direction of length 1 from 63 bits.
Vec3 direction(std::uint64_t seed) {
  const auto component = [&](unsigned shift) { return static_cast<double>(seed >> shift & 0x1fffffU) * 0x1p-20 - 1.0; };
  Vec3 d{component(0), component(21), component(42)};
  const double length = geometry::norm(d);
  return length < 0.1 ? Vec3{1, 0, 0} : (1 / length) * d;
}

SplitPoints split_points(const std::array<LocalId, 10>& node, const auto& point) {
  SplitPoints p;
  for (std::size_t k = 0; k < 4; ++k) p[k] = point(node[k]);
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[e];
    p[4 + e] = node[4 + e] >= 0 ? point(node[4 + e]) : geometry::midpoint(p[at(a)], p[at(b)]);
  }
  return p;
}

/// The rounds of `untangle` on a region. `worst` of a node is the smallest key of the cells and families at it.
class Untangler {
 public:
  Untangler(const par::Comm& comm, const std::vector<Vec3>& position, const Freedom& freedom,
            const UntangleRegion& region)
      : comm_(comm), exchange_(comm, region.shared), freedom_(freedom), region_(region) {
    const auto n = region.node.size();
    position_.reserve(n);
    for (const auto node : region.node) position_.push_back(position[at(node)]);
    home_ = position_;
    for (std::size_t c = 0; c < region.cell.size(); ++c) cell_key_.push_back(key_of_cell(c));
    for (std::size_t f = 0; f < region.family.size(); ++f) family_key_.push_back(key_of_family(f));
    worst_here_.assign(n, infinite);
    std::vector<double> minus_size(n, 0), shortest(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      if (region.may_move[i] == 0) continue;
      find_worst_here(i);
      minus_size[i] = -longest_edge(i);
      shortest[i] = shortest_edge(i);
    }
    worst_ = min_over_ranks(worst_here_);
    size_ = min_over_ranks(minus_size);
    for (auto& size : size_) size = -size;
    shortest_ = min_over_ranks(std::move(shortest));
    step_.assign(n, first_step);
    row_.assign(n, -1);
  }

  /// Inner nodes move first. Wall nodes slide where that is not enough, because it spoils the shape of the wall's
  /// faces; little, and farther where a cell is still inverted when nothing else helps.
  int run() {
    int round = improve_all(Slide::none, 0);
    if (is_any_below(sliding_key)) round = improve_all(Slide::little, round);
    if (is_any_below(0)) round = improve_all(Slide::far, round);
    return round;
  }

  Vec3 position(std::size_t i) const { return position_[i]; }

 private:
  Vec3 point(LocalId i) const { return position_[at(i)]; }

  double key_of_cell(std::size_t c) const {
    const auto& corner = region_.cell[c];
    return untangle_key(geometry::TetPoints{point(corner[0]), point(corner[1]), point(corner[2]), point(corner[3])});
  }
  double key_of_family(std::size_t f) const {
    return family_scale * untangle_key(split_points(region_.family[f], [&](LocalId i) { return point(i); }));
  }

  void find_worst_here(std::size_t i) {
    double worst = infinite;
    for (const auto c : region_.cells_of_node.at(i)) worst = std::min(worst, cell_key_[at(c)]);
    for (const auto f : region_.families_of_node.at(i)) worst = std::min(worst, family_key_[at(f)]);
    worst_here_[i] = worst;
  }

  double longest_edge(std::size_t i) const {
    double longest = 0;
    for (const auto c : region_.cells_of_node.at(i))
      for (const auto j : region_.cell[at(c)]) longest = std::max(longest, geometry::norm(point(j) - position_[i]));
    return longest;
  }
  double shortest_edge(std::size_t i) const {
    double shortest = infinite;
    for (const auto c : region_.cells_of_node.at(i))
      for (const auto j : region_.cell[at(c)])
        if (at(j) != i) shortest = std::min(shortest, geometry::norm(point(j) - position_[i]));
    return shortest;
  }

  /// The smallest of the values that the ranks have for each node.
  std::vector<double> min_over_ranks(std::vector<double> value) const {
    par::fold_shared(exchange_, value, [](double& mine, double theirs) { mine = std::min(mine, theirs); });
    return value;
  }

  bool is_active(std::size_t i) const {
    if (region_.may_move[i] == 0 || step_[i] < last_step) return false;
    if (freedom_.of_node[at(region_.node[i])] == Freedom::inner) return worst_[i] < poor_key;
    return slide_ != Slide::none && worst_[i] < sliding_key;
  }

  bool is_any_below(double key) const {
    return comm_.any(std::any_of(worst_.begin(), worst_.end(), [&](double worst) { return worst <= key; }));
  }

  /// Rounds until nothing is left to try; the number of the next round.
  int improve_all(Slide slide, int round) {
    slide_ = slide;
    step_.assign(step_.size(), first_step);
    const int last = round + max_rounds;
    while (round < last && improve(round)) ++round;
    return round;
  }

  bool is_beaten_here(std::size_t i, const std::vector<std::uint64_t>& priority) const {
    for (const auto c : region_.cells_of_node.at(i))
      for (const auto j : region_.cell[at(c)])
        if (priority[at(j)] > priority[i]) return true;
    for (const auto f : region_.families_of_node.at(i))
      for (const auto j : region_.family[at(f)])
        if (j >= 0 && priority[at(j)] > priority[i]) return true;
    return false;
  }

  /// Active nodes of which no two are in one cell or family.
  std::vector<std::size_t> choose(int round) const {
    std::vector<std::uint64_t> priority(region_.node.size(), 0);
    for (std::size_t i = 0; i < priority.size(); ++i)
      if (is_active(i)) priority[i] = hash_of(position_[i], round) | 1U;
    std::vector<std::uint8_t> is_beaten(priority.size(), 0);
    for (std::size_t i = 0; i < priority.size(); ++i)
      if (priority[i] != 0 && is_beaten_here(i, priority)) is_beaten[i] = 1;
    par::fold_flags(exchange_, is_beaten);
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < priority.size(); ++i)
      if (priority[i] != 0 && is_beaten[i] == 0) chosen.push_back(i);
    return chosen;
  }

  /// The place tried; the node's own where it would leave its surfaces.
  Vec3 place_to_try(std::size_t i, int round, int attempt) const {
    const Vec3 d = direction(hash_of(position_[i], 2 * max_rounds + round * n_tries + attempt / 2));
    const double length = (attempt % 2 == 0 ? 1 : -1) * step_[i] * size_[i];
    const Vec3 wanted = position_[i] + length * d;
    const auto row = freedom_.of_node[at(region_.node[i])];
    if (row == Freedom::inner) return wanted;
    const auto placed = freedom_.on[at(row)].place(wanted);
    const bool is_near = geometry::norm(placed.point - position_[i]) <= 2 * std::abs(length);
    const double slide = longest_slide * (slide_ == Slide::far && worst_[i] <= 0 ? size_[i] : shortest_[i]);
    const bool is_at_home = geometry::norm(placed.point - home_[i]) <= slide;
    return placed.converged && is_near && is_at_home ? placed.point : position_[i];
  }

  /// What would be the worst at node `i` on this rank, were it at `p`; only to be trusted where better than now.
  double worst_at(std::size_t i, Vec3 p) {
    const Vec3 before = position_[i];
    position_[i] = p;
    double worst = infinite;
    for (const auto c : region_.cells_of_node.at(i)) {
      worst = std::min(worst, key_of_cell(at(c)));
      if (worst <= worst_[i]) break;
    }
    if (worst > worst_[i])
      for (const auto f : region_.families_of_node.at(i)) {
        worst = std::min(worst, key_of_family(at(f)));
        if (worst <= worst_[i]) break;
      }
    position_[i] = before;
    return worst;
  }

  /// One round; false when nothing is left to try on any rank.
  bool improve(int round) {
    const auto chosen = choose(round);
    if (!comm_.any(!chosen.empty())) return false;
    std::vector<std::array<Vec3, n_tries>> place(chosen.size());
    std::vector<Tries> worst(chosen.size());
    for (std::size_t n = 0; n < chosen.size(); ++n) {
      row_[chosen[n]] = static_cast<LocalId>(n);
      for (int k = 0; k < n_tries; ++k) {
        place[n][at(k)] = place_to_try(chosen[n], round, k);
        worst[n][at(k)] = worst_at(chosen[n], place[n][at(k)]);
      }
    }
    share_tries(worst);
    for (std::size_t n = 0; n < chosen.size(); ++n) {
      const auto i = chosen[n];
      const auto best = std::max_element(worst[n].begin(), worst[n].end());
      const bool is_better = *best > worst_[i];
      if (is_better) move(i, place[n][at(best - worst[n].begin())]);
      step_[i] = is_better ? std::min(first_step, 1.5 * step_[i]) : 0.6 * step_[i];
    }
    auto now = min_over_ranks(worst_here_);
    for (std::size_t i = 0; i < now.size(); ++i)
      if (row_[i] < 0 && now[i] != worst_[i]) step_[i] = std::max(step_[i], 0.1 * first_step);
    worst_ = std::move(now);
    for (const auto i : chosen) row_[i] = -1;
    return true;
  }

  void move(std::size_t i, Vec3 p) {
    position_[i] = p;
    const auto cells = region_.cells_of_node.at(i), families = region_.families_of_node.at(i);
    for (const auto c : cells) cell_key_[at(c)] = key_of_cell(at(c));
    for (const auto f : families) family_key_[at(f)] = key_of_family(at(f));
    for (const auto c : cells)
      for (const auto j : region_.cell[at(c)])
        if (region_.may_move[at(j)] != 0) find_worst_here(at(j));
    for (const auto f : families)
      for (const auto j : region_.family[at(f)])
        if (j >= 0 && region_.may_move[at(j)] != 0) find_worst_here(at(j));
  }

  void share_tries(std::vector<Tries>& worst) const {
    const auto tries_at = [&](LocalId i) {
      const auto n = row_[at(i)];
      return n < 0 ? Tries{} : worst[at(n)];
    };
    par::fold_shared(exchange_, tries_at, [&](LocalId i, const Tries& theirs) {
      const auto n = row_[at(i)];
      if (n < 0) return;
      for (std::size_t t = 0; t < n_tries; ++t) worst[at(n)][t] = std::min(worst[at(n)][t], theirs[t]);
    });
  }

  const par::Comm& comm_;
  par::Exchange exchange_;
  const Freedom& freedom_;
  const UntangleRegion& region_;
  std::vector<Vec3> position_, home_;
  std::vector<double> cell_key_, family_key_;
  std::vector<double> worst_here_, worst_;  ///< per node: of this rank's cells and families, of all ranks'
  std::vector<double> size_, shortest_;     ///< per node: its longest and shortest edge at the start
  std::vector<double> step_;                ///< per node: how far to try, in parts of its size
  Slide slide_ = Slide::none;
  std::vector<LocalId> row_;  ///< per node: its place among those chosen in this round, -1: not chosen
};

/// For each node of the level its place in `movables`, -1: none.
std::vector<LocalId> index_by_node(const NewLevel& level, const std::vector<Movable>& movables) {
  std::vector<LocalId> movable_of(level.n_nodes(), -1);
  for (std::size_t i = 0; i < movables.size(); ++i) movable_of[at(movables[i].node)] = static_cast<LocalId>(i);
  return movable_of;
}

/// Those of the moved cells that are very poor, and much better when nothing moves.
std::vector<LocalId> find_spoilt(const NewLevel& level, const std::vector<Vec3>& position, const Movement& movement) {
  std::vector<LocalId> spoilt;
  for (const auto c : movement.cells)
    if (untangle_key(level.points(c, position)) < very_poor_key) spoilt.push_back(c);
  if (spoilt.empty()) return spoilt;
  const auto movable_of = index_by_node(level, movement.nodes);
  std::erase_if(spoilt, [&](LocalId c) {
    auto p = level.points(c, position);
    const double key = untangle_key(p);
    for (std::size_t k = 0; k < 4; ++k)
      if (const auto i = movable_of[at(level.children.cell_to_node[at(c)][k])]; i >= 0)
        p[k] = movement.nodes[at(i)].base;
    return key > 0 && key >= 0.5 * untangle_key(p);
  });
  return spoilt;
}

/// Those of the cells that are poor, and members of families whose parent would be.
std::vector<LocalId> find_poor(const NewLevel& level, const std::vector<Vec3>& position,
                               const std::vector<LocalId>& cells) {
  std::vector<LocalId> poor;
  for (const auto c : cells)
    if (untangle_key(level.points(c, position)) < poor_key) poor.push_back(c);
  for (const auto first : families_of(level.children, cells)) {
    const auto parent = split_points(parent_nodes(level.children, first), [&](LocalId n) { return position[at(n)]; });
    if (family_scale * untangle_key(parent) >= poor_key) continue;
    for (LocalId c = first; c < first + level.children.lineage[at(first)].family_size(); ++c) poor.push_back(c);
  }
  return poor;
}

}  // namespace

double untangle_key(const geometry::TetPoints& p) {
  const double v = geometry::volume(p);
  double squares = 0;
  for (const auto [a, b] : mesh::tet::edge_to_corner) squares += geometry::squared_norm(p[at(a)] - p[at(b)]);
  return v > 0 ? v * v / (squares * squares * squares) : v / (squares * std::sqrt(squares));
}

double untangle_key(const SplitPoints& parent) {
  double corners = infinite, best = -infinite;
  for (int child = 0; child < 4; ++child) corners = std::min(corners, untangle_key(child_points(parent, 11, child)));
  for (int state = 11; state < 14; ++state) {
    double inner = infinite;
    for (int child = 4; child < 8; ++child) inner = std::min(inner, untangle_key(child_points(parent, state, child)));
    best = std::max(best, inner);
  }
  return std::min(corners, best);
}

Untangled untangle(const par::Comm& comm, const NewLevel& level, const std::vector<Vec3>& position, Movement movement,
                   bool is_gentle) {
  const auto poor = is_gentle ? find_spoilt(level, position, movement) : find_poor(level, position, movement.cells);
  if (!comm.any(!poor.empty())) return {std::move(movement), 0};
  const auto freedom = free_nodes(level, movement);
  const auto region = gather_region(comm, level, freedom, poor, 2);
  Untangler untangler(comm, position, freedom, region);
  const int rounds = untangler.run();
  if (rounds == 0) return {std::move(movement), 0, region.reaches_open};

  const auto movable_of = index_by_node(level, movement.nodes);
  for (std::size_t i = 0; i < region.node.size(); ++i) {
    const auto node = region.node[i];
    const auto before = position[at(node)], now = untangler.position(i);
    if (region.may_move[i] == 0 || now == before) continue;
    if (movable_of[at(node)] >= 0)
      movement.nodes[at(movable_of[at(node)])].target = now;
    else
      movement.nodes.push_back({node, before, now, {-1, -1, -1, -1}, true, false});
  }
  movement.cells = cells_with_moved_nodes(level, movement.nodes);
  return {std::move(movement), rounds, region.reaches_open};
}

}  // namespace pamr::refine
