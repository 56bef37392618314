// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/expected_work.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/par/equal_work.hpp"

namespace pamr::balance {

namespace {

/// Set of numbers of which some more may seem to be in it: one bit for each, at a place by hash.
class HashedBits {
 public:
  explicit HashedBits(std::size_t min_bits)
      : shift_(64U - static_cast<unsigned>(std::bit_width(std::max<std::size_t>(64, min_bits) - 1))),
        words_(std::size_t{1} << (64U - shift_ - 6U), 0) {}
  void insert(GlobalId id) { words_[place(id) / 64] |= std::uint64_t{1} << (place(id) % 64); }
  bool contains(GlobalId id) const { return (words_[place(id) / 64] >> (place(id) % 64) & 1U) != 0; }

 private:
  std::size_t place(GlobalId id) const { return static_cast<std::uint64_t>(id) * 0x9e3779b97f4a7c15U >> shift_; }

  unsigned shift_;
  std::vector<std::uint64_t> words_;
};

}  // namespace

std::string work_field(const std::string& marks_field) { return marks_field + "_work"; }

void set_work(mesh::DistMesh& mesh, const std::string& marks_field,
              const std::optional<std::vector<std::uint8_t>>& work) {
  const auto name = work_field(marks_field);
  mesh::remove_field(mesh.cell_fields, name);
  if (!work) return;
  PAMR_EXPECTS(work->size() == mesh.cell_to_node.size());
  mesh.cell_fields.push_back(
      {name, "", 1, mesh::StorageType::uint8, std::vector<std::int64_t>(work->begin(), work->end())});
}

std::vector<std::uint8_t> work_from_values(std::span<const std::int64_t> values) {
  std::vector<std::uint8_t> work(values.size());
  std::transform(values.begin(), values.end(), work.begin(),
                 [](std::int64_t value) { return static_cast<std::uint8_t>(std::clamp<std::int64_t>(value, 1, 255)); });
  return work;
}

std::vector<std::uint8_t> work_from_marks(std::span<const std::array<GlobalId, 4>> cell_to_node,
                                          std::span<const std::int64_t> marks) {
  PAMR_EXPECTS(marks.size() == cell_to_node.size());
  HashedBits touched(8 * cell_to_node.size());
  for (std::size_t c = 0; c < marks.size(); ++c)
    if (marks[c] == 1)
      for (const auto node : cell_to_node[c]) touched.insert(node);
  constexpr std::array<std::uint8_t, 5> children{1, 1, 2, 4, 8};  // by the number of touched nodes
  std::vector<std::uint8_t> work(marks.size());
  for (std::size_t c = 0; c < marks.size(); ++c) {
    std::size_t n = 0;
    for (const auto node : cell_to_node[c]) n += touched.contains(node) ? 1 : 0;
    work[c] = marks[c] == 1 ? 8 : children[n];
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
