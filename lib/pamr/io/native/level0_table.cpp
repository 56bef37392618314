// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/level0_table.hpp"

#include <bit>
#include <type_traits>

#include "pamr/io/native/layout.hpp"

namespace pamr::io {

namespace {

/// Calls `visit` with each number of a cell, in the order of the words.
template <class Cell, class Visit>
void each_number(Cell& cell, Visit visit) {
  const auto vector = [&](auto& v) {
    visit(v.x);
    visit(v.y);
    visit(v.z);
  };
  for (auto& node : cell.node) visit(node);
  for (auto& point : cell.corner) vector(point);
  for (auto& bulge : cell.bulge) vector(bulge);
  for (auto& patch : cell.face_patch) visit(patch);
  for (auto& patches : cell.edge_patch)
    for (auto& patch : patches) visit(patch);
  for (auto& normal : cell.beside) vector(normal);
  visit(cell.sharp_edges);
  visit(cell.creases);
  visit(cell.bent_corners);
}

}  // namespace

std::string Level0Column::path() const { return std::string(path::level0) + "/" + name; }

Level0Words words_of(const mesh::Level0Cell& cell) {
  Level0Words words{};
  auto* to = words.data();
  each_number(cell, [&](auto value) {
    if constexpr (std::is_floating_point_v<decltype(value)>)
      *to++ = std::bit_cast<std::uint64_t>(value);
    else
      *to++ = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
  });
  return words;
}

mesh::Level0Cell level0_cell_of(GlobalId row, const Level0Words& words) {
  mesh::Level0Cell cell;
  cell.row = row;
  const auto* from = words.data();
  each_number(cell, [&](auto& value) {
    using Value = std::remove_reference_t<decltype(value)>;
    if constexpr (std::is_floating_point_v<Value>)
      value = std::bit_cast<double>(*from++);
    else
      value = static_cast<Value>(static_cast<std::int64_t>(*from++));
  });
  return cell;
}

}  // namespace pamr::io
