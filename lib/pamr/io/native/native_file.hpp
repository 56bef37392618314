// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/io/native/write_native.hpp"
#include "pamr/mesh/block_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

struct ReadOptions {
  /// Compare the checksums that the file has with its contents; a dataset without one is accepted as it is.
  Exact<bool> verify_checksums = true;
  /// Largest piece that a rank reads at once, bytes; 2^30 at most.
  Exact<std::size_t> slab_bytes = std::size_t{1} << 20U;
  /// Make the surfaces of the mesh. Without, their description and data are kept for writing, and nothing can be moved
  /// onto them: for callers that do not ask where a boundary lies, because triangulated surfaces take time and memory.
  Exact<bool> build_surfaces = true;
  /// Turn the inverted cells of a file without `/PAMR` over: other programs give corners in any order.
  Exact<bool> turn_inverted = true;
  /// Told what is odd about the file and does no harm, on every rank alike, while it is read: a field whose checksum is
  /// older than its values, cells of other programs that had to be turned over. May throw `Error`. None: silence.
  std::function<void(const std::string& remark)> remark = {};
};

/// A mesh in the native format (docs/file-format.md), open for reading. Opening looks through the structure of the file
/// and reads everything that is small; the functions read the large arrays.
///
/// Nothing in the file is trusted:
/// - shapes, types, counts, ranges and checksums are verified before the values are used (a checksum of a field that
///   does not fit is a remark: solvers rewrite fields);
/// - no array is larger than the size of the file allows.
/// HDF5 1.10 itself may die of a damaged file all the same (docs/file-format.md, *Damaged files*).
/// The geometry is not looked at (`validate::validate` does), nor are neighbors matched (`assemble::assemble` does).
///
/// All functions but `info`, `is_of_pamr` and `has_integers` are collective; so are the constructor and the destructor.
/// They throw the same `Error` on every rank.
class NativeFile {
 public:
  NativeFile(const par::Comm& comm, std::filesystem::path file, const ReadOptions& options = {});
  ~NativeFile();
  NativeFile(const NativeFile&) = delete;
  NativeFile& operator=(const NativeFile&) = delete;
  NativeFile(NativeFile&&) = delete;
  NativeFile& operator=(NativeFile&&) = delete;

  /// What the file says of the whole mesh, but for the triangulations.
  const mesh::MeshInfo& info() const;
  /// Whether the file has `/PAMR`; another program wrote one without.
  bool is_of_pamr() const;
  /// Whether there is a cell field of this name, of one integer component, stored as `type` if that is given.
  bool has_integers(std::string_view cell_field, std::optional<mesh::StorageType> type = {}) const;

  enum class Checked {
    checksum,
    later,  ///< when `read` reads it once more: for a first look that only decides who reads what
  };
  /// Values of such a field in this rank's canonical block of the cells (`par::block_range`).
  std::vector<std::int64_t> read_integers(std::string_view cell_field, Checked checked);
  /// Nodes of the cells of that block (n x 4, global ids, in range), the checksum not compared.
  std::vector<std::array<GlobalId, 4>> read_cell_to_node();
  /// Lineage of the cells of that block, nothing compared: a word that is none counts as a regular cell. Empty where
  /// the file has no lineage.
  std::vector<mesh::Lineage> read_lineage();

  /// The mesh: a run of cells for each rank, and its canonical block of the nodes.
  /// - `first_cell`: row of the first cell of this rank's run, counted from 0, ascending with the ranks, 0 on rank 0;
  ///   none on every rank: canonical blocks. The run begins at the first border of a family at or after it, and ends
  ///   where that of the next rank begins.
  /// - `without_cell_field`: a field to leave out; empty: none.
  /// - The triangles of the boundary, where the file has them, in a block of their own for each rank.
  /// - Cells of a file without `/PAMR` may be inverted: they are turned over, unless the options say otherwise.
  /// - A file without `/PAMR` gives no `cell_to_cell` and no `lineage`, and one patch, `boundary`.
  /// Memory: the result and one slab.
  mesh::BlockMesh read(std::optional<GlobalId> first_cell = {}, std::string_view without_cell_field = {});

 private:
  struct Open;

  const par::Comm* comm_;
  std::filesystem::path file_;
  std::unique_ptr<Open> open_;
};

/// The mesh of a file, in canonical blocks of whole families: `NativeFile(comm, file, options).read()`. Collective;
/// throws the same `Error` on every rank.
mesh::BlockMesh read_native(const par::Comm& comm, const std::filesystem::path& file, const ReadOptions& options = {});

}  // namespace pamr::io
