// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/read_level0.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/level0_key.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::io {

namespace {

using Words = std::span<const std::uint64_t>;

/// Says what a row of a dataset of the table has to be.
class RowChecker {
 public:
  RowChecker(const SlabReader& reader, const mesh::MeshInfo& info) : reader_(&reader), info_(&info) {}

  /// The words of one row of one dataset.
  void check(Level0Dataset dataset, GlobalId row, Words words) const {
    const auto& column = column_of(dataset);
    if (!mesh::is_integer(column.type)) {
      for (const auto word : words)
        if (!std::isfinite(std::bit_cast<double>(word)))
          reader_->fail(column.path(), row, "finite numbers", "NaN or infinity");
      return;
    }
    const auto nodes = info_->node_ids();
    const auto n_patches = std::ssize(info_->patches);
    const auto [what, least, most] = dataset == Level0Dataset::corners ? Range{"nodes", nodes.first, nodes.end() - 1}
                                     : dataset == Level0Dataset::flags ? Range{"bits", 0, 63}
                                                                       : Range{"patches", -1, n_patches - 1};
    for (const auto word : words)
      if (const auto value = static_cast<std::int64_t>(word); value < least || value > most)
        reader_->fail(column.path(), row, fmt::format("{} from {} to {}", what, least, most), fmt::format("{}", value));
  }

  /// What several words of a row say together.
  void check(const mesh::Level0Cell& cell) const {
    auto nodes = cell.node;
    std::sort(nodes.begin(), nodes.end());
    if (const auto twice = std::adjacent_find(nodes.begin(), nodes.end()); twice != nodes.end())
      fail(cell, Level0Dataset::corners, "four different nodes", fmt::format("node {} twice", *twice));
    for (std::size_t i = 1; i < 4; ++i)
      if (!geometry::lexicographically_less(cell.corner[i - 1], cell.corner[i]))
        fail(cell, Level0Dataset::points, "corners in the order of their coordinates", "another order");
    for (const auto patch : cell.face_patch)
      if (patch >= 0 && !has_surface(patch))
        fail(cell, Level0Dataset::face_patches, "patches with a surface", fmt::format("patch {} without", patch));
    if (cell.bent_corners < 1 || cell.bent_corners > 15)
      fail(cell, Level0Dataset::flags, "bits of bent corners from 1 to 15", fmt::format("{}", cell.bent_corners));
    for (std::size_t e = 0; e < 6; ++e) check_edge(cell, e);
  }

 private:
  struct Range {
    const char* what;
    std::int64_t least, most;
  };

  void fail(const mesh::Level0Cell& cell, Level0Dataset dataset, const std::string& expected,
            const std::string& found) const {
    reader_->fail(column_of(dataset).path(), cell.row, expected, found);
  }

  bool has_surface(std::int32_t patch) const { return info_->patches[at(patch)].surface >= 0; }

  void check_edge(const mesh::Level0Cell& cell, std::size_t e) const {
    const auto [a, b] = cell.edge_patch[e];
    if ((a < 0) != (b < 0) || a > b)
      fail(cell, Level0Dataset::edge_patches, "no patch, one twice, or two in ascending order",
           fmt::format("{} and {}", a, b));
    if (a >= 0 && !has_surface(a) && !has_surface(b))
      fail(cell, Level0Dataset::edge_patches, "a patch with a surface at each edge",
           fmt::format("{} and {} without", a, b));
    const bool is_sharp = (cell.sharp_edges >> e & 1U) != 0, is_crease = (cell.creases >> e & 1U) != 0;
    if (a < 0 && (is_sharp || is_crease))
      fail(cell, Level0Dataset::flags, "sharp edges and creases in curved walls", fmt::format("edge {} in none", e));
    if (is_sharp && cell.beside[e] == geometry::Vec3{})
      fail(cell, Level0Dataset::beside, "a normal beside each sharp edge", fmt::format("none at edge {}", e));
  }

  const SlabReader* reader_;
  const mesh::MeshInfo* info_;
};

/// Rows of the table, verified. Collective.
std::vector<mesh::Level0Cell> read_rows(SlabReader& reader, const Level0Entry& table, const mesh::MeshInfo& info) {
  const auto range = par::block_range(table.n_rows, reader.comm().rank(), reader.comm().size());
  const RowChecker checker(reader, info);
  std::vector<Level0Words> rows(at(range.count()));
  for (std::size_t i = 0; i < level0_columns.size(); ++i) {
    const auto& column = level0_columns[i];
    const hdf5::Shape shape{table.n_rows, static_cast<GlobalId>(column.width), false};
    reader.each_slab({column.path(), table.type[i], shape}, {range.begin, range.end}, true,
                     [&](GlobalId row, Words words) {
                       for (; !words.empty(); words = words.subspan(column.width), ++row) {
                         checker.check(static_cast<Level0Dataset>(i), row, words.first(column.width));
                         std::copy_n(words.begin(), column.width, rows[at(row - range.begin)].begin() + column.first);
                       }
                     });
  }
  std::vector<mesh::Level0Cell> cells;
  par::agree(reader.comm(), [&] {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      cells.push_back(level0_cell_of(range.begin + static_cast<GlobalId>(i), rows[i]));
      checker.check(cells.back());
    }
  });
  return cells;
}

/// The fault of a key; empty: none.
std::string trouble_of(const mesh::Level0Key& key, IdRange nodes) {
  if (!key.is_known()) return key == mesh::Level0Key{} ? "" : "a key without its first node";
  std::uint64_t sum = 0;  // of at most four weights of at most 2^62: modulo 2^64, and 0 only where it is 2^64
  for (std::size_t i = 0; i < 4; ++i) {
    const auto node = key.node[i];
    const auto weight = key.weight[i];
    if (node == -1) {
      if (weight != 0) return "a weight without node";
      continue;
    }
    if (!nodes.contains(node)) return fmt::format("node {}", node);
    if (i > 0 && (key.node[i - 1] < 0 || node <= key.node[i - 1]))
      return fmt::format("node {} after {}", node, key.node[i - 1]);
    if (weight < 1 || weight > std::int64_t{1} << mesh::Level0Key::one) return fmt::format("weight {}", weight);
    sum += static_cast<std::uint64_t>(weight);
  }
  return sum == std::uint64_t{1} << mesh::Level0Key::one ? "" : "weights with another sum";
}

/// Local.
void check_fields(const SlabReader& reader, const Layout& layout, Rows cells, Rows nodes,
                  const mesh::BlockMesh& block) {
  const auto each = [&](bool on_cells, const char* name, auto check) {
    for (const auto& entry : layout.fields)
      if (entry.on_cells == on_cells && entry.name == name)
        for (const auto& field : on_cells ? block.cell_fields : block.node_fields)
          if (field.name == name) check(entry, field);
  };
  each(true, mesh::level0_cell_field, [&](const FieldEntry& entry, const mesh::Field& field) {
    auto place = entry.first_row + cells.begin;
    for (const auto row : field.integer()) {
      if (row < -1 || row >= layout.level0.n_rows)
        reader.fail(entry.path, place, fmt::format("-1 or a row from 0 to {}", layout.level0.n_rows - 1),
                    fmt::format("{}", row));
      ++place;
    }
  });
  each(false, mesh::level0_key_field, [&](const FieldEntry& entry, const mesh::Field& field) {
    for (GlobalId n = 0; n < nodes.count(); ++n)
      if (const auto trouble = trouble_of(mesh::key_of(&field, static_cast<LocalId>(n)), layout.info.node_ids());
          !trouble.empty())
        reader.fail(entry.path, entry.first_row + nodes.begin + n,
                    fmt::format("ascending nodes of level 0 with weights that add up to 2^{}", mesh::Level0Key::one),
                    trouble);
  });
}

/// Refuses rows that no cell is in: no rank would hold them. Collective: two sparse exchanges.
void require_cells_in_rows(const SlabReader& reader, GlobalId n_rows, const mesh::BlockMesh& block) {
  const auto& comm = reader.comm();
  std::vector<GlobalId> named;
  for (const auto& field : block.cell_fields)
    if (field.name == mesh::level0_cell_field) named = field.integer();
  std::sort(named.begin(), named.end());
  named.erase(std::unique(named.begin(), named.end()), named.end());
  std::erase(named, -1);
  const std::vector<std::uint8_t> yes(named.size(), 1);
  const auto has_cell = par::scatter_rows<std::uint8_t>(comm, n_rows, yes, 1, named);
  const auto first = par::block_range(n_rows, comm.rank(), comm.size()).begin;
  par::agree(comm, [&] {
    const auto none = std::find(has_cell.begin(), has_cell.end(), 0);
    if (none != has_cell.end())
      reader.fail(path::level0, first + (none - has_cell.begin()),
                  fmt::format("cells that name this row in '{}'", mesh::level0_cell_field), "none");
  });
}

}  // namespace

void read_level0(SlabReader& reader, const Layout& layout, Rows cells, Rows nodes, mesh::BlockMesh& block) {
  const auto n_rows = layout.level0.n_rows;
  if (n_rows == 0) return;
  auto rows = read_rows(reader, layout.level0, block.info);
  par::agree(reader.comm(), [&] { check_fields(reader, layout, cells, nodes, block); });
  require_cells_in_rows(reader, n_rows, block);
  block.info.level0 = std::make_shared<const mesh::Level0Map>(std::move(rows), n_rows, block.info);
}

}  // namespace pamr::io
