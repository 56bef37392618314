// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_floor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

namespace pamr::test {

namespace {

using geometry::Vec3;
using mesh::tet::edge_to_corner;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

using Ends = std::array<Vec3, 2>;

Ends sorted(Vec3 a, Vec3 b) { return geometry::lexicographically_less(b, a) ? Ends{b, a} : Ends{a, b}; }
Ends ends_of(const geometry::TetPoints& corner, int e) {
  return sorted(corner[at(edge_to_corner[at(e)][0])], corner[at(edge_to_corner[at(e)][1])]);
}
bool comes_first(const Ends& p, const Ends& q) {
  return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end(), geometry::lexicographically_less);
}

/// To 40 significant binary digits, halves up.
double rounded(double x) {
  int exponent = 0;
  const double fraction = std::frexp(x, &exponent);
  return std::ldexp(std::floor(std::ldexp(fraction, 40) + 0.5), exponent - 40);
}

double rounded_length(const geometry::TetPoints& corner, int e) {
  const auto d = corner[at(edge_to_corner[at(e)][1])] - corner[at(edge_to_corner[at(e)][0])];
  return rounded((d.x * d.x + d.y * d.y) + d.z * d.z);
}

constexpr double no_triangulation = -2;  // below all mean ratios

bool holds(EdgeSet large, EdgeSet small) { return common(large, small) == small; }

/// The mean ratio of a cell between nodes of a split cell. The volume of a flat cell is lost in rounding; what is
/// compared are cells within one, so it is the same number in all of them.
double mean_ratio_within(const geometry::TetPoints& corner, const std::array<Code, 4>& codes) {
  std::array<Vec3, 4> p{};
  for (std::size_t i = 0; i < 4; ++i) {
    p[i] = corner[at(codes[i] % 4)];
    if (codes[i] < 4) continue;
    const auto [a, b] = edge_to_corner[at(codes[i] - 4)];
    p[i] = geometry::midpoint(corner[at(a)], corner[at(b)]);
  }
  double sum = 0;
  for (const auto& [a, b] : edge_to_corner) sum += geometry::squared_norm(p[at(a)] - p[at(b)]);
  const double volume = geometry::volume(corner) * (static_cast<double>(eighths_of_volume(codes)) / 8);
  return std::copysign(12 * std::pow(3 * std::abs(volume), 2.0 / 3) / sum, volume);
}

double worst_within(const geometry::TetPoints& corner, const ReferencePattern& pattern) {
  double worst = 1;
  for (const auto& child : pattern.child) worst = std::min(worst, mean_ratio_within(corner, child));
  return worst;
}

std::vector<EdgeSet> subsets_of(EdgeSet marks) {
  std::vector<EdgeSet> subsets{{}};
  for (const int e : marks)
    for (std::size_t i = 0, n = subsets.size(); i < n; ++i) {
      subsets.push_back(subsets[i]);
      subsets.back().insert(e);
    }
  return subsets;
}

}  // namespace

bool is_longer(const geometry::TetPoints& corner, int e, int f) {
  const double of_e = rounded_length(corner, e), of_f = rounded_length(corner, f);
  return of_e != of_f ? of_e > of_f : comes_first(ends_of(corner, e), ends_of(corner, f));
}

ReferenceFloor::ReferenceFloor(const geometry::TetPoints& corner, double floor, const ReferenceFamily* family,
                               const std::optional<MiddlePoints>& middle)
    : corner_(corner), middle_(middle), floor_(floor) {
  if (family == nullptr) return;
  family_marks_ = family->pattern.marks;
  family_cuts_ = family->pattern.cut;
}

Cuts ReferenceFloor::cuts_of(EdgeSet marks) const {
  Cuts cuts;
  for (int face = 0; face < 4; ++face) {
    const auto two = common(marks, edges_of_face(face));
    if (two.size() != 2) continue;
    const bool stays = common(family_marks_, edges_of_face(face)) == two;
    const int first = *two.begin(), second = *std::next(two.begin());
    cuts[face] = stays ? family_cuts_.at(face) : is_longer(corner_, first, second) ? first : second;
  }
  return cuts;
}

double ReferenceFloor::mean_ratio_of(const std::array<Code, 4>& codes) const {
  if (!middle_) return mean_ratio_within(corner_, codes);
  geometry::TetPoints p{};
  for (std::size_t i = 0; i < 4; ++i) p[i] = codes[i] < 4 ? corner_[at(codes[i])] : (*middle_)[at(codes[i] - 4)];
  return geometry::mean_ratio(p);
}

double ReferenceFloor::quality_of_eight() const {
  auto cell = halve(corner_, all_six);  // names its nodes by code
  if (middle_) std::copy(middle_->begin(), middle_->end(), cell.point.begin() + 4);
  double worst = 1;
  for (const auto& child : split_in_eight(cell.piece, cell.middle, cell.point, middle_.has_value())) {
    std::array<Code, 4> codes{};
    std::copy(child.corner.begin(), child.corner.end(), codes.begin());
    worst = std::min(worst, mean_ratio_of(codes));
  }
  return worst;
}

double ReferenceFloor::quality(EdgeSet marks) {
  const auto [known, is_new] = quality_.emplace(marks, no_triangulation);
  if (!is_new) return known->second;
  if (marks == all_six) return known->second = quality_of_eight();
  for (const auto& pattern : patterns_of(marks, cuts_of(marks))) {
    double worst = 1;
    for (const auto& child : pattern.child) worst = std::min(worst, mean_ratio_of(child));
    known->second = std::max(known->second, worst);
  }
  return known->second;
}

/// Where 1:8 itself has an inverted cell nothing better can be asked for.
bool ReferenceFloor::is_good(EdgeSet marks) {
  if (marks.empty() || marks == all_six) return true;
  const double q = quality(marks);
  if (q == no_triangulation) return false;
  const double of_eight = quality(all_six);
  return floor_ == 0 || !(of_eight > 0) || q >= std::min(floor_, of_eight) * (1 - 0x1p-40);
}

/// The edges that a has more than the marks come before those that b has more.
bool ReferenceFloor::added_comes_first(EdgeSet a, EdgeSet b, EdgeSet marks) const {
  const auto added = [&](EdgeSet set) {
    std::vector<Ends> edges;
    for (const int e : set)
      if (marks.count(e) == 0) edges.push_back(ends_of(corner_, e));
    std::sort(edges.begin(), edges.end(), comes_first);
    return edges;
  };
  const auto of_a = added(a), of_b = added(b);
  return std::lexicographical_compare(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), comes_first);
}

EdgeSet ReferenceFloor::implied(EdgeSet marks) {
  if (is_good(marks)) return marks;
  const auto known = implied_.find(marks);
  if (known != implied_.end()) return known->second;
  static const auto all_sets = subsets_of(all_six);
  std::vector<EdgeSet> good;
  std::size_t fewest = 6;
  for (const auto& set : all_sets)
    if (holds(set, marks) && is_good(set)) {
      good.push_back(set);
      fewest = std::min(fewest, set.size());
    }
  std::erase_if(good, [&](const auto& set) { return set.size() != fewest; });
  double best = no_triangulation;
  for (const auto& set : good) best = std::max(best, quality(set));
  std::erase_if(good, [&](const auto& set) { return quality(set) < best - std::abs(best) * 0x1p-40; });
  return implied_[marks] = *std::min_element(
             good.begin(), good.end(), [&](const auto& a, const auto& b) { return added_comes_first(a, b, marks); });
}

EdgeSet ReferenceFloor::enlarge(EdgeSet marks) {
  if (!(geometry::volume(corner_) > 0)) return marks;
  const auto known = enlarged_.find(marks);
  if (known != enlarged_.end()) return known->second;
  auto larger = marks;
  for (std::size_t before = larger.size() + 1; before != larger.size();) {
    before = larger.size();
    for (const auto& subset : subsets_of(larger)) larger.merge(implied(subset));
  }
  return enlarged_[marks] = larger;
}

std::optional<ReferencePattern> best_pattern(const Piece& piece, const Middles& middle, const Cuts& cut,
                                             const Points& point, const Points* gone_back) {
  struct Candidate {
    ReferencePattern pattern;
    double worst = 0;
    Ends inner{};
  };
  std::vector<Candidate> candidates;
  for (const auto& pattern : patterns_of(edges_within(piece, middle), cut)) {
    const auto children = split_as(piece, middle, pattern);
    if (gone_back != nullptr && !(all_positive(children, point) && all_positive(children, *gone_back))) continue;
    const bool where_they_lie = gone_back != nullptr || piece.row >= 0;
    const double worst =
        where_they_lie ? worst_mean_ratio(children, point) : worst_within(points_of(piece, point), pattern);
    Candidate candidate{pattern, worst, {}};
    if (const int e = pattern.inner_edge; e >= 0)
      candidate.inner = sorted(point[at(middle.at(piece.edge(e)))], point[at(middle.at(piece.edge(5 - e)))]);
    candidates.push_back(candidate);
  }
  if (candidates.empty()) return std::nullopt;
  double best = -1;  // inverted cells have negative mean ratios
  for (const auto& candidate : candidates) best = std::max(best, candidate.worst);
  std::erase_if(candidates, [&](const Candidate& c) { return c.worst < best - std::abs(best) * 0x1p-40; });
  return std::min_element(candidates.begin(), candidates.end(),
                          [](const Candidate& a, const Candidate& b) {
                            const bool a_has = a.pattern.inner_edge >= 0, b_has = b.pattern.inner_edge >= 0;
                            return a_has != b_has ? b_has : comes_first(a.inner, b.inner);
                          })
      ->pattern;
}

}  // namespace pamr::test
