// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/read_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/io/native/lineage_word.hpp"
#include "pamr/mesh/families.hpp"

namespace pamr::io {

namespace {

std::string text_of(std::uint64_t word) { return fmt::format("{}", static_cast<std::int64_t>(word)); }

/// Families are whole, contiguous and in template order. Cells of broken families count as single cells.
void check_families(const SlabReader& reader, const std::vector<mesh::Lineage>& lineage, GlobalId first_cell) {
  const auto n = lineage.size();
  for (std::size_t c = 0; c < n;) {
    const auto first = lineage[c];
    const auto size = first.is_removable() ? at(first.family_size()) : std::size_t{1};
    for (std::size_t k = 0; size > 1 && k < size; ++k) {
      const auto expected = mesh::sibling(first, static_cast<int>(k));
      if (c + k >= n || lineage[c + k] != expected)
        reader.fail(path::lineage, first_cell + static_cast<GlobalId>(c + k),
                    fmt::format("child {} of a family of {}, {}", k, size, mesh::describe(expected)),
                    c + k >= n ? "the end of the dataset" : mesh::describe(lineage[c + k]));
    }
    c += size;
  }
}

}  // namespace

GlobalId family_border(SlabReader& reader, const Layout& layout, GlobalId cell) {
  const auto n = layout.info.n_global_cells;
  GlobalId border = cell;
  reader.each_slab({path::lineage, layout.lineage_type, {n, 1, true}}, {cell, std::min(cell + 1, n)}, false,
                   [&](GlobalId, std::span<const std::uint64_t> words) {
                     if (words.empty()) return;
                     const auto lineage = lineage_of_word(layout.format, words[0]);
                     if (lineage && lineage->is_removable() && lineage->child() != 0)
                       border = cell + lineage->family_size() - lineage->child();
                   });
  return std::min(border, n);
}

std::vector<mesh::Lineage> read_lineage(SlabReader& reader, const Layout& layout, Rows cells) {
  std::vector<mesh::Lineage> result;
  if (!layout.has_lineage) return result;
  reserve_array(result, at(cells.count()));
  reader.each_slab({path::lineage, layout.lineage_type, {layout.info.n_global_cells, 1, true}}, cells, true,
                   [&](GlobalId first, std::span<const std::uint64_t> words) {
                     for (std::size_t i = 0; i < words.size(); ++i) {
                       const auto lineage = lineage_of_word(layout.format, words[i]);
                       if (!lineage)
                         reader.fail(path::lineage, first + static_cast<GlobalId>(i),
                                     fmt::format("a lineage word as format {} specifies", layout.format),
                                     fmt::format("{}", words[i]));
                       result.push_back(*lineage);
                     }
                   });
  par::agree(reader.comm(), [&] { check_families(reader, result, cells.begin); });
  return result;
}

std::vector<mesh::Lineage> read_lineage_unchecked(SlabReader& reader, const Layout& layout, Rows cells) {
  std::vector<mesh::Lineage> result;
  if (!layout.has_lineage) return result;
  reserve_array(result, at(cells.count()));
  reader.each_slab({path::lineage, layout.lineage_type, {layout.info.n_global_cells, 1, true}}, cells, false,
                   [&](GlobalId, std::span<const std::uint64_t> words) {
                     for (const auto word : words)
                       result.push_back(lineage_of_word(layout.format, word).value_or(mesh::Lineage()));
                   });
  return result;
}

void check_offsets_and_types(SlabReader& reader, const Layout& layout, Rows cells) {
  const auto n = layout.info.n_global_cells;
  const auto& comm = reader.comm();
  const bool is_last = comm.rank() == comm.size() - 1;
  reader.each_slab({path::offsets, layout.offsets_type, {n + 1, 1, true}}, {cells.begin, is_last ? n + 1 : cells.end},
                   true, [&](GlobalId first, std::span<const std::uint64_t> words) {
                     for (std::size_t i = 0; i < words.size(); ++i) {
                       const auto row = first + static_cast<GlobalId>(i);
                       if (words[i] != static_cast<std::uint64_t>(4 * row))
                         reader.fail(path::offsets, row, fmt::format("{}", 4 * row), text_of(words[i]));
                     }
                   });
  reader.each_slab({path::types, layout.types_type, {n, 1, true}}, cells, true,
                   [&](GlobalId first, std::span<const std::uint64_t> words) {
                     for (std::size_t i = 0; i < words.size(); ++i)
                       if (words[i] != tetrahedron)
                         reader.fail(path::types, first + static_cast<GlobalId>(i), "cell type 10 (tetrahedron)",
                                     text_of(words[i]));
                   });
}

std::vector<std::array<GlobalId, 4>> read_connectivity(SlabReader& reader, const Layout& layout, Rows cells,
                                                       bool verify) {
  const auto n_nodes = static_cast<std::uint64_t>(layout.info.n_global_nodes);
  std::vector<std::array<GlobalId, 4>> result;
  assign_array(result, at(cells.count()), {});
  reader.each_slab({path::connectivity, layout.connectivity_type, {4 * layout.info.n_global_cells, 1, true}},
                   {4 * cells.begin, 4 * cells.end}, verify, [&](GlobalId first, std::span<const std::uint64_t> words) {
                     auto* cell = result.data() + (first / 4 - cells.begin);
                     for (std::size_t row = 0; row < words.size(); row += 4, ++cell)
                       for (std::size_t i = 0; i < 4; ++i) {
                         const auto word = words[row + i];
                         if (word >= n_nodes)
                           reader.fail(path::connectivity, first + static_cast<GlobalId>(row + i),
                                       fmt::format("a node from 0 to {}", n_nodes - 1), text_of(word));
                         (*cell)[i] = layout.info.first_id + static_cast<GlobalId>(word);
                       }
                   });
  return result;
}

void check_corners(SlabReader& reader, const Layout& layout, Rows cells,
                   const std::vector<std::array<GlobalId, 4>>& cell_to_node) {
  par::agree(reader.comm(), [&] {
    for (std::size_t c = 0; c < cell_to_node.size(); ++c) {
      auto corners = cell_to_node[c];
      if (corners[0] != corners[1] && corners[0] != corners[2] && corners[0] != corners[3] &&
          corners[1] != corners[2] && corners[1] != corners[3] && corners[2] != corners[3])
        continue;
      std::sort(corners.begin(), corners.end());
      const auto twice = std::adjacent_find(corners.begin(), corners.end());
      reader.fail(path::connectivity, 4 * (cells.begin + static_cast<GlobalId>(c)), "four different nodes",
                  fmt::format("node {} twice", *twice - layout.info.first_id));
    }
  });
}

std::vector<std::array<GlobalId, 4>> read_neighbors(SlabReader& reader, const Layout& layout, Rows cells) {
  std::vector<std::array<GlobalId, 4>> result;
  if (!layout.has_neighbors) return result;
  const auto all = layout.info.cell_ids();
  const auto n_patches = static_cast<std::int64_t>(layout.info.patches.size());
  assign_array(result, at(cells.count()), {});
  reader.each_slab({path::cell_to_cell, layout.neighbors_type, {all.n, 4, false}}, cells, true,
                   [&](GlobalId first, std::span<const std::uint64_t> words) {
                     for (auto row = first; !words.empty(); words = words.subspan(4), ++row) {
                       auto& cell = result[at(row - cells.begin)];
                       for (std::size_t i = 0; i < 4; ++i) {
                         const auto value = static_cast<std::int64_t>(words[i]);
                         if (!all.contains(value) && (value >= 0 || value < -n_patches))
                           reader.fail(path::cell_to_cell, row,
                                       fmt::format("a cell from {} to {} or a patch from -1 to -{}", all.first,
                                                   all.end() - 1, n_patches),
                                       fmt::format("{}", value));
                         if (value == all.first + row)
                           reader.fail(path::cell_to_cell, row, "another cell", "the cell itself");
                         cell[i] = value;
                       }
                     }
                   });
  return result;
}

mesh::BoundaryTriangles read_boundary(SlabReader& reader, const Layout& layout) {
  mesh::BoundaryTriangles result;
  const auto n = layout.n_triangles;
  if (n == 0) return result;
  const auto range = par::block_range(n, reader.comm().rank(), reader.comm().size());
  const Rows rows{range.begin, range.end};
  result.node.resize(at(rows.count()));
  const auto word_in = [&](const char* path, GlobalId row, std::uint64_t word, GlobalId n_values, const char* what) {
    if (word >= static_cast<std::uint64_t>(n_values))
      reader.fail(path, row, fmt::format("a {} from 0 to {}", what, n_values - 1), text_of(word));
    return static_cast<GlobalId>(word);
  };
  reader.each_slab({path::boundary_triangles, layout.triangles_type, {n, 3, false}}, rows, true,
                   [&](GlobalId first, std::span<const std::uint64_t> words) {
                     for (std::size_t i = 0; i < words.size(); ++i) {
                       const auto row = first + static_cast<GlobalId>(i / 3);
                       const auto node =
                           word_in(path::boundary_triangles, row, words[i], layout.info.n_global_nodes, "node");
                       result.node[at(row - rows.begin)][i % 3] = layout.info.first_id + node;
                     }
                   });
  reader.each_slab({path::boundary_patch, layout.triangle_patch_type, {n, 1, true}}, rows, true,
                   [&](GlobalId first, std::span<const std::uint64_t> words) {
                     for (std::size_t i = 0; i < words.size(); ++i)
                       result.patch.push_back(
                           static_cast<int>(word_in(path::boundary_patch, first + static_cast<GlobalId>(i), words[i],
                                                    static_cast<GlobalId>(layout.info.patches.size()), "patch")));
                   });
  return result;
}

}  // namespace pamr::io
