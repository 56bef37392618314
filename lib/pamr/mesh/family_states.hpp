// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pamr/mesh/family_size_table.hpp"

namespace pamr::mesh {

/// Number of cells of a closure family by its state: 0 a regular cell; 1 + e: 1:2 on edge e; 7 + f: 1:4 on face f.
/// The order of the states is part of the file format: new ones come last.
inline constexpr const auto& family_size_of_state = detail::family_sizes;

inline constexpr int n_family_states = static_cast<int>(family_size_of_state.size());
inline constexpr int max_family_size = 7;

namespace detail {

constexpr auto make_first_codes() {
  std::array<std::uint16_t, family_size_of_state.size() + 1> first{};
  for (std::size_t s = 0; s < family_size_of_state.size(); ++s)
    first[s + 1] = static_cast<std::uint16_t>(first[s] + family_size_of_state[s]);
  return first;
}

}  // namespace detail

/// State and child of a cell are one number, its code: the children of state 0, then those of state 1, and so on.
/// `first_code[s]` is that of child 0 of state s; there is one more entry.
inline constexpr auto first_code = detail::make_first_codes();
inline constexpr int n_family_codes = first_code.back();
inline constexpr int n_code_bits = 11;
static_assert(n_family_codes <= 1 << n_code_bits);

/// What a code stands for.
struct FamilyMember {
  std::uint16_t state = 0;
  std::uint8_t child = 0;
  std::uint8_t family_size = 1;
};

namespace detail {

constexpr auto make_members() {
  std::array<FamilyMember, 1U << n_code_bits> member{};
  for (std::size_t s = 0; s < family_size_of_state.size(); ++s)
    for (std::size_t c = 0; c < family_size_of_state[s]; ++c)
      member[first_code[s] + c] = {static_cast<std::uint16_t>(s), static_cast<std::uint8_t>(c),
                                   family_size_of_state[s]};
  return member;
}

}  // namespace detail

/// Entries from `n_family_codes` on stand for nothing and are those of a regular cell.
inline constexpr auto member_of_code = detail::make_members();

}  // namespace pamr::mesh
