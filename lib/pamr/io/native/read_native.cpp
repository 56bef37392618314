// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>
#include <optional>

#include "pamr/base/error.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/io/native/catalog.hpp"
#include "pamr/io/native/checksum.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/native/layout.hpp"
#include "pamr/io/native/native_file.hpp"
#include "pamr/io/native/row_source.hpp"
#include "pamr/mesh/expected_children.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/mesh/local_size.hpp"
#include "pamr/par/equal_work.hpp"

namespace pamr::io {

namespace {

using mesh::StorageType;

/// Calls `run` with a value of the C++ type that a storage type stands for.
template <class Run>
void with_type(StorageType type, Run run) {
  switch (type) {
    case StorageType::float64:
      return run(double{});
    case StorageType::float32:
      return run(float{});
    case StorageType::int64:
      return run(std::int64_t{});
    case StorageType::int32:
      return run(std::int32_t{});
    case StorageType::int16:
      return run(std::int16_t{});
    case StorageType::int8:
      return run(std::int8_t{});
    case StorageType::uint64:
      return run(std::uint64_t{});
    case StorageType::uint32:
      return run(std::uint32_t{});
    case StorageType::uint16:
      return run(std::uint16_t{});
    case StorageType::uint8:
      return run(std::uint8_t{});
  }
}

/// What HDF5 reads at once of a dataset that it need not inflate, and what is then looked at in one go: these pieces
/// stay in the processor's caches, and take little memory of their own.
constexpr std::size_t piece_bytes = std::size_t{256} << 10U;
constexpr std::size_t values_at_once = std::size_t{2} << 10U;

/// Rows that this rank reads of a dataset.
struct Rows {
  GlobalId begin = 0, end = 0;
  GlobalId count() const { return end - begin; }
};

std::string text_of(std::int64_t value) { return std::to_string(value); }

class Reader {
 public:
  Reader(const par::Comm& comm, std::filesystem::path file, const ReadOptions& options)
      : comm_(&comm), file_(std::move(file)), options_(options) {
    options_.slab_bytes = std::min(options_.slab_bytes, hdf5::max_transfer_bytes);
  }

  mesh::BlockMesh run();

 private:
  /// Receives the words of whole rows, the first of which has the number given.
  using Consume = std::function<void(GlobalId first_row, std::span<const std::uint64_t> words)>;

  [[noreturn]] void fail(const std::string& path, GlobalId row, const std::string& expected,
                         const std::string& found) const {
    throw Error("file '" + file_.string() + "', " + path + ", row " + std::to_string(row) + ": expected " + expected +
                ", found " + found);
  }

  void open();
  void share_out();
  const FieldEntry* find_integers(const std::string& cell_field) const;
  std::vector<std::uint8_t> expected_children(Rows block, const FieldEntry& marks);
  std::vector<std::uint8_t> work_of(Rows block, const FieldEntry& field);
  GlobalId first_of_equal_work(const FieldEntry& marks);
  GlobalId family_border(GlobalId cell);
  Rows cells() const { return {first_cell_, end_cell_}; }
  Rows nodes() const {
    const auto range = par::block_range(layout_.info.n_global_nodes, comm_->rank(), comm_->size());
    return {range.begin, range.end};
  }

  void each_slab(const std::string& path, StorageType type, const hdf5::Shape& shape, Rows rows, bool verify,
                 const Consume& consume);
  std::string where_is(const std::string& path) const { return "file '" + file_.string() + "', " + path + ": "; }
  std::optional<RowSource> open_rows(const std::string& path, const hdf5::Shape& shape, Rows rows, GlobalId slab) const;
  std::span<const std::uint64_t> as_words(StorageType type, std::size_t first, std::size_t n);

  void read_lineage(mesh::BlockMesh& block);
  void check_families(const mesh::BlockMesh& block) const;
  std::vector<geometry::Vec3> read_points(const std::string& path, StorageType type, GlobalId n_rows, Rows rows);
  void read_connectivity(mesh::BlockMesh& block);
  void read_neighbors(mesh::BlockMesh& block);
  void check_offsets_and_types();
  mesh::Field read_field(const FieldEntry& entry);
  geometry::Triangulation read_triangulation(const TriangulationEntry& entry);

  const par::Comm* comm_;
  std::filesystem::path file_;
  ReadOptions options_;
  Catalog catalog_;
  Layout layout_;
  hdf5::Handle h5_;
  GlobalId first_cell_ = 0, end_cell_ = 0;  ///< rows of the file
  std::vector<std::uint64_t> raw_;          ///< a slab as the file has it, at the front, and
  std::vector<std::uint64_t> words_;        ///< a part of it as words; memory is taken once for all datasets
};

mesh::BlockMesh Reader::run() {
  catalog_ = catalog_of(*comm_, file_);
  layout_ = check_catalog(catalog_, file_, options_.verify_checksums);
  open();
  share_out();
  mesh::BlockMesh block;
  block.info = layout_.info;
  block.first_cell = layout_.info.first_id + first_cell_;
  read_lineage(block);
  check_offsets_and_types();
  read_connectivity(block);
  read_neighbors(block);
  block.node_position = read_points(path::points, layout_.points_type, layout_.info.n_global_nodes, nodes());
  const auto* work = options_.marks_field.empty() ? nullptr : find_integers(mesh::work_field(options_.marks_field));
  for (const auto& entry : layout_.fields)
    if (&entry != work) (entry.on_cells ? block.cell_fields : block.node_fields).push_back(read_field(entry));
  for (const auto& entry : layout_.triangulations) block.info.triangulations.push_back(read_triangulation(entry));
  comm_->in_library([&] { return h5_.reset(); });
  return block;
}

void Reader::open() {
  par::agree(*comm_, [&] {
    const par::Comm::Waiting waiting(*comm_, par::Comm::Waiting::In::library);
    const auto access = hdf5::parallel_access(*comm_);
    h5_ = hdf5::take(H5Fopen(file_.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose,
                     "file '" + file_.string() + "': cannot open it");
  });
}

/// HDF5 opens a dataset on all ranks together; reading its rows is each rank's own.
std::optional<RowSource> Reader::open_rows(const std::string& path, const hdf5::Shape& shape, Rows rows,
                                           GlobalId slab) const {
  const par::Comm::Waiting waiting(*comm_, par::Comm::Waiting::In::library);
  try {
    return std::optional<RowSource>(std::in_place, file_, h5_.id(), *catalog_.find_array(path), shape, rows.begin,
                                    rows.end, slab);
  } catch (const Error& error) {
    throw Error(where_is(path) + error.what());
  }
}

/// Reads the rows in slabs and hands them on as 64-bit words (integers sign-extended, reals as doubles), whole groups
/// of four rows where there are so many, then compares the checksum. `verify`: the rows of all ranks together are the
/// whole dataset, once. Collective.
void Reader::each_slab(const std::string& path, StorageType type, const hdf5::Shape& shape, Rows rows, bool verify,
                       const Consume& consume) {
  const auto* stored = catalog_.find_number(std::string(path::checksums) + "@" + checksum_path(path));
  verify = verify && options_.verify_checksums && stored != nullptr;
  Checksum checksum(verify ? shape.rows : 0);
  const auto width = static_cast<std::size_t>(shape.width);
  const auto rows_in = [&](std::size_t values) {  // the corners of a cell are four rows of one dataset
    return std::max<GlobalId>(4, static_cast<GlobalId>(values / width / 4 * 4));
  };
  const bool is_chunked = catalog_.find_array(path)->is_chunked;
  const auto slab = rows_in((is_chunked ? options_.slab_bytes : std::min(options_.slab_bytes, piece_bytes)) / 8);
  const auto step = rows_in(values_at_once);
  par::agree(*comm_, [&] {
    auto source = open_rows(path, shape, rows, slab);
    for (auto first = rows.begin; first < rows.end; first += slab) {
      const auto n = std::min(slab, rows.end - first);
      const auto bytes = static_cast<std::size_t>(n) * width * hdf5::size_of(type);
      raw_.resize((bytes + 7) / 8);
      if (!comm_->in_library([&] { return source->read(n, std::as_writable_bytes(std::span(raw_)).first(bytes)); }))
        throw Error(where_is(path) + "cannot read rows from " + std::to_string(first) + " on (" + source->trouble() +
                    ")");
      for (GlobalId at = 0; at < n; at += step) {
        const auto words = as_words(type, static_cast<std::size_t>(at) * width,
                                    static_cast<std::size_t>(std::min(step, n - at)) * width);
        if (type == StorageType::uint64)
          for (std::size_t i = 0; i < words.size(); ++i)
            if (words[i] >> 63U != 0)
              fail(path, first + at + static_cast<GlobalId>(i / width), "integers below 2^63",
                   std::to_string(words[i]));
        if (verify) checksum.add(first + at, width, words);
        consume(first + at, words);
      }
    }
  });
  if (verify &&
      (stored->values.size() != 1 || std::bit_cast<std::uint64_t>(stored->values[0]) != checksum.result(*comm_)))
    throw Error(where_is(path) +
                "expected contents that agree with its checksum, found that they do not: the file is damaged");
}

/// Values of the slab as 64-bit words: where they lie if that is what they are, else converted.
std::span<const std::uint64_t> Reader::as_words(StorageType type, std::size_t first, std::size_t n) {
  if (hdf5::size_of(type) == 8) return std::span(raw_).subspan(first, n);
  words_.resize(std::max(words_.size(), n));
  with_type(type, [&](auto sample) {
    using T = decltype(sample);
    const auto raw = std::as_bytes(std::span(raw_)).subspan(first * sizeof(T), n * sizeof(T));
    for (std::size_t i = 0; i < n; ++i) {
      T value;
      std::memcpy(&value, raw.data() + i * sizeof(T), sizeof(T));
      if constexpr (std::is_floating_point_v<T>)
        words_[i] = std::bit_cast<std::uint64_t>(static_cast<double>(value));
      else
        words_[i] = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
    }
  });
  return std::span(words_).first(n);
}

/// First family border at or after the first cell of a canonical block.
GlobalId Reader::family_border(GlobalId cell) {
  const auto n = layout_.info.n_global_cells;
  GlobalId border = cell;
  each_slab(path::lineage, layout_.lineage_type, {n, 1, true}, {cell, std::min(cell + 1, n)}, false,
            [&](GlobalId, std::span<const std::uint64_t> words) {
              if (words.empty()) return;
              const mesh::Lineage lineage(static_cast<std::uint32_t>(words[0]));
              if (lineage.is_removable() && lineage.child() != 0)
                border = cell + std::max(0, lineage.family_size() - lineage.child());
            });
  return std::min(border, n);
}

const FieldEntry* Reader::find_integers(const std::string& cell_field) const {
  const auto found = std::find_if(layout_.fields.begin(), layout_.fields.end(), [&](const FieldEntry& field) {
    return field.on_cells && field.name == cell_field && field.n_components == 1 && mesh::is_integer(field.type);
  });
  return found == layout_.fields.end() ? nullptr : &*found;
}

std::vector<std::uint8_t> Reader::expected_children(Rows block, const FieldEntry& marks) {
  const auto n = layout_.info.n_global_cells;
  std::vector<std::array<std::uint32_t, 4>> nodes;
  assign_array(nodes, static_cast<std::size_t>(block.count()), {});
  std::vector<std::uint8_t> mark;
  mark.reserve(static_cast<std::size_t>(block.count()));
  each_slab(path::connectivity, layout_.connectivity_type, {4 * n, 1, true}, {4 * block.begin, 4 * block.end}, false,
            [&](GlobalId first, std::span<const std::uint64_t> words) {
              auto* cell = nodes.data() + (first / 4 - block.begin);
              for (; !words.empty(); words = words.subspan(4), ++cell)
                for (std::size_t i = 0; i < 4; ++i) (*cell)[i] = static_cast<std::uint32_t>(words[i]);
            });
  each_slab(marks.path, marks.type, {n, 1, marks.is_flat}, block, false,
            [&](GlobalId, std::span<const std::uint64_t> words) {
              for (const auto word : words) mark.push_back(word == 1 ? 1 : 0);
            });
  return mesh::expected_children(nodes, mark);
}

/// What the file says that each cell costs. Numbers out of range only make the runs uneven; damage is told.
std::vector<std::uint8_t> Reader::work_of(Rows block, const FieldEntry& field) {
  std::vector<std::uint8_t> work;
  work.reserve(static_cast<std::size_t>(block.count()));
  each_slab(
      field.path, field.type, {layout_.info.n_global_cells, 1, field.is_flat}, block, true,
      [&](GlobalId, std::span<const std::uint64_t> words) {
        for (const auto word : words)
          work.push_back(static_cast<std::uint8_t>(std::clamp<std::int64_t>(static_cast<std::int64_t>(word), 1, 255)));
      });
  return work;
}

/// First cell of this rank's run when the runs are about the same work. Each rank looks at its canonical block; what is
/// wrong in it is found when it is read for good.
GlobalId Reader::first_of_equal_work(const FieldEntry& marks) {
  const auto range = par::block_range(layout_.info.n_global_cells, comm_->rank(), comm_->size());
  const Rows block{range.begin, range.end};
  const auto* field = find_integers(mesh::work_field(options_.marks_field));
  if (field == nullptr && comm_->size() == 1) return 0;
  const auto work = field != nullptr ? work_of(block, *field) : expected_children(block, marks);
  std::vector<std::int64_t> n_cells(static_cast<std::size_t>(comm_->size()), 0);  // of each run
  for (const auto run : par::runs_of_equal_work(*comm_, work, comm_->size())) ++n_cells[static_cast<std::size_t>(run)];
  comm_->sum_in_place(n_cells);
  return std::accumulate(n_cells.begin(), n_cells.begin() + comm_->rank(), GlobalId{0});
}

/// Decides which cells this rank reads: its canonical block, or the one of equal work, begun at the next border of a
/// family.
void Reader::share_out() {
  const auto n = layout_.info.n_global_cells;
  const auto range = par::block_range(n, comm_->rank(), comm_->size());
  auto begin = range.begin;
  const auto* marks = find_integers(options_.marks_field);
  if (marks != nullptr) begin = first_of_equal_work(*marks);
  if (layout_.has_lineage) begin = family_border(begin);
  const auto begins = comm_->all_gather(begin);
  if (begins[0] != 0) fail(path::lineage, 0, "the first cell of a family", "another one");
  for (std::size_t r = 1; r < begins.size(); ++r)
    if (begins[r] < begins[r - 1])
      fail(path::lineage, begins[r], "whole families", "a member of a family whose first one is missing");
  const auto rank = static_cast<std::size_t>(comm_->rank());
  first_cell_ = begin;
  end_cell_ = rank + 1 < begins.size() ? begins[rank + 1] : n;
  constexpr GlobalId limit = mesh::max_local_cells;
  if (n / comm_->size() > limit || layout_.info.n_global_nodes / comm_->size() > limit)
    throw Error("file '" + file_.string() + "': expected at most " + std::to_string(limit) +
                " cells and nodes a rank, found more: run on more ranks");
}

void Reader::read_lineage(mesh::BlockMesh& block) {
  if (!layout_.has_lineage) return;
  block.lineage.reserve(static_cast<std::size_t>(cells().count()));
  each_slab(path::lineage, layout_.lineage_type, {layout_.info.n_global_cells, 1, true}, cells(), true,
            [&](GlobalId first, std::span<const std::uint64_t> words) {
              for (std::size_t i = 0; i < words.size(); ++i) {
                const mesh::Lineage lineage(static_cast<std::uint32_t>(words[i] & 0xffffU));
                const bool is_regular = lineage.kind() == mesh::FamilyKind::regular;
                if (words[i] > 0xffffU || !mesh::is_well_formed(lineage) || (is_regular && lineage.is_broken()))
                  fail(path::lineage, first + static_cast<GlobalId>(i), "a lineage word as the format specifies",
                       std::to_string(words[i]));
                block.lineage.push_back(lineage);
              }
            });
  par::agree(*comm_, [&] { check_families(block); });
}

/// Families are whole, contiguous and in template order. Cells of broken families count as single cells.
void Reader::check_families(const mesh::BlockMesh& block) const {
  const auto n = block.lineage.size();
  for (std::size_t c = 0; c < n;) {
    const auto first = block.lineage[c];
    const auto size = first.is_removable() ? static_cast<std::size_t>(first.family_size()) : std::size_t{1};
    for (std::size_t k = 0; size > 1 && k < size; ++k) {
      const mesh::Lineage expected(first.kind(), first.index(), static_cast<int>(k), first.level());
      if (c + k >= n || block.lineage[c + k] != expected)
        fail(path::lineage, first_cell_ + static_cast<GlobalId>(c + k),
             "child " + std::to_string(k) + " of a family of " + std::to_string(size),
             c + k >= n ? "the end of the dataset" : "word " + std::to_string(block.lineage[c + k].bits()));
    }
    c += size;
  }
}

void Reader::check_offsets_and_types() {
  const auto n = layout_.info.n_global_cells;
  const bool is_last = comm_->rank() == comm_->size() - 1;
  each_slab(path::offsets, layout_.offsets_type, {n + 1, 1, true}, {first_cell_, is_last ? n + 1 : end_cell_}, true,
            [&](GlobalId first, std::span<const std::uint64_t> words) {
              for (std::size_t i = 0; i < words.size(); ++i) {
                const auto row = first + static_cast<GlobalId>(i);
                if (words[i] != static_cast<std::uint64_t>(4 * row))
                  fail(path::offsets, row, text_of(4 * row), text_of(static_cast<std::int64_t>(words[i])));
              }
            });
  each_slab(path::types, layout_.types_type, {n, 1, true}, cells(), true,
            [&](GlobalId first, std::span<const std::uint64_t> words) {
              for (std::size_t i = 0; i < words.size(); ++i)
                if (words[i] != tetrahedron)
                  fail(path::types, first + static_cast<GlobalId>(i), "cell type 10 (tetrahedron)",
                       text_of(static_cast<std::int64_t>(words[i])));
            });
}

void Reader::read_connectivity(mesh::BlockMesh& block) {
  const auto n_nodes = static_cast<std::uint64_t>(layout_.info.n_global_nodes);
  block.cell_to_node.resize(static_cast<std::size_t>(cells().count()));
  each_slab(path::connectivity, layout_.connectivity_type, {4 * layout_.info.n_global_cells, 1, true},
            {4 * first_cell_, 4 * end_cell_}, true, [&](GlobalId first, std::span<const std::uint64_t> words) {
              auto* cell = block.cell_to_node.data() + (first / 4 - first_cell_);
              for (std::size_t at = 0; at < words.size(); at += 4, ++cell)
                for (std::size_t i = 0; i < 4; ++i) {
                  const auto word = words[at + i];
                  if (word >= n_nodes)
                    fail(path::connectivity, first + static_cast<GlobalId>(at + i),
                         "a node from 0 to " + std::to_string(n_nodes - 1), text_of(static_cast<std::int64_t>(word)));
                  (*cell)[i] = layout_.info.first_id + static_cast<GlobalId>(word);
                }
            });
  par::agree(*comm_, [&] {
    for (std::size_t c = 0; c < block.cell_to_node.size(); ++c) {
      auto corners = block.cell_to_node[c];
      if (corners[0] != corners[1] && corners[0] != corners[2] && corners[0] != corners[3] &&
          corners[1] != corners[2] && corners[1] != corners[3] && corners[2] != corners[3])
        continue;
      std::sort(corners.begin(), corners.end());
      const auto twice = std::adjacent_find(corners.begin(), corners.end());
      fail(path::connectivity, 4 * (first_cell_ + static_cast<GlobalId>(c)), "four different nodes",
           "node " + std::to_string(*twice - layout_.info.first_id) + " twice");
    }
  });
}

void Reader::read_neighbors(mesh::BlockMesh& block) {
  if (!layout_.has_neighbors) return;
  const auto all = layout_.info.cell_ids();
  const auto n_patches = static_cast<std::int64_t>(layout_.info.patches.size());
  block.cell_to_cell.resize(static_cast<std::size_t>(cells().count()));
  each_slab(path::cell_to_cell, layout_.neighbors_type, {all.n, 4, false}, cells(), true,
            [&](GlobalId first, std::span<const std::uint64_t> words) {
              for (auto row = first; !words.empty(); words = words.subspan(4), ++row) {
                auto& cell = block.cell_to_cell[static_cast<std::size_t>(row - first_cell_)];
                for (std::size_t i = 0; i < 4; ++i) {
                  const auto value = static_cast<std::int64_t>(words[i]);
                  if (!all.contains(value) && (value >= 0 || value < -n_patches))
                    fail(path::cell_to_cell, row,
                         "a cell from " + std::to_string(all.first) + " to " + std::to_string(all.end() - 1) +
                             " or a patch from -1 to -" + std::to_string(n_patches),
                         text_of(value));
                  if (value == all.first + row) fail(path::cell_to_cell, row, "another cell", "the cell itself");
                  cell[i] = value;
                }
              }
            });
}

std::vector<geometry::Vec3> Reader::read_points(const std::string& path, StorageType type, GlobalId n_rows, Rows rows) {
  std::vector<geometry::Vec3> points(static_cast<std::size_t>(rows.count()));
  each_slab(path, type, {n_rows, 3, false}, rows, true, [&](GlobalId first, std::span<const std::uint64_t> words) {
    for (std::size_t i = 0; i < words.size(); i += 3) {
      const auto row = first + static_cast<GlobalId>(i / 3);
      const geometry::Vec3 p{std::bit_cast<double>(words[i]), std::bit_cast<double>(words[i + 1]),
                             std::bit_cast<double>(words[i + 2])};
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        fail(path, row, "finite coordinates", "NaN or infinity");
      points[static_cast<std::size_t>(row - rows.begin)] = p;
    }
  });
  return points;
}

/// Read by the first rank and told to the others: it is small beside the mesh.
geometry::Triangulation Reader::read_triangulation(const TriangulationEntry& entry) {
  const auto rows = [&](GlobalId n) { return Rows{0, comm_->is_first() ? n : 0}; };
  geometry::Triangulation result;
  result.name = entry.name;
  result.points =
      comm_->broadcast(read_points(entry.path + "/points", entry.points_type, entry.n_points, rows(entry.n_points)));
  const auto path = entry.path + "/triangles";
  each_slab(path, entry.triangles_type, {entry.n_triangles, 3, false}, rows(entry.n_triangles), true,
            [&](GlobalId first, std::span<const std::uint64_t> words) {
              for (std::size_t i = 0; i < words.size(); ++i) {
                if (words[i] >= static_cast<std::uint64_t>(entry.n_points))
                  fail(path, first + static_cast<GlobalId>(i / 3),
                       "a point from 0 to " + std::to_string(entry.n_points - 1),
                       text_of(static_cast<std::int64_t>(words[i])));
                if (i % 3 == 0) result.triangles.emplace_back();
                result.triangles.back()[i % 3] = static_cast<int>(words[i]);
              }
            });
  result.triangles = comm_->broadcast(std::move(result.triangles));
  return result;
}

mesh::Field Reader::read_field(const FieldEntry& entry) {
  const auto rows = entry.on_cells ? cells() : nodes();
  const auto n_rows = entry.on_cells ? layout_.info.n_global_cells : layout_.info.n_global_nodes;
  mesh::Field field{entry.name, entry.unit, entry.n_components, entry.type, {}};
  if (mesh::is_integer(entry.type)) field.value = std::vector<std::int64_t>();
  const auto n_values = static_cast<std::size_t>(rows.count()) * static_cast<std::size_t>(entry.n_components);
  std::visit(
      [&](auto& values) {
        values.resize(n_values);
        auto* to = values.data();
        each_slab(entry.path, entry.type, {n_rows, entry.n_components, entry.is_flat}, rows, true,
                  [&](GlobalId, std::span<const std::uint64_t> words) {
                    std::memcpy(to, words.data(), words.size_bytes());
                    to += words.size();
                  });
      },
      field.value);
  return field;
}

}  // namespace

mesh::BlockMesh read_native(const par::Comm& comm, const std::filesystem::path& file, const ReadOptions& options) {
  comm.in_library([] { return H5open(); });  // sets HDF5 up, once
  const hdf5::Silence silence;
  return Reader(comm, file, options).run();
}

}  // namespace pamr::io
