// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/elements/boundary_rows.hpp"

#include <charconv>
#include <limits>
#include <set>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::io {

std::vector<BoundaryRow> boundary_rows(const RowsInOrder& rows) {
  std::vector<BoundaryRow> result;
  for (std::size_t c = 0; c < rows.group.size(); ++c)
    for (std::size_t slot = 0; slot < 4; ++slot) {
      if (rows.group[c][slot] < 0) continue;
      const auto& corner = mesh::tet::face_to_corner[slot];
      const auto& n = rows.cell_to_node[c];
      result.push_back({{n[at(corner[0])], n[at(corner[1])], n[at(corner[2])]}, rows.group[c][slot]});
    }
  return result;
}

std::vector<std::int64_t> patch_numbers(const std::vector<std::string>& names, std::string_view prefix,
                                        std::int64_t first, const std::vector<std::int64_t>& own,
                                        std::int64_t first_free) {
  std::vector<std::int64_t> numbers(names.size(), -1);
  std::set<std::int64_t> taken;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (own[i] >= first && own[i] <= std::numeric_limits<std::int32_t>::max() && taken.insert(own[i]).second)
      numbers[i] = own[i];
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& name = names[i];
    auto& number = numbers[i];
    if (number < 0 && name.starts_with(prefix) && name.size() <= prefix.size() + 9) {
      const auto* end = name.data() + name.size();
      const auto [rest, error] = std::from_chars(name.data() + prefix.size(), end, number);
      if (error != std::errc{} || rest != end || number < first || !taken.insert(number).second) number = -1;
    }
  }
  auto next = first_free;
  for (auto& number : numbers) {
    if (number >= 0) continue;
    while (!taken.insert(next).second) ++next;
    number = next;
  }
  return numbers;
}

}  // namespace pamr::io
