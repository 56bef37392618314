// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/expected_children.hpp"

#include <algorithm>
#include <bit>

#include "pamr/base/contract.hpp"

namespace pamr::mesh {

namespace {

/// Set of numbers of which some more may seem to be in it: one bit for each, at a place by hash.
class HashedBits {
 public:
  explicit HashedBits(std::size_t least_bits)
      : shift_(64U - static_cast<unsigned>(std::bit_width(std::max<std::size_t>(64, least_bits) - 1))),
        words_(std::size_t{1} << (64U - shift_ - 6U), 0) {}
  void insert(std::uint32_t id) { words_[place(id) / 64] |= std::uint64_t{1} << (place(id) % 64); }
  bool contains(std::uint32_t id) const { return (words_[place(id) / 64] >> (place(id) % 64) & 1U) != 0; }

 private:
  std::size_t place(std::uint32_t id) const { return std::uint64_t{id} * 0x9e3779b97f4a7c15U >> shift_; }

  unsigned shift_;
  std::vector<std::uint64_t> words_;
};

}  // namespace

std::vector<std::uint8_t> expected_children(std::span<const std::array<std::uint32_t, 4>> cell_to_node,
                                            std::span<const std::uint8_t> marks) {
  PAMR_EXPECTS(marks.size() == cell_to_node.size());
  HashedBits touched(8 * cell_to_node.size());
  for (std::size_t c = 0; c < marks.size(); ++c)
    if (marks[c] == 1)
      for (const auto node : cell_to_node[c]) touched.insert(node);
  constexpr std::array<std::uint8_t, 5> children{1, 1, 2, 4, 8};  // by the number of touched nodes
  std::vector<std::uint8_t> expected(marks.size());
  for (std::size_t c = 0; c < marks.size(); ++c) {
    std::size_t n = 0;
    for (const auto node : cell_to_node[c]) n += touched.contains(node) ? 1 : 0;
    expected[c] = marks[c] == 1 ? 8 : children[n];
  }
  return expected;
}

}  // namespace pamr::mesh
