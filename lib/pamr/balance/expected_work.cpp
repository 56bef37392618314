// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/expected_work.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/equal_work.hpp"

namespace pamr::balance {

namespace {

/// Set of edges, by their two nodes, of which some more may seem to be in it: one bit for each, at a place by hash.
class HashedEdges {
 public:
  explicit HashedEdges(std::size_t min_bits)
      : shift_(64U - static_cast<unsigned>(std::bit_width(std::max<std::size_t>(4096, min_bits) - 1))),
        words_(std::size_t{1} << (64U - shift_ - 6U), 0) {}
  void insert(GlobalId a, GlobalId b) { words_[place(a, b) / 64] |= std::uint64_t{1} << (place(a, b) % 64); }
  bool contains(GlobalId a, GlobalId b) const { return (words_[place(a, b) / 64] >> (place(a, b) % 64) & 1U) != 0; }

 private:
  std::size_t place(GlobalId a, GlobalId b) const {
    const auto low = static_cast<std::uint64_t>(std::min(a, b)), high = static_cast<std::uint64_t>(std::max(a, b));
    return combine(low, high) >> shift_;
  }

  unsigned shift_;
  std::vector<std::uint64_t> words_;
};

/// Eighths of a cell that come of a cell by the number of its edges that marked cells have: of a regular cell, and of
/// each member of a closure family without marks by the edges of the one that has most. Means over refinements of a
/// cone by the marks of a flow.
constexpr std::array<std::uint8_t, 7> of_regular{8, 17, 27, 34, 46, 56, 64}, of_member{10, 18, 21, 25, 27, 29, 32};
constexpr std::uint8_t of_marked = 64, of_marked_member = 40;

/// Of each cell how many of its edges are edges of marked ones.
std::vector<std::uint8_t> count_marked_edges(std::span<const std::array<GlobalId, 4>> cell_to_node,
                                             std::span<const std::int64_t> marks) {
  const auto n_marked = static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 1));
  HashedEdges edges(std::min(512 * n_marked, 64 * cell_to_node.size()));
  const auto for_each_edge = [&](std::size_t c, auto visit) {
    for (const auto [p, q] : mesh::tet::edge_to_corner)
      visit(cell_to_node[c][static_cast<std::size_t>(p)], cell_to_node[c][static_cast<std::size_t>(q)]);
  };
  for (std::size_t c = 0; c < marks.size(); ++c)
    if (marks[c] == 1) for_each_edge(c, [&](GlobalId a, GlobalId b) { edges.insert(a, b); });
  std::vector<std::uint8_t> count(marks.size(), 6);
  for (std::size_t c = 0; c < marks.size(); ++c) {
    if (marks[c] == 1) continue;
    count[c] = 0;
    for_each_edge(c, [&, n = &count[c]](GlobalId a, GlobalId b) {
      if (edges.contains(a, b)) ++*n;
    });
  }
  return count;
}

/// The cells behind `first` that belong to its family, if it is the first one of it that there is.
std::size_t end_of_family(std::span<const mesh::Lineage> lineage, std::size_t first) {
  auto end = first + 1;
  for (; end < lineage.size() && lineage[end].state() == lineage[first].state() &&
         lineage[end].child() == lineage[first].child() + static_cast<int>(end - first);)
    ++end;
  return end;
}

}  // namespace

std::string work_field(const std::string& marks_field) { return marks_field + "_work"; }

void set_work(mesh::DistMesh& mesh, const std::string& marks_field,
              const std::optional<std::vector<std::uint8_t>>& work) {
  const auto name = work_field(marks_field);
  mesh::remove_field(mesh.cell_fields, name);
  if (!work) return;
  PAMR_EXPECTS(work->size() == mesh.cell_to_node.size());
  mesh.cell_fields.push_back({name, "", 1, work_type, std::vector<std::int64_t>(work->begin(), work->end())});
}

std::vector<std::uint8_t> work_from_values(std::span<const std::int64_t> values) {
  std::vector<std::uint8_t> work(values.size());
  std::transform(values.begin(), values.end(), work.begin(),
                 [](std::int64_t value) { return static_cast<std::uint8_t>(std::clamp<std::int64_t>(value, 1, 255)); });
  return work;
}

std::vector<std::uint8_t> work_from_marks(std::span<const std::array<GlobalId, 4>> cell_to_node,
                                          std::span<const std::int64_t> marks, std::span<const mesh::Lineage> lineage) {
  PAMR_EXPECTS(marks.size() == cell_to_node.size() && (lineage.empty() || lineage.size() == marks.size()));
  auto work = count_marked_edges(cell_to_node, marks);
  for (std::size_t c = 0; c < work.size();) {
    if (lineage.empty() || !lineage[c].is_removable()) {
      work[c] = marks[c] == 1 ? of_marked : of_regular[work[c]];
      ++c;
      continue;
    }
    const auto end = end_of_family(lineage, c);
    const auto most = *std::max_element(&work[c], &work[c] + (end - c));
    const bool any_marked = std::find(&marks[c], &marks[c] + (end - c), 1) != &marks[c] + (end - c);
    for (; c < end; ++c) work[c] = any_marked ? of_marked_member : of_member[most];
  }
  return work;
}

GlobalId first_cell_of_run(const par::Comm& comm, std::span<const std::uint8_t> work) {
  std::vector<std::int64_t> n_cells(at(comm.size()), 0);  // of each run
  for (const auto run : par::runs_of_equal_work(comm, work, comm.size())) ++n_cells[at(run)];
  comm.sum_in_place(n_cells);
  return std::accumulate(n_cells.begin(), n_cells.begin() + comm.rank(), GlobalId{0});
}

}  // namespace pamr::balance
