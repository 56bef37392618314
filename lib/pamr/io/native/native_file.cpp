// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/native_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "pamr/assemble/turn_inverted.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/io/native/catalog.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/native/layout.hpp"
#include "pamr/io/native/patch_surfaces.hpp"
#include "pamr/io/native/preflight.hpp"
#include "pamr/io/native/read_cells.hpp"
#include "pamr/io/native/read_level0.hpp"
#include "pamr/io/native/read_values.hpp"
#include "pamr/io/native/slab_reader.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/local_size.hpp"

namespace pamr::io {

struct NativeFile::Open {
  Open(const par::Comm& comm, const std::filesystem::path& file, const ReadOptions& options)
      : catalog(catalog_of(comm, file)),
        layout(check_catalog(catalog, file, options.verify_checksums)),
        reader(comm, file, catalog, {options.verify_checksums, options.slab_bytes, options.remark}),
        build_surfaces(options.build_surfaces),
        turn_inverted(options.turn_inverted),
        remark(options.remark) {}

  hdf5::Silence silence;
  Catalog catalog;
  Layout layout;
  SlabReader reader;
  bool build_surfaces, turn_inverted;
  std::function<void(const std::string&)> remark;
};

namespace {

const FieldEntry* find_integers(const Layout& layout, std::string_view cell_field) {
  const auto found = std::find_if(layout.fields.begin(), layout.fields.end(), [&](const FieldEntry& field) {
    return field.on_cells && field.name == cell_field && field.n_components == 1 && mesh::is_integer(field.type);
  });
  return found == layout.fields.end() ? nullptr : &*found;
}

Rows block_of_rank(const par::Comm& comm, GlobalId n) {
  const auto range = par::block_range(n, comm.rank(), comm.size());
  return {range.begin, range.end};
}

void require_space(const par::Comm& comm, const std::filesystem::path& file, const mesh::MeshInfo& info) {
  constexpr GlobalId limit = mesh::max_local_cells;
  if (info.n_global_cells / comm.size() > limit || info.n_global_nodes / comm.size() > limit)
    throw Error(fmt::format("file '{}': expected at most {} cells and nodes a rank, found more: run on more ranks",
                            file.string(), limit));
}

/// This rank's rows when its run begins at the first border of a family at or after `first_cell`. Collective.
Rows whole_families(SlabReader& reader, const Layout& layout, GlobalId first_cell) {
  const auto& comm = reader.comm();
  const auto begin = layout.has_lineage ? family_border(reader, layout, first_cell) : first_cell;
  const auto begins = comm.all_gather(begin);
  if (begins[0] != 0) reader.fail(path::lineage, 0, "the first cell of a family", "another one");
  for (std::size_t r = 1; r < begins.size(); ++r)
    if (begins[r] < begins[r - 1])
      reader.fail(path::lineage, begins[r], "whole families", "a member of a family whose first one is missing");
  const auto next = at(comm.rank()) + 1;
  return {begin, next < begins.size() ? begins[next] : layout.info.n_global_cells};
}

}  // namespace

NativeFile::NativeFile(const par::Comm& comm, std::filesystem::path file, const ReadOptions& options)
    : comm_(&comm), file_(std::move(file)) {
  comm.in_library([] { return H5open(); });  // sets HDF5 up, once
  open_ = std::make_unique<Open>(comm, file_, options);
}

NativeFile::~NativeFile() = default;

const mesh::MeshInfo& NativeFile::info() const { return open_->layout.info; }

bool NativeFile::is_of_pamr() const { return open_->catalog.has_pamr_group; }

bool NativeFile::has_integers(std::string_view cell_field, std::optional<mesh::StorageType> type) const {
  const auto* field = find_integers(open_->layout, cell_field);
  return field != nullptr && (!type || field->type == *type);
}

std::vector<std::int64_t> NativeFile::read_integers(std::string_view cell_field, Checked checked) {
  const auto* entry = find_integers(open_->layout, cell_field);
  PAMR_EXPECTS(entry != nullptr);
  const auto rows = block_of_rank(*comm_, info().n_global_cells);
  return std::move(io::read_field(open_->reader, open_->layout, *entry, rows, checked == Checked::checksum).integer());
}

std::vector<std::array<GlobalId, 4>> NativeFile::read_cell_to_node() {
  return io::read_connectivity(open_->reader, open_->layout, block_of_rank(*comm_, info().n_global_cells), false);
}

std::vector<mesh::Lineage> NativeFile::read_lineage() {
  return io::read_lineage_unchecked(open_->reader, open_->layout, block_of_rank(*comm_, info().n_global_cells));
}

mesh::BlockMesh NativeFile::read(std::optional<GlobalId> first_cell, std::string_view without_cell_field) {
  auto& reader = open_->reader;
  const auto& layout = open_->layout;
  const auto nodes = block_of_rank(*comm_, info().n_global_nodes);
  const auto cells =
      whole_families(reader, layout, first_cell.value_or(block_of_rank(*comm_, info().n_global_cells).begin));
  require_space(*comm_, file_, info());
  if (open_->remark)
    for (const auto& text : layout.remarks) open_->remark(text);
  mesh::BlockMesh block;
  block.info = layout.info;
  block.first_cell = layout.info.first_id + cells.begin;
  block.lineage = io::read_lineage(reader, layout, cells);
  check_offsets_and_types(reader, layout, cells);
  block.cell_to_node = read_connectivity(reader, layout, cells, true);
  check_corners(reader, layout, cells, block.cell_to_node);
  block.cell_to_cell = read_neighbors(reader, layout, cells);
  block.boundary = read_boundary(reader, layout);
  block.node_position =
      read_points(reader, {path::points, layout.points_type, {layout.info.n_global_nodes, 3, false}}, nodes);
  if (open_->turn_inverted && !open_->catalog.has_pamr_group) {
    const auto turned = assemble::turn_inverted(*comm_, block);
    if (turned.n_turned > 0 && open_->remark)
      open_->remark(fmt::format("file '{}': {} of {} cells {} turned over", file_.string(), turned.n_turned,
                                info().n_global_cells,
                                turned.n_turned == 1 ? "was inverted and is" : "were inverted and are"));
  }
  for (const auto& entry : layout.fields)
    if (!entry.on_cells)
      block.node_fields.push_back(read_field(reader, layout, entry, nodes, true));
    else if (entry.name != without_cell_field)
      block.cell_fields.push_back(read_field(reader, layout, entry, cells, true));
  par::agree(*comm_, [&] {
    with_file_name(file_, [&] {
      for (const auto& field : block.cell_fields) mesh::require_inner_patches(field, block.info.patches.size());
    });
  });
  std::vector<std::shared_ptr<const geometry::Triangulation>> triangulations;
  for (const auto& entry : layout.triangulations)
    triangulations.push_back(std::make_shared<const geometry::Triangulation>(read_triangulation(reader, entry)));
  par::agree(*comm_, [&] {
    put_surfaces(layout, file_.string(), std::move(triangulations), open_->build_surfaces, block.info);
  });
  read_level0(reader, layout, cells, nodes, block);
  return block;
}

mesh::BlockMesh read_native(const par::Comm& comm, const std::filesystem::path& file, const ReadOptions& options) {
  return NativeFile(comm, file, options).read();
}

}  // namespace pamr::io
