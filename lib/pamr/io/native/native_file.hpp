// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "pamr/assemble/assemble.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

struct ReadOptions {
  /// Compare the checksums that the file has with its contents; a dataset without one is accepted as it is.
  bool verify_checksums = true;
  /// Largest piece that a rank reads at once, bytes; 2^30 at most.
  std::size_t slab_bytes = std::size_t{1} << 20U;
  /// Integer cell field of marks (1: to be refined). The ranks then read runs of cells that are about the same work:
  /// by the field `mesh::work_field`, which is not part of the result, or else by `mesh::expected_children`; where
  /// there is no field of marks, or no name here, runs of the same number.
  std::string marks_field = {};
};

struct WriteOptions {
  /// Text that says where the mesh comes from (version, options that change the result, name of the case); empty: what
  /// the mesh brought with it. Nothing that differs from run to run belongs here: equal meshes give equal files.
  std::string provenance = {};
  /// `mesh::fingerprint` of the mesh where the caller has it already.
  std::optional<std::uint64_t> fingerprint = {};
  /// Largest piece that a rank writes at once, bytes; 2^30 at most.
  std::size_t slab_bytes = std::size_t{1} << 20U;
};

/// Reads a mesh in the native format (docs/file-format.md): every rank gets a block of cells whose borders are borders
/// of families, and the canonical block of the nodes. A file without `/PAMR` is accepted: `cell_to_cell` and `lineage`
/// are then empty and there is one patch, `boundary`.
///
/// Nothing in the file is trusted: rank 0 looks through its structure in a process of its own, which may die of it;
/// shapes, types, counts, ranges and checksums are verified before the values are used, and no array is larger than the
/// size of the file allows. Does not look at the geometry (`validate::validate` does) nor match neighbors
/// (`assemble::assemble` does).
///
/// Collective. Throws the same `Error` on every rank. Memory: the result and one slab. The process that looks through
/// the file is forked from rank 0.
mesh::BlockMesh read_native(const par::Comm& comm, const std::filesystem::path& file, const ReadOptions& options = {});

/// Writes a mesh in global order. The bytes of the file depend on the mesh alone, not on the number of ranks nor on
/// which rank holds what; fields are written in the order of their names.
///
/// Collective. The file appears complete or not at all: it is written as `<file>.partial`, flushed to the disk and
/// renamed. Throws the same `Error` on every rank when it cannot be written (folder missing, no permission, disk full,
/// a value that does not fit the type of its field); nothing is left behind then and an existing file stays as it was.
/// Communication: rows travel to the rank that writes their part of the file; none of cells where the ranks hold runs
/// of them in rank order. Memory: three slabs and 4 bytes a node.
void write_native(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                  const WriteOptions& options = {});

}  // namespace pamr::io
