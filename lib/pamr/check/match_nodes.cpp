// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/match_nodes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "pamr/base/hash.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/par/mailbox.hpp"

namespace pamr::check {

namespace {

using Bin = std::array<std::int64_t, 3>;

/// A node sent to where nodes of the same place meet. `id` is its number; for questions, where the answer belongs.
struct Visitor {
  Bin bin{};
  geometry::Vec3 position;
  std::int64_t id = 0;
  GlobalId but_not = unmatched;  ///< the node that is no answer to a question
};

struct Answer {
  std::int64_t index = 0;
  GlobalId match = unmatched;
  double distance = 0;
};

Rank meeting_rank(const par::Comm& comm, const Bin& bin) {
  std::uint64_t hash = 0;
  for (const auto b : bin) hash = combine(hash, static_cast<std::uint64_t>(b));
  return static_cast<Rank>(hash % static_cast<std::uint64_t>(comm.size()));
}

bool comes_before(const Visitor& a, const Visitor& b) {
  if (a.bin != b.bin) return a.bin < b.bin;
  if (a.position != b.position) return geometry::lexicographically_less(a.position, b.position);
  return a.id < b.id;
}

double largest_difference(geometry::Vec3 a, geometry::Vec3 b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

par::Received<Visitor> gather_at_bins(const par::Comm& comm, const std::vector<Visitor>& visitors) {
  par::Mailbox<Visitor> meeting(comm);
  for (const auto& visitor : visitors) meeting.add(meeting_rank(comm, visitor.bin), visitor);
  return meeting.send();
}

/// The best reference node for a question, by distance and then by number. `known` is sorted.
Answer find_best(const std::vector<Visitor>& known, const Visitor& question, double tolerance) {
  Answer best{question.id, unmatched, 0};
  Visitor from = question;
  const double lowest = std::numeric_limits<double>::lowest();
  from.position = {question.position.x - tolerance, lowest, lowest};
  from.id = std::numeric_limits<std::int64_t>::min();
  if (tolerance == 0) from.position = question.position;
  for (auto at = std::lower_bound(known.begin(), known.end(), from, comes_before); at != known.end(); ++at) {
    if (at->bin != question.bin || at->position.x > question.position.x + tolerance) break;
    const double distance = largest_difference(at->position, question.position);
    if (tolerance == 0 && distance > 0) break;
    if (distance > tolerance || at->id == question.but_not) continue;
    if (best.match == unmatched || std::tie(distance, at->id) < std::tie(best.distance, best.match))
      best = {question.id, at->id, distance};
  }
  return best;
}

/// Answers the questions of all ranks; keeps in `match` the best answer to each of this rank's.
void ask(const par::Comm& comm, const std::vector<Visitor>& reference, const std::vector<Visitor>& questions,
         double tolerance, std::vector<GlobalId>& match) {
  auto known = gather_at_bins(comm, reference).item;
  std::sort(known.begin(), known.end(), comes_before);
  const auto asked = gather_at_bins(comm, questions);
  std::vector<par::Outgoing<Answer>> answers;
  for (std::size_t r = 0; r < asked.rank.size(); ++r) {
    answers.push_back({asked.rank[r], {}});
    for (const auto& question : asked.from(r)) {
      const auto answer = find_best(known, question, tolerance);
      if (answer.match != unmatched) answers.back().item.push_back(answer);
    }
  }
  std::vector<double> distance(match.size(), 0);
  for (const auto& answer : comm.sparse_exchange(answers).item) {
    const auto i = static_cast<std::size_t>(answer.index);
    if (match[i] == unmatched || std::tie(answer.distance, answer.match) < std::tie(distance[i], match[i])) {
      match[i] = answer.match;
      distance[i] = answer.distance;
    }
  }
}

/// A bin for each place, so that only equal coordinates meet.
Bin exact_bin(geometry::Vec3 p) {
  return {static_cast<std::int64_t>(bits_of(p.x)), static_cast<std::int64_t>(bits_of(p.y)),
          static_cast<std::int64_t>(bits_of(p.z))};
}

/// Cubes that cover the box of all nodes, some tolerances wide.
struct Grid {
  geometry::Vec3 low;
  double side = 1;

  Bin bin(geometry::Vec3 p) const {
    return {static_cast<std::int64_t>(std::floor((p.x - low.x) / side)),
            static_cast<std::int64_t>(std::floor((p.y - low.y) / side)),
            static_cast<std::int64_t>(std::floor((p.z - low.z) / side))};
  }
};

Grid make_grid(const par::Comm& comm, const NodeList& a, const NodeList& b, double tolerance) {
  auto box = geometry::box_of(a.position);
  box.merge(geometry::box_of(b.position));
  box = mesh::box_over_ranks(comm, box);
  const auto size = box.size();
  const double extent = std::max({0.0, size.x, size.y, size.z});
  return {box.low, std::max(64 * tolerance, std::ldexp(extent, -20))};
}

/// `is_itself`: nodes are matched among one another, none with itself.
std::vector<GlobalId> match(const par::Comm& comm, const NodeList& reference, const NodeList& nodes, double tolerance,
                            bool is_itself) {
  std::vector<GlobalId> found(nodes.position.size(), unmatched);
  std::vector<Visitor> known, questions;
  for (std::size_t i = 0; i < reference.position.size(); ++i)
    known.push_back({exact_bin(reference.position[i]), reference.position[i], reference.number[i]});
  const auto but_not = [&](std::size_t i) { return is_itself ? nodes.number[i] : unmatched; };
  for (std::size_t i = 0; i < nodes.position.size(); ++i)
    questions.push_back({exact_bin(nodes.position[i]), nodes.position[i], static_cast<std::int64_t>(i), but_not(i)});
  ask(comm, known, questions, 0, found);
  const auto n_open = static_cast<std::int64_t>(std::count(found.begin(), found.end(), unmatched));
  if (tolerance == 0 || comm.sum(n_open) == 0) return found;

  const auto grid = make_grid(comm, reference, nodes, tolerance);
  for (auto& visitor : known) visitor.bin = grid.bin(visitor.position);
  questions.clear();
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] != unmatched) continue;
    const auto p = nodes.position[i];
    std::set<Bin> bins;  // those that a node within the tolerance may lie in
    for (const double dx : {-tolerance, tolerance})
      for (const double dy : {-tolerance, tolerance})
        for (const double dz : {-tolerance, tolerance}) bins.insert(grid.bin(p + geometry::Vec3{dx, dy, dz}));
    for (const auto& bin : bins) questions.push_back({bin, p, static_cast<std::int64_t>(i), but_not(i)});
  }
  ask(comm, known, questions, tolerance, found);
  return found;
}

}  // namespace

std::vector<GlobalId> match_nodes(const par::Comm& comm, const NodeList& reference, const NodeList& nodes,
                                  double tolerance) {
  return match(comm, reference, nodes, tolerance, false);
}

std::vector<GlobalId> match_other_nodes(const par::Comm& comm, const NodeList& nodes, double tolerance) {
  return match(comm, nodes, nodes, tolerance, true);
}

}  // namespace pamr::check
